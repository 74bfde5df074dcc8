#include "sim/machine/crane_file.h"

#include <cmath>
#include <numbers>

#include "common/yaml_reader.h"

namespace slewlab::sim {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

constexpr double kRightAngle = 0.5 * std::numbers::pi;  // [rad]

DriveParameters read_drive(YamlReader reader) {
  DriveParameters drive;
  drive.group_count = reader.integer("groups", 1, kMaximumGroupCount);
  drive.motors_per_group = reader.integer("motors_per_group", 1, 100);
  drive.motor_inertia = reader.number("motor_inertia", Unit::kilogram_square_metre, positive());
  drive.brake_inertia = reader.number("brake_inertia", Unit::kilogram_square_metre, not_negative());
  drive.gearbox_inertia = reader.number("gearbox_inertia", Unit::kilogram_square_metre, not_negative());
  drive.gearbox_ratio = reader.number("gearbox_ratio", Unit::none, positive());
  drive.pinion_ratio = reader.number("pinion_ratio", Unit::none, positive());
  drive.gearbox_stiffness = reader.number("gearbox_stiffness", Unit::newton_metre_per_radian, positive());
  drive.gear_damping_ratio = reader.number("gear_damping_ratio", Unit::none, between(0.0, 1.0));
  drive.gearbox_play = reader.number("gearbox_play", Unit::radian, not_negative());
  drive.pinion_play = reader.number("pinion_play", Unit::radian, not_negative());
  drive.rated_torque = reader.number("rated_torque", Unit::newton_metre, positive());
  drive.top_speed = reader.number("top_speed", Unit::radian_per_second, positive());
  reader.finish();
  return drive;
}

HouseParameters read_house(YamlReader reader) {
  HouseParameters house;
  house.inertia = reader.number("inertia", Unit::kilogram_square_metre, positive());
  house.sensor_radius = reader.number("sensor_radius", Unit::metre, not_negative());
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
  boom.length = reader.number("length", Unit::metre, positive());
  boom.mass = reader.number("mass", Unit::kilogram, positive());
  boom.angle = reader.number("angle", Unit::radian, between(0.0, kRightAngle));
  boom.pivot_radius = reader.number("pivot_radius", Unit::metre, not_negative());
  boom.chord_outer_diameter = reader.number("chord_outer_diameter", Unit::metre, positive());
  boom.chord_inner_diameter = reader.number("chord_inner_diameter", Unit::metre, not_negative());
  boom.youngs_modulus = reader.number("youngs_modulus", Unit::pascal, positive());
  boom.shear_modulus = reader.number("shear_modulus", Unit::pascal, positive());
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
  load.mass = reader.number("mass", Unit::kilogram, not_negative());
  load.rope_length = reader.number("rope_length", Unit::metre, positive());
  load.rod_length = reader.number("rod_length", Unit::metre, not_negative());
  load.damping_ratio = reader.number("damping_ratio", Unit::none, between(0.0, 1.0));
  reader.finish();
  return load;
}

// Times of the drive are whole nanoseconds, as all times of the wire.
std::int64_t read_time(YamlReader& reader, std::string_view key) {
  constexpr double kLongest = 3600.0;  // [s]
  constexpr double kNanosecondsPerSecond = 1e9;
  return std::llround(reader.number(key, Unit::second, between(0.0, kLongest)) * kNanosecondsPerSecond);
}

BrakeSettings read_brake(YamlReader reader) {
  BrakeSettings brake;
  brake.torque = reader.number("torque", Unit::newton_metre, not_negative());
  brake.closing_delay = read_time(reader, "closing_delay");
  brake.closing_time_constant = reader.number("closing_time_constant", Unit::second, not_negative());
  brake.release_delay = read_time(reader, "release_delay");
  brake.release_time_constant = reader.number("release_time_constant", Unit::second, not_negative());
  reader.finish();
  return brake;
}

DriveProtectionSettings read_drive_protection(YamlReader reader) {
  constexpr int kOldestAnswer = 1000;  // [cycles]
  DriveProtectionSettings protection;
  protection.torque_limit = reader.number("torque_limit", Unit::newton_metre, positive());
  protection.torque_rate_limit = reader.number("torque_rate_limit", Unit::newton_metre_per_second, positive());
  protection.alive_timeout = read_time(reader, "alive_timeout");
  protection.silence_timeout = read_time(reader, "silence_timeout");
  protection.answer_age_limit = reader.integer("answer_age_limit", 0, kOldestAnswer);
  protection.standstill_speed = reader.number("standstill_speed", Unit::radian_per_second, not_negative());
  protection.trip_on_group_lost = reader.flag("trip_on_group_lost");
  protection.brake = read_brake(reader.map("brake"));
  reader.finish();
  return protection;
}

}  // namespace

CraneFile load_crane_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(problems);

  CraneFile result;
  CraneParameters& crane = result.parameters;
  YamlReader reader(root, "", problems);
  reader.heading("crane");
  crane.drive = read_drive(reader.map("drive"));
  crane.house = read_house(reader.map("house"));
  if (reader.has("boom")) {
    crane.boom = read_boom(reader.map("boom"));
  } else {
    crane.boom.element_count = 0;
  }
  if (reader.has("load")) crane.load = read_load(reader.map("load"));
  if (reader.has("drive_protection")) result.drive_protection = read_drive_protection(reader.map("drive_protection"));
  if (const common::YamlNode* effects = reader.raw("effects")) result.effects = *effects;
  reader.finish();
  if (!problems.empty()) throw common::InputError(problems);
  result.canonical_text = common::canonical_text(root);
  return result;
}

}  // namespace slewlab::sim
