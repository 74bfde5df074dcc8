#include "sim/machine/crane_file.h"

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "common/readable_number.h"
#include "sim/machine/drive_protection_file.h"
#include "sim/machine/possible_value.h"
#include "sim/machine/sensors_file.h"
#include "sim/model/boom.h"

namespace slewlab::sim {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

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
                  common::readable(position.front()) + " to " + common::readable(position.back()),
                  "0 first (the pivot) and 1 last (the tip)");
  }
  std::vector<BoomStation> profile;
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (i > 0 && position[i] <= position[i - 1]) {
      reader.report("position", common::readable(position[i]) + " after " + common::readable(position[i - 1]),
                    "numbers that rise");
    }
    profile.push_back({position[i], half_width[i], half_height[i]});
  }
  return profile;
}

LuffingCylinders read_cylinders(YamlReader reader) {
  LuffingCylinders cylinders;
  cylinders.stiffness = sized(reader, "stiffness", Unit::newton_per_metre, positive(), kStiffness);
  cylinders.position = reader.number("position", Unit::none, between(0.01, 1.0));
  cylinders.spacing = reader.number("spacing", Unit::metre, not_negative());
  cylinders.base_radius = reader.number("base_radius", Unit::metre, common::any_number());
  cylinders.base_height = reader.number("base_height", Unit::metre, common::any_number());
  if (reader.has("oil_column")) cylinders.oil_column = sized(reader, "oil_column", Unit::metre, positive(), kLength);
  reader.finish();
  return cylinders;
}

// Whether the boom's luffing cylinders have a lever on it that carries it: half of the boom's weight at its tip, on a lever of a hundredth of the boom, is
// fifty times it, a slip of the geometry.
bool is_carried(const CraneParameters& crane, double force) {
  constexpr double kMostWeights = 50.0;
  return std::fabs(force) <= kMostWeights * kGravity * (crane.boom.mass + crane.load.mass);
}

double carried_force(const CraneParameters& crane, double angle) {
  BoomParameters there = crane.boom;
  there.angle = angle;
  return cylinder_force(there, crane.load.mass + there.jib_mass);
}

// Where the cylinders have no lever on the boom, they hold nothing.
void carry(YamlReader& reader, CraneParameters& crane) {
  BoomParameters& boom = crane.boom;
  if (boom.cylinders.stiffness == 0.0 || boom.length == 0.0) return;
  boom.cylinders.force = carried_force(crane, boom.angle);
  if (!is_carried(crane, boom.cylinders.force)) {
    reader.report("boom", "luffing_cylinders that lie along the boom: they would carry " + common::readable(boom.cylinders.force) + " N",
                  "a base_radius and base_height that give them a lever about the pivot");
  }
}

// The same at the ends of the range. Between them the lever has a single extremum and no zero that the ends do not show, and the cylinders grow
// or shrink all the way.
void expect_cylinders_to_luff(YamlReader& luffing, const CraneParameters& crane, const MotionParameters& motions) {
  const BoomParameters& boom = crane.boom;
  if (boom.cylinders.stiffness == 0.0 || boom.length == 0.0) return;
  const auto look = [&](const char* key, double angle) {
    const std::string at = common::readable_angle(angle) + ", where the cylinders ";
    const double lever = cylinder_lever(boom, angle);
    if (lever * cylinder_lever(boom, boom.angle) <= 0.0 || !is_carried(crane, carried_force(crane, angle))) {
      luffing.report(key, at + "have a lever of " + common::readable(lever) + " m about the pivot", "an angle at which they carry the boom, or another base_radius and base_height");
    } else if (boom.cylinders.oil_column > 0.0 && oil_column(boom, angle) <= 0.0) {
      luffing.report(key, at + "have an oil column of " + common::readable(oil_column(boom, angle)) + " m", "an angle with some of it left, or a longer boom.luffing_cylinders.oil_column");
    }
  };
  look("lowest_angle", motions.lowest_angle);
  look("highest_angle", motions.highest_angle);
}

MotionRates read_rates(YamlReader& reader, Unit speed, Unit acceleration) {
  return {.top_speed = sized(reader, "top_speed", speed, positive(), kSpeed), .acceleration = sized(reader, "acceleration", acceleration, positive(), kSpeed)};
}

// The motions beside slewing. Each may be absent.
MotionParameters read_motions(YamlReader& reader, const CraneParameters& crane, bool has_boom, bool has_load) {
  MotionParameters motions;
  if (reader.has("hoisting")) {
    YamlReader hoisting = reader.map("hoisting");
    motions.hoisting = read_rates(hoisting, Unit::metre_per_second, Unit::metre_per_second_squared);
    motions.shortest_rope = sized(hoisting, "shortest_rope", Unit::metre, positive(), kLength);
    hoisting.finish();
    if (!has_load) reader.report("hoisting", "a winch", "a section 'load' with what hangs on its rope, or no such section");
    if (has_load && crane.load.rope_length > 0.0 && motions.shortest_rope > crane.load.rope_length) {
      hoisting.report("shortest_rope", common::readable(motions.shortest_rope) + " m", "not more than load.rope_length, " + common::readable(crane.load.rope_length) + " m");
    }
  }
  if (reader.has("luffing")) {
    YamlReader luffing = reader.map("luffing");
    motions.luffing = read_rates(luffing, Unit::radian_per_second, Unit::radian_per_second_squared);
    motions.lowest_angle = luffing.number("lowest_angle", Unit::radian, between(0.0, kRightAngle));
    motions.highest_angle = luffing.number("highest_angle", Unit::radian, between(0.0, kRightAngle));
    luffing.finish();
    if (!has_boom) reader.report("luffing", "a luffing gear", "a section 'boom', or no such section");
    if (has_boom && (crane.boom.angle < motions.lowest_angle || crane.boom.angle > motions.highest_angle)) {
      luffing.report("lowest_angle", common::readable_angle(motions.lowest_angle) + " to highest_angle " + common::readable_angle(motions.highest_angle),
                     "a range with boom.angle in it, " + common::readable_angle(crane.boom.angle));
    }
    if (has_boom) expect_cylinders_to_luff(luffing, crane, motions);
  }
  if (reader.has("travelling")) {
    YamlReader travelling = reader.map("travelling");
    motions.travelling = read_rates(travelling, Unit::metre_per_second, Unit::metre_per_second_squared);
    motions.travel_direction = travelling.number("direction", Unit::radian, common::any_number());
    travelling.finish();
  }
  return motions;
}

