#include "controller/controller_tree.h"

#include <cmath>
#include <limits>

#include "common/readable_number.h"

namespace slewlab::controller {
namespace {

using common::between;
using common::not_negative;
using common::positive;
using common::Unit;
using common::YamlReader;

RampSettings read_ramp(YamlReader reader) {
  RampSettings ramp;
  ramp.shape = reader.choice("shape", {"s_curve", "linear"}) == 0 ? RampShape::s_curve : RampShape::linear;
  ramp.top_speed = reader.number("top_speed", Unit::radian_per_second, positive());
  ramp.acceleration_time = reader.number("acceleration_time", Unit::second, positive());
  ramp.deceleration_time = reader.number("deceleration_time", Unit::second, positive());
  ramp.emergency_stop_time = reader.number("emergency_stop_time", Unit::second, positive());
  ramp.curved_share = reader.number("curved_share", Unit::none, between(0.0, 0.5));
  reader.finish();
  return ramp;
}

SpeedControlSettings read_speed_control(YamlReader reader) {
  SpeedControlSettings control;
  control.proportional_gain =
      reader.number("proportional_gain", Unit::newton_metre_second_per_radian, positive());
  control.integral_time = reader.number("integral_time", Unit::second, positive());
  control.droop = reader.optional_number("droop", Unit::radian_per_second, not_negative()).value_or(0.0);
  reader.finish();
  return control;
}

// What a machine's file does not say follows from its speeds and times: half more than top speed, twenty times the
// acceleration of its emergency stop (which gears that meet and brakes that fall in exceed, and a wrong reading exceeds
// by far), a twentieth of top speed for noise, a thirtieth of the stop's time. All chosen.
constexpr double kSpeed = 1.5, kAcceleration = 20.0, kTolerance = 0.05, kTimeout = 1.0 / 30.0;

PlausibilitySettings read_plausibility(YamlReader& controller, const RampSettings& ramp, double total_ratio) {
  const double top_speed = ramp.top_speed * total_ratio;  // of the motor shaft
  PlausibilitySettings plausibility{.speed_limit = kSpeed * top_speed,
                                    .acceleration_limit = kAcceleration * top_speed / ramp.emergency_stop_time,
                                    .tolerance = kTolerance * top_speed,
                                    .timeout = kTimeout * ramp.emergency_stop_time};
  if (!controller.has("plausibility")) return plausibility;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  YamlReader reader = controller.map("plausibility");
  if (const auto given = reader.optional_number("speed_limit", Unit::none, {1.0, kAny, false})) {
    plausibility.speed_limit = *given * top_speed;
  }
  plausibility.acceleration_limit =
      reader.optional_number("acceleration_limit", Unit::radian_per_second_squared, positive())
          .value_or(plausibility.acceleration_limit);
  if (const auto given = reader.optional_number("tolerance", Unit::none, positive())) {
    plausibility.tolerance = *given * top_speed;
  }
  plausibility.timeout = reader.optional_number("timeout", Unit::second, not_negative()).value_or(plausibility.timeout);
  reader.finish();
  return plausibility;
}

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kLongest = 1e6;  // [s] of a scenario

std::vector<PlaySwitch> read_switches(YamlReader& play) {
  std::vector<PlaySwitch> switches;
  play.each("switches", [&](YamlReader& reader) {
    const double time = reader.number("time", Unit::second, between(0.0, kLongest));
    const PlaySwitch change{std::llround(time * kNanosecondsPerSecond), reader.flag("enabled")};
    if (!switches.empty() && change.time < switches.back().time) {
      reader.report("time", common::readable(time) + " s", "no time before that of the switch before, " +
                                                               common::readable(static_cast<double>(switches.back().time) / kNanosecondsPerSecond) + " s");
    }
    reader.finish();
    switches.push_back(change);
  });
  return switches;
}

PlayCompensationSettings read_play_compensation(YamlReader reader) {
  PlayCompensationSettings play;
  play.enabled = reader.flag("enabled");
  play.switches = read_switches(reader);
  const common::Range share = between(-1.0, 1.0);
  const std::vector<double> average =
      reader.numbers("average", Unit::none, between(0.0, 1.0), 1, kMaximumMapPoints);
  const std::vector<double> half_1 = reader.numbers("half_1", Unit::none, share, 1, kMaximumMapPoints);
  const std::vector<double> half_2 = reader.numbers("half_2", Unit::none, share, 1, kMaximumMapPoints);
  reader.finish();
  if (average.empty() || half_1.empty() || half_2.empty()) return play;

  if (half_1.size() != average.size()) {
    reader.report("half_1", "a list of " + std::to_string(half_1.size()),
                  "as many numbers as 'average' has: " + std::to_string(average.size()));
  }
  if (half_2.size() != average.size()) {
    reader.report("half_2", "a list of " + std::to_string(half_2.size()),
                  "as many numbers as 'average' has: " + std::to_string(average.size()));
  }
  if (half_1.size() != average.size() || half_2.size() != average.size()) return play;

  if (average.front() != 0.0) {
    reader.report("average", common::readable(average.front()) + " first", "0 first");
  }
  if (half_1.front() != -half_2.front()) {
    reader.report("half_2", common::readable(half_2.front()) + " first",
                  common::readable(-half_1.front()) +
                      " first, the opposite of 'half_1', so that the map joins its mirror image");
  }
  play.point_count = static_cast<int>(average.size());
  for (std::size_t i = 0; i < average.size(); ++i) {
    if (i > 0 && average[i] <= average[i - 1]) {
      reader.report("average", common::readable(average[i]) + " after " + common::readable(average[i - 1]),
                    "numbers that rise");
    }
    play.points[i] = {average[i], half_1[i], half_2[i]};
  }
  return play;
}

}  // namespace

void read_controller(YamlReader& reader, ControllerSettings& settings) {
  reader.heading("controller");
  settings.group_count = reader.integer("groups", 1, kMaximumGroups);
  settings.total_ratio = reader.number("total_ratio", Unit::none, positive());
  settings.rated_torque = reader.number("motor_torque_rated", Unit::newton_metre, positive());
  settings.limits.torque = reader.number("motor_torque_limit", Unit::newton_metre, positive());
  settings.limits.rate =
      reader.optional_number("motor_torque_rate_limit", Unit::newton_metre_per_second, positive())
          .value_or(std::numeric_limits<double>::infinity());
  settings.speed_filter_time =
      reader.optional_number("speed_filter_time", Unit::second, not_negative()).value_or(0.0);
  settings.ramp = read_ramp(reader.map("ramp"));
  settings.plausibility = read_plausibility(reader, settings.ramp, settings.total_ratio);
  settings.speed_control = read_speed_control(reader.map("speed_control"));
  settings.play_compensation = read_play_compensation(reader.map("play_compensation"));
}

ControllerFile controller_of(const common::YamlNode& root, common::InputProblems problems) {
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(problems);

  ControllerFile result;
  YamlReader reader(root, "", problems);
  read_controller(reader, result.settings);
  reader.finish();
  if (!problems.empty()) throw common::InputError(problems);
  result.canonical_text = common::canonical_text(root);
  return result;
}

}  // namespace slewlab::controller
