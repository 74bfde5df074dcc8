#include "tools/soak/settings.h"

#include <cmath>
#include <numbers>

#include "common/readable_number.h"
#include "common/yaml_reader.h"

namespace slewlab::tools {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

constexpr double kRightAngle = 0.5 * std::numbers::pi;  // [rad]

std::int64_t read_time(YamlReader& reader, const char* key) {
  constexpr double kLongest = 1e5;  // [s]
  return std::llround(reader.number(key, Unit::second, {1e-9, kLongest, true}) * 1e9);
}

void check_multiple(YamlReader& reader, const char* key, std::int64_t time, std::int64_t of, const char* what) {
  if (of <= 0 || time % of == 0) return;
  reader.report(key, common::readable_time(time), std::string("a whole multiple of the ") + what + ", " + common::readable_time(of));
}

SoakRange read_range(YamlReader reader, Unit unit, common::Range allowed, const char* lowest, const char* highest) {
  SoakRange range;
  range.lowest = reader.number(lowest, unit, allowed);
  range.highest = reader.number(highest, unit, allowed);
  if (range.highest < range.lowest) {
    reader.report(highest, common::shortest(range.highest), std::string("at least ") + lowest + ", " +
                                                                common::shortest(range.lowest));
  }
  reader.finish();
  return range;
}

TaskRanges read_ranges(YamlReader& reader) {
  constexpr int kMostFaults = 20;
  constexpr double kLongestFault = 1e4;  // [s]
  TaskRanges ranges;
  YamlReader task = reader.map("task");
  ranges.duration = read_time(task, "duration");
  ranges.plant_step = read_time(task, "plant_step");
  ranges.controller_period = read_time(task, "controller_period");
  check_multiple(task, "controller_period", ranges.controller_period, ranges.plant_step, "plant step");
  check_multiple(task, "duration", ranges.duration, ranges.controller_period, "controller period");
  task.finish();
  ranges.boom_angle =
      read_range(reader.map("boom_angle"), Unit::radian, between(0.0, kRightAngle), "lowest", "highest");
  ranges.rope_length = read_range(reader.map("rope_length"), Unit::metre, positive(), "lowest", "highest");
  YamlReader load = reader.map("load");
  ranges.largest_mass = load.number("largest_mass", Unit::kilogram, not_negative());
  ranges.largest_moment = load.number("largest_moment", Unit::newton_metre, positive());
  ranges.no_load = load.number("none", Unit::none, between(0.0, 1.0));
  load.finish();
  YamlReader hand = reader.map("operator");
  ranges.hold.lowest = hand.number("shortest_hold", Unit::second, positive());
  ranges.hold.highest = hand.number("longest_hold", Unit::second, positive());
  if (ranges.hold.highest < ranges.hold.lowest) hand.report("longest_hold", "less", "at least shortest_hold");
  ranges.emergency_stop = hand.number("emergency_stop", Unit::none, between(0.0, 1.0));
  ranges.watched_sidelead = hand.number("watched_sidelead", Unit::radian, positive());
  hand.finish();
  YamlReader faults = reader.map("faults");
  ranges.most_faults = faults.integer("most", 1, kMostFaults);
  ranges.longest_fault = faults.number("longest", Unit::second, between(0.0, kLongestFault));
  faults.finish();
  return ranges;
}

SoakLimits read_limits(YamlReader reader) {
  constexpr int kMany = 1'000'000'000;
  SoakLimits limits;
  limits.house_speed = reader.number("house_speed", Unit::radian_per_second, positive());
  limits.sidelead = reader.number("sidelead", Unit::radian, positive());
  limits.rod_angle = reader.number("rod_angle", Unit::radian, positive());
  limits.energy_error = reader.number("energy_error", Unit::none, positive());
  limits.heap_growth = reader.integer("heap_growth", 0, kMany);
  limits.resident_growth = reader.integer("resident_growth", 0, kMany);
  reader.finish();
  return limits;
}

}  // namespace

void read_soak_settings(YamlReader& reader, SoakSettings& settings) {
  reader.heading("soak");
  settings.ranges = read_ranges(reader);
  settings.limits = read_limits(reader.map("limits"));
}

SoakSettings load_soak_settings(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(problems);
  YamlReader reader(root, "", problems);
  SoakSettings settings;
  read_soak_settings(reader, settings);
  reader.finish();
  if (!problems.empty()) throw common::InputError(problems);
  settings.canonical_text = common::canonical_text(root);
  return settings;
}

}  // namespace slewlab::tools
