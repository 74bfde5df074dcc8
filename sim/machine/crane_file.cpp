#include "sim/machine/crane_file.h"

#include <cmath>
#include <numbers>

#include "sim/machine/drive_protection_file.h"

namespace slewlab::sim {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

// What no machine has, whatever its scale: a slip of units or of the keyboard. In SI; 0 is left to the key's own range.
struct Possible {
  double least, most;
};
constexpr Possible kMass{1e-6, 1e9};          // [kg] a grain to a thousand thousand tonnes, more than any ship
constexpr Possible kLength{1e-4, 1e4};        // [m] a tenth of a millimetre to ten kilometres
constexpr Possible kInertia{1e-12, 1e15};     // [kg m^2] the smallest rotor to the greatest mass a kilometre out
constexpr Possible kStiffness{1e-6, 1e18};    // [Nm/rad]
constexpr Possible kRatio{1e-4, 1e6};         // [-]
constexpr Possible kModulus{1e3, 1e13};       // [Pa] jelly to ten times diamond
constexpr Possible kTorque{1e-9, 1e12};       // [Nm]
constexpr Possible kSpeed{1e-9, 1e6};         // [rad/s]

double sized(YamlReader& reader, std::string_view key, Unit unit, common::Range range, Possible possible) {
  const double value = reader.number(key, unit, range);
  if (value != 0.0 && (value < possible.least || value > possible.most)) {
    const std::string name(common::name_of(unit));
    reader.report(key, common::shortest(value) + ' ' + name + ", which no machine has",
                  "from " + common::shortest(possible.least) + " to " + common::shortest(possible.most) + ' ' + name);
  }
  return value;
}

constexpr int kFewestTeeth = 3, kMostTeeth = 10'000;  // fewer do not mesh, nobody cuts more
constexpr double kRightAngle = 0.5 * std::numbers::pi;  // [rad]

DriveParameters read_drive(YamlReader reader) {
  DriveParameters drive;
  drive.group_count = reader.integer("groups", 1, kMaximumGroupCount);
  drive.motors_per_group = reader.integer("motors_per_group", 1, 100);
  drive.motor_inertia = sized(reader, "motor_inertia", Unit::kilogram_square_metre, positive(), kInertia);
  drive.brake_inertia = sized(reader, "brake_inertia", Unit::kilogram_square_metre, not_negative(), kInertia);
  drive.gearbox_inertia = sized(reader, "gearbox_inertia", Unit::kilogram_square_metre, not_negative(), kInertia);
  drive.gearbox_ratio = sized(reader, "gearbox_ratio", Unit::none, positive(), kRatio);
  drive.pinion_ratio = sized(reader, "pinion_ratio", Unit::none, positive(), kRatio);
  drive.gearbox_stiffness = sized(reader, "gearbox_stiffness", Unit::newton_metre_per_radian, positive(), kStiffness);
  drive.gear_damping_ratio = reader.number("gear_damping_ratio", Unit::none, between(0.0, 1.0));
  drive.gearbox_play = reader.number("gearbox_play", Unit::radian, not_negative());
  drive.pinion_play = reader.number("pinion_play", Unit::radian, not_negative());
  drive.rated_torque = sized(reader, "rated_torque", Unit::newton_metre, positive(), kTorque);
  drive.top_speed = sized(reader, "top_speed", Unit::radian_per_second, positive(), kSpeed);
  if (reader.has("pinion_teeth")) drive.pinion_teeth = reader.integer("pinion_teeth", kFewestTeeth, kMostTeeth);
  if (reader.has("gearbox_ring_teeth") || reader.has("gearbox_sun_teeth")) {
    drive.gearbox_ring_teeth = reader.integer("gearbox_ring_teeth", kFewestTeeth, kMostTeeth);
    drive.gearbox_sun_teeth = reader.integer("gearbox_sun_teeth", kFewestTeeth, kMostTeeth);
  }
  reader.finish();
  return drive;
}

HouseParameters read_house(YamlReader reader) {
  HouseParameters house;
  house.inertia = sized(reader, "inertia", Unit::kilogram_square_metre, positive(), kInertia);
  house.sensor_radius = sized(reader, "sensor_radius", Unit::metre, not_negative(), kLength);
  reader.finish();
  return house;
}

std::vector<BoomStation> read_profile(YamlReader reader) {
  constexpr std::size_t kMostStations = 100;
  const std::vector<double> position =
      reader.numbers("position", Unit::none, between(0.0, 1.0), 2, kMostStations);
  const std::vector<double> half_width =
      reader.numbers("half_width", Unit::metre, positive(), 2, kMostStations);
  const std::vector<double> half_height =
      reader.numbers("half_height", Unit::metre, positive(), 2, kMostStations);
  reader.finish();
  if (position.empty() || half_width.empty() || half_height.empty()) return {};

  const std::string as_many = "as many numbers as 'position' has: " + std::to_string(position.size());
  if (half_width.size() != position.size()) {
    reader.report("half_width", "a list of " + std::to_string(half_width.size()), as_many);
    return {};
  }
  if (half_height.size() != position.size()) {
    reader.report("half_height", "a list of " + std::to_string(half_height.size()), as_many);
    return {};
  }
  if (position.front() != 0.0 || position.back() != 1.0) {
    reader.report("position",
                  common::shortest(position.front()) + " to " + common::shortest(position.back()),
                  "0 first (the pivot) and 1 last (the tip)");
  }
  std::vector<BoomStation> profile;
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (i > 0 && position[i] <= position[i - 1]) {
      reader.report("position", common::shortest(position[i]) + " after " + common::shortest(position[i - 1]),
                    "numbers that rise");
    }
    profile.push_back({position[i], half_width[i], half_height[i]});
  }
  return profile;
}

