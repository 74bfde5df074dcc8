#include "controller/controller_file.h"

#include <utility>

#include "controller/controller_tree.h"

namespace slewlab::controller {
namespace {

using common::Unit;

struct Change {
  std::string_view section, key;  // no section: at the top
  double from, to;
  Unit unit;
};

}  // namespace

ControllerFile load_controller_file(const std::filesystem::path& file,
                                    const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  try {
    return controller_of(root, std::move(problems));
  } catch (const common::InputError& error) {
    throw common::InputError(as_given(error.problems(), overrides));
  }
}

std::string changes_text(const ControllerSettings& from, const ControllerSettings& to, std::string_view source) {
  const Change changes[] = {
      {"", "motor_torque_rated", from.rated_torque, to.rated_torque, Unit::newton_metre},
      {"", "motor_torque_limit", from.limits.torque, to.limits.torque, Unit::newton_metre},
      {"", "motor_torque_rate_limit", from.limits.rate, to.limits.rate, Unit::newton_metre_per_second},
      {"", "speed_filter_time", from.speed_filter_time, to.speed_filter_time, Unit::second},
      {"ramp", "top_speed", from.ramp.top_speed, to.ramp.top_speed, Unit::radian_per_second},
      {"ramp", "acceleration_time", from.ramp.acceleration_time, to.ramp.acceleration_time, Unit::second},
      {"ramp", "deceleration_time", from.ramp.deceleration_time, to.ramp.deceleration_time, Unit::second},
      {"ramp", "emergency_stop_time", from.ramp.emergency_stop_time, to.ramp.emergency_stop_time, Unit::second},
      {"ramp", "curved_share", from.ramp.curved_share, to.ramp.curved_share, Unit::none},
      {"speed_control", "proportional_gain", from.speed_control.proportional_gain, to.speed_control.proportional_gain,
       Unit::newton_metre_second_per_radian},
      {"speed_control", "integral_time", from.speed_control.integral_time, to.speed_control.integral_time, Unit::second},
      {"speed_control", "droop", from.speed_control.droop, to.speed_control.droop, Unit::radian_per_second}};
  std::string text, open;
  for (const Change& change : changes) {
    if (change.from == change.to) continue;
    if (!change.section.empty() && change.section != open) text += (open = change.section) + ":\n";
    text += (change.section.empty() ? "" : "  ") + std::string(change.key) + ": " +
            common::quantity_text(common::shortest(change.to), change.unit, source) + "\n";
  }
  const PlayCompensationSettings& play = to.play_compensation;
  const auto half = [&](std::string_view key, auto member) {
    bool differs = false;
    std::string list;
    for (std::size_t i = 0; i < static_cast<std::size_t>(play.point_count); ++i) {
      differs = differs || play.points[i].*member != from.play_compensation.points[i].*member;
      list += (i > 0 ? ", " : "") + common::shortest(play.points[i].*member);
    }
    return differs ? "  " + std::string(key) + ": " + common::quantity_text("[" + list + "]", Unit::none, source) + "\n" : std::string();
  };
  const std::string halves = half("half_1", &PlayMapPoint::half_1) + half("half_2", &PlayMapPoint::half_2);
  return halves.empty() ? text : text + "play_compensation:\n" + halves;
}

}  // namespace slewlab::controller