BoomParameters read_boom(YamlReader reader) {
  constexpr int kMostElements = 1024;
  BoomParameters boom;
  boom.element_count = reader.integer("elements", 0, kMostElements);
  boom.length = sized(reader, "length", Unit::metre, positive(), kLength);
  boom.mass = sized(reader, "mass", Unit::kilogram, positive(), kMass);
  boom.angle = reader.number("angle", Unit::radian, between(0.0, kRightAngle));
  boom.pivot_radius = sized(reader, "pivot_radius", Unit::metre, not_negative(), kLength);
  if (reader.has("type")) boom.type = static_cast<BoomType>(reader.choice("type", {"lattice", "box_girder", "a_frame", "knuckle"}));
  const bool is_box = boom.type == BoomType::box_girder || boom.type == BoomType::knuckle;
  // What another type has: null takes an included file's away.
  const auto not_here = [&](std::initializer_list<std::string_view> keys, const char* types) {
    for (const std::string_view key : keys) {
      if (reader.has(key)) reader.report(key, "a key of other boom types", std::string("no such key, or null, or boom.type ") + types);
    }
  };
  if (is_box) {
    not_here({"chord_outer_diameter", "chord_inner_diameter", "torsion_constant"}, "lattice or a_frame");
    boom.side_plate = sized(reader, "side_plate", Unit::metre, positive(), kLength);
    boom.flange_plate = sized(reader, "flange_plate", Unit::metre, positive(), kLength);
  } else {
    not_here({"side_plate", "flange_plate"}, "box_girder or knuckle");
    boom.chord_outer_diameter = sized(reader, "chord_outer_diameter", Unit::metre, positive(), kLength);
    boom.chord_inner_diameter = reader.number("chord_inner_diameter", Unit::metre, not_negative());
    boom.torsion_constant = reader.number("torsion_constant", Unit::metre_to_the_fourth, positive());
  }
  if (boom.type != BoomType::knuckle) not_here({"knuckle"}, "knuckle");
  if (boom.type != BoomType::a_frame) not_here({"luffing_cylinders"}, "a_frame");
  if (boom.type == BoomType::knuckle) {
    YamlReader knuckle = reader.map("knuckle");
    boom.knuckle_position = knuckle.number("position", Unit::none, between(0.05, 0.95));
    boom.knuckle_angle = knuckle.number("angle", Unit::radian, between(-kRightAngle, kRightAngle));
    knuckle.finish();
    if (boom.element_count == 1) reader.report("elements", "1", "2 or more, one on each side of the knuckle, or 0 for a rigid boom");
  }
  if (boom.type == BoomType::a_frame) boom.cylinders = read_cylinders(reader.map("luffing_cylinders"));
  boom.youngs_modulus = sized(reader, "youngs_modulus", Unit::pascal, positive(), kModulus);
  boom.shear_modulus = sized(reader, "shear_modulus", Unit::pascal, positive(), kModulus);
  boom.damping_ratio = reader.number("damping_ratio", Unit::none, between(0.0, 1.0));
  boom.profile = read_profile(reader.map("profile"));
  reader.finish();
  for (const BoomStation& station : boom.profile) {
    if (!is_box || boom.side_plate == 0.0 || boom.flange_plate == 0.0) break;
    const auto thicker = [&](const char* key, double plate, double half, const char* of) {
      if (plate < half) return false;
      reader.report(key, common::readable(plate) + " m", "less than " + std::string(of) + " everywhere, " + common::readable(half) + " m at the position " + common::readable(station.position));
      return true;
    };
    const bool is_wrong = thicker("side_plate", boom.side_plate, station.half_width, "half_width");
    if (thicker("flange_plate", boom.flange_plate, station.half_height, "half_height") || is_wrong) break;
  }
  if (boom.chord_outer_diameter > 0.0 && boom.chord_inner_diameter >= boom.chord_outer_diameter) {
    reader.report("chord_inner_diameter", common::readable(boom.chord_inner_diameter) + " m",
                  "less than chord_outer_diameter, " + common::readable(boom.chord_outer_diameter) + " m");
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
  const bool has_load = reader.has("load");
  if (has_load) crane.load = read_load(reader.map("load"));
  carry(reader, crane);
  crane.motions = read_motions(reader, crane, crane.boom.length > 0.0, has_load);
  if (reader.has("sensors")) crane.sensors = read_crane_sensors(reader.map("sensors"));
  if (reader.has("drive_protection")) file.drive_protection = read_drive_protection(reader.map("drive_protection"), {});
}

}  // namespace slewlab::sim