BoomParameters read_boom(YamlReader reader) {
  constexpr int kMostElements = 1024;
  BoomParameters boom;
  boom.element_count = reader.integer("elements", 0, kMostElements);
  boom.length = sized(reader, "length", Unit::metre, positive(), kLength);
  boom.mass = sized(reader, "mass", Unit::kilogram, positive(), kMass);
  boom.angle = reader.number("angle", Unit::radian, between(0.0, kRightAngle));
  boom.pivot_radius = sized(reader, "pivot_radius", Unit::metre, not_negative(), kLength);
  boom.chord_outer_diameter = sized(reader, "chord_outer_diameter", Unit::metre, positive(), kLength);
  boom.chord_inner_diameter = reader.number("chord_inner_diameter", Unit::metre, not_negative());
  boom.youngs_modulus = sized(reader, "youngs_modulus", Unit::pascal, positive(), kModulus);
  boom.shear_modulus = sized(reader, "shear_modulus", Unit::pascal, positive(), kModulus);
  boom.torsion_constant = reader.number("torsion_constant", Unit::metre_to_the_fourth, positive());
  boom.damping_ratio = reader.number("damping_ratio", Unit::none, between(0.0, 1.0));
  boom.profile = read_profile(reader.map("profile"));
  reader.finish();
  if (boom.chord_outer_diameter > 0.0 && boom.chord_inner_diameter >= boom.chord_outer_diameter) {
    reader.report("chord_inner_diameter", common::shortest(boom.chord_inner_diameter) + " m",
                  "less than chord_outer_diameter, " + common::shortest(boom.chord_outer_diameter) + " m");
  }
  return boom;
}

LoadParameters read_load(YamlReader reader) {
  LoadParameters load;
  load.mass = sized(reader, "mass", Unit::kilogram, not_negative(), kMass);
  load.rope_length = sized(reader, "rope_length", Unit::metre, positive(), kLength);
  load.rod_length = sized(reader, "rod_length", Unit::metre, not_negative(), kLength);
  load.damping_ratio = reader.number("damping_ratio", Unit::none, between(0.0, 1.0));
  reader.finish();
  return load;
}

}  // namespace

void read_crane(YamlReader& reader, MachineFile& file) {
  CraneParameters& crane = file.parameters;
  reader.heading("crane");
  crane.drive = read_drive(reader.map("drive"));
  crane.house = read_house(reader.map("house"));
  if (reader.has("boom")) {
    crane.boom = read_boom(reader.map("boom"));
  } else {
    crane.boom.element_count = 0;
  }
  if (reader.has("load")) crane.load = read_load(reader.map("load"));
  if (reader.has("drive_protection")) file.drive_protection = read_drive_protection(reader.map("drive_protection"), {});
}

}  // namespace slewlab::sim
