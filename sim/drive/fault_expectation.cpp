#include "sim/drive/fault_expectation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "msgs/run_log.h"

namespace slewlab::sim {
namespace {

bool outside(std::int64_t count, const CountRange& range) { return count < range.at_least || count > range.at_most; }

std::string text_of(const CountRange& range) {
  constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();
  return std::to_string(range.at_least) + (range.at_most == kAny ? " or more" : " to " + std::to_string(range.at_most));
}

std::string with_unit(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.6g %s", value, unit);
  return text;
}

}  // namespace

std::vector<std::string> broken_expectations(const FaultExpectation& expected, const msgs::RunLog& log) {
  std::vector<std::string> broken;
  const auto complain = [&](const std::string& what, const std::string& found, const std::string& wanted) {
    broken.push_back(what + ": found " + found + ", expected " + wanted);
  };
  if (log.plant_status.empty() || log.sensors.empty()) return {"the log has no PLANT_STATUS or no SENSORS"};
  const msgs::PlantStatus& end = log.plant_status.back();

  const auto state = static_cast<DriveState>(end.drive_state);
  if (expected.drive_state && state != *expected.drive_state) {
    complain("drive state at the end", name_of(state), name_of(*expected.drive_state));
  }
  const auto cause = static_cast<DriveFault>(end.trip_cause);
  if (expected.trip_cause && cause != *expected.trip_cause) {
    complain("trip cause at the end", name_of(cause), name_of(*expected.trip_cause));
  }
  for (int i = 1; i < end.fault_count; ++i) {
    const auto fault = static_cast<DriveFault>(i);
    const auto named = std::find_if(expected.faults.begin(), expected.faults.end(),
                                    [&](const auto& count) { return count.fault == fault; });
    CountRange range;
    if (named != expected.faults.end()) {
      range = named->count;
    } else if (expected.no_other_faults) {
      range = {0, 0};
    }
    if (outside(end.faults[i], range)) {
      complain(std::string("count of ") + name_of(fault), std::to_string(end.faults[i]), text_of(range));
    }
  }
  if (expected.stale_commands && outside(end.stale_commands, *expected.stale_commands)) {
    complain("stale commands", std::to_string(end.stale_commands), text_of(*expected.stale_commands));
  }
  if (expected.tip_acceleration) {
    double largest = 0.0;
    for (const msgs::Sensors& sensors : log.sensors) largest = std::max(largest, std::abs(sensors.tip_acceleration));
    if (!(largest <= *expected.tip_acceleration)) {
      complain("largest tip acceleration", with_unit(largest, "m/s^2"),
               "at most " + with_unit(*expected.tip_acceleration, "m/s^2"));
    }
  }
  const double end_angle = log.sensors.back().slew_angle;
  if (expected.standing_by) {
    double moved = 0.0;
    for (const msgs::Sensors& sensors : log.sensors) {
      if (sensors.simulated_time >= *expected.standing_by) moved = std::max(moved, std::abs(sensors.slew_angle - end_angle));
    }
    if (!(moved <= expected.standing_angle)) {
      complain("slew angle after " + with_unit(static_cast<double>(*expected.standing_by) * 1e-9, "s"),
               "a change of " + with_unit(moved, "rad"), "at most " + with_unit(expected.standing_angle, "rad"));
    }
  }
  if (expected.slew_angle_at_least && !(end_angle >= *expected.slew_angle_at_least)) {
    complain("slew angle at the end", with_unit(end_angle, "rad"), "at least " + with_unit(*expected.slew_angle_at_least, "rad"));
  }
  if (expected.slew_angle_at_most && !(end_angle <= *expected.slew_angle_at_most)) {
    complain("slew angle at the end", with_unit(end_angle, "rad"), "at most " + with_unit(*expected.slew_angle_at_most, "rad"));
  }
  return broken;
}

}  // namespace slewlab::sim
