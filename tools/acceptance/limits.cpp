#include "tools/acceptance/limits.h"

#include "common/yaml_file.h"

namespace slewlab::tools {

AcceptanceLimits read_acceptance_limits(common::YamlReader& reader) {
  using common::between;
  using common::not_negative;
  using common::positive;
  using common::Unit;
  reader.heading("acceptance");

  constexpr int kMany = 1'000'000;
  const auto count = [&](const char* key) -> std::optional<int> {
    if (!reader.has(key)) return std::nullopt;
    return reader.integer(key, 0, kMany);
  };
  AcceptanceLimits limits;
  limits.top_speed = reader.number("top_speed", Unit::radian_per_second, positive());
  limits.rated_torque = reader.number("motor_torque_rated", Unit::newton_metre, positive());
  limits.wrong_way = reader.optional_number("wrong_way", Unit::none, not_negative());
  limits.overshoot = reader.optional_number("overshoot", Unit::none, not_negative());
  limits.settled_within = reader.optional_number("settled_within", Unit::none, positive()).value_or(limits.settled_within);
  limits.settling_time = reader.optional_number("settling_time", Unit::second, positive());
  limits.play_crossings = count("play_crossings");
  limits.play_offset = reader.optional_number("play_offset", Unit::none, between(-1.0, 1.0));
  if (limits.play_offset) limits.play_offset_up_to = reader.number("play_offset_up_to", Unit::none, positive());
  limits.sidelead = reader.optional_number("sidelead", Unit::radian, positive());
  limits.torque_share = reader.optional_number("torque_share", Unit::none, positive());
  limits.stop_distance = reader.optional_number("stop_distance", Unit::radian, positive());
  limits.stop_time = reader.optional_number("stop_time", Unit::second, positive());
  limits.stop_overshoot = reader.optional_number("stop_overshoot", Unit::none, not_negative());
  limits.tip_acceleration = reader.optional_number("tip_acceleration", Unit::metre_per_second_squared, positive());
  limits.trips = count("trips");
  limits.standstill_after_trip = reader.optional_number("standstill_after_trip", Unit::second, positive());
  limits.dead_time = reader.optional_number("controller_dead_time", Unit::second, not_negative());
  return limits;
}

AcceptanceLimits load_acceptance_limits(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(problems);
  common::YamlReader reader(root, "", problems);
  const AcceptanceLimits limits = read_acceptance_limits(reader);
  reader.finish();
  if (!problems.empty()) throw common::InputError(problems);
  return limits;
}

}  // namespace slewlab::tools
