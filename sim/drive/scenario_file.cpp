#include "sim/drive/scenario_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>

#include "common/readable_number.h"
#include "common/yaml_reader.h"
#include "sim/drive/fault_file.h"

namespace slewlab::sim {
namespace {

using common::between;
using common::InputError;
using common::InputProblems;
using common::Override;
using common::Unit;
using common::YamlNode;
using common::YamlReader;

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kLongest = 1e6;  // [s] of a scenario, about eleven days

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(std::llround(seconds * kNanosecondsPerSecond));
}

std::int64_t read_time(YamlReader& reader, std::string_view key) {
  return nanoseconds(reader.number(key, Unit::second, {1e-9, kLongest, true}));
}

// A time that must fall on a plant step.
void check_multiple(YamlReader& reader, std::string_view key, std::int64_t time, std::int64_t plant_step) {
  if (plant_step <= 0 || time % plant_step == 0) return;
  reader.report(key, common::readable_time(time),
                "a whole multiple of the plant step, " + common::readable_time(plant_step));
}

// A wish for another motion than slewing, in the list of `requests`. An emergency stop ends each of them.
void add_request(std::optional<double> share, const OperatorMove& move, std::vector<MotionRequest>& requests) {
  const bool stands = requests.empty() || requests.back().share == 0.0;
  if (move.emergency_stop) share = stands ? std::nullopt : std::optional(0.0);
  if (share) requests.push_back({move.time, *share});
}

// Moves of the slewing joystick; an entry that asks for other motions alone is none.
std::vector<OperatorMove> read_moves(YamlReader& scenario, std::int64_t plant_step, MotionRequests& motions) {
  std::vector<OperatorMove> moves;
  OperatorMove move;
  bool is_first = true;
  scenario.each("operator", [&](YamlReader& reader) {
    const std::int64_t last = move.time;
    move.time = nanoseconds(reader.number("time", Unit::second, between(0.0, kLongest)));
    if (reader.is_told("time")) {
      move.time = last;
    } else {
      check_multiple(reader, "time", move.time, plant_step);
      if (!is_first && move.time <= last) {
        reader.report("time", common::readable_time(move.time),
                      "later than the move before, " + common::readable_time(last));
      }
    }
    is_first = false;
    bool slews = false;
    if (const auto request = reader.optional_number("speed_request", Unit::none, between(-1.0, 1.0))) {
      move.speed_request = *request;
      slews = true;
    }
    const auto share = [&](std::string_view key) { return reader.optional_number(key, Unit::none, between(-1.0, 1.0)); };
    const std::optional<double> hoisting = share("hoisting_request"), luffing = share("luffing_request"), travelling = share("travelling_request");
    if (reader.has("emergency_stop")) {
      move.emergency_stop = reader.flag("emergency_stop");
      slews = true;
    }
    if (reader.has("acknowledge")) {
      move.acknowledge = reader.flag("acknowledge");
      slews = true;
    }
    reader.finish();
    add_request(hoisting, move, motions.hoisting);
    add_request(luffing, move, motions.luffing);
    add_request(travelling, move, motions.travelling);
    if (slews || !(hoisting || luffing || travelling)) moves.push_back(move);
  });
  return moves;
}

std::vector<EffectSwitch> read_effect_switches(YamlReader& scenario, std::int64_t controller_period) {
  std::vector<EffectSwitch> switches;
  scenario.each("effect_switches", [&](YamlReader& reader) {
    EffectSwitch change;
    change.time = nanoseconds(reader.number("time", Unit::second, between(0.0, kLongest)));
    if (controller_period > 0 && change.time % controller_period != 0) {
      reader.report("time", common::readable_time(change.time), "a whole multiple of the controller period, " + common::readable_time(controller_period));
    }
    if (!switches.empty() && change.time < switches.back().time && !reader.is_told("time")) {
      reader.report("time", common::readable_time(change.time), "no time before that of the switch before, " + common::readable_time(switches.back().time));
    }
    change.effect = reader.text("effect");
    change.on = reader.flag("on");
    reader.finish();
    switches.push_back(std::move(change));
  });
  return switches;
}

// Time of the entry of a list, [ns]; nothing where it has none that can be read.
std::optional<std::int64_t> time_of(const YamlNode& entry) {
  InputProblems ignored;
  YamlReader reader(entry, "", ignored);
  const double time = reader.number("time", Unit::second, between(0.0, kLongest));
  return ignored.empty() ? std::optional(nanoseconds(time)) : std::nullopt;
}

// The request under way where the motion first leaves what it may do: the last that asks for movement.
std::size_t request_that_leaves(const std::vector<MotionRequest>& requests, double end, const std::function<bool(double until)>& has_left) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (requests[i].share != 0.0) found = i;
    const double until = i + 1 < requests.size() ? static_cast<double>(requests[i + 1].time) / kNanosecondsPerSecond : end;
    if (has_left(std::min(until, end))) break;
  }
  return found;
}

// Whether the crane can do what is asked of it; told at the request.
void check_motions(YamlReader& reader, const Scenario& scenario, InputProblems& problems) {
  const MotionRequests& asked = scenario.motion_requests;
  const CraneParameters& crane = scenario.crane.parameters;
  const double end = static_cast<double>(scenario.duration) / kNanosecondsPerSecond;
  const auto tell = [&](const MotionRequest& request, const std::string& section, const std::string& found, const std::string& expected) {
    const std::string key = section + "_request";
    const YamlNode* moves = reader.raw("operator");
    for (std::size_t i = 0; moves != nullptr && i < moves->items.size(); ++i) {
      const YamlNode& move = moves->items[i];
      if (time_of(move) != request.time) continue;
      YamlReader(move, "operator." + std::to_string(i), problems).report(key, found, expected);
      return;
    }
    reader.report("operator", found, expected);
  };
  const auto missing = [&](const std::vector<MotionRequest>& requests, const MotionRates& rates, const std::string& section) {
    if (requests.empty() || rates.top_speed > 0.0) return requests.empty();
    tell(requests.front(), section, "a request", "no such request, or a section '" + section + "' in the crane's file with its top_speed and acceleration");
    return true;
  };
  const auto metres = [](double value) { return common::readable(value) + " m"; };
  if (!missing(asked.hoisting, crane.motions.hoisting, "hoisting")) {
    const MotionProfile profile(crane.motions.hoisting, asked.hoisting);
    const auto shortest = [&](double until) { return crane.load.rope_length - profile.largest(until); };
    const auto has_left = [&](double until) { return shortest(until) < crane.motions.shortest_rope; };
    if (has_left(end)) {
      tell(asked.hoisting[request_that_leaves(asked.hoisting, end, has_left)], "hoisting", "a hook hoisted until " + metres(shortest(end)) + " of rope are left",
           "hoisting.shortest_rope or more, " + metres(crane.motions.shortest_rope) + ": a shorter request");
    }
  }
  if (!missing(asked.luffing, crane.motions.luffing, "luffing")) {
    const MotionProfile profile(crane.motions.luffing, asked.luffing);
    const auto lowest = [&](double until) { return crane.boom.angle + profile.least(until); };
    const auto highest = [&](double until) { return crane.boom.angle + profile.largest(until); };
    const auto has_left = [&](double until) { return lowest(until) < crane.motions.lowest_angle || highest(until) > crane.motions.highest_angle; };
    if (has_left(end)) {
      tell(asked.luffing[request_that_leaves(asked.luffing, end, has_left)], "luffing",
           "a boom luffed from " + common::readable_angle(lowest(end)) + " to " + common::readable_angle(highest(end)),
           "within luffing.lowest_angle and highest_angle, " + common::readable_angle(crane.motions.lowest_angle) + " to " +
               common::readable_angle(crane.motions.highest_angle) + ": a shorter request");
    }
  }
  missing(asked.travelling, crane.motions.travelling, "travelling");
}

// Whether the file that stands under the key is there.
bool is_there(YamlReader& reader, std::string_view key, const std::filesystem::path& file) {
  if (file.empty()) return false;  // told already
  if (std::filesystem::is_regular_file(file)) return true;
  reader.report(key, "'" + file.string() + "', which cannot be read", "the name of a readable file");
  return false;
}

// The scenario's own part of the configuration: the contents of crane and controller stand for their names.
std::string own_text(YamlNode&& root) {
  std::erase_if(root.entries, [](const common::YamlEntry& entry) {
    return entry.key == name_of(MachineKind::crane) || entry.key == name_of(MachineKind::axis) || entry.key == "controller" || entry.key == "expect";
  });
  return common::canonical_text(root);
}

}  // namespace

void read_scenario(YamlReader& reader, Scenario& scenario) {
  reader.heading("scenario");
  const std::string_view key = name_of(scenario.crane.kind);
  scenario.crane_file = reader.file(key);
  const std::string_view other = name_of(scenario.crane.kind == MachineKind::crane ? MachineKind::axis : MachineKind::crane);
  if (reader.has(other)) reader.report(other, "'" + std::string(other) + "' beside '" + std::string(key) + "'", "one machine");
  scenario.controller_file = reader.file("controller");
  scenario.duration = read_time(reader, "duration");
  scenario.plant_step = read_time(reader, "plant_step");
  scenario.controller_period = read_time(reader, "controller_period");
  check_multiple(reader, "controller_period", scenario.controller_period, scenario.plant_step);
  scenario.seed = reader.integer("seed", 0, std::numeric_limits<int>::max());

  YamlReader telemetry = reader.map("telemetry");
  scenario.sensors_period = read_time(telemetry, "sensors_period");
  scenario.truth_period = read_time(telemetry, "truth_period");
  scenario.status_period = read_time(telemetry, "status_period");
  check_multiple(telemetry, "sensors_period", scenario.sensors_period, scenario.plant_step);
  check_multiple(telemetry, "truth_period", scenario.truth_period, scenario.plant_step);
  check_multiple(telemetry, "status_period", scenario.status_period, scenario.plant_step);
  telemetry.finish();

  scenario.moves = read_moves(reader, scenario.plant_step, scenario.motion_requests);
  scenario.effect_switches = read_effect_switches(reader, scenario.controller_period);
  if (reader.has("expect")) scenario.expectation = read_expectation(reader.map("expect"));
}

Scenario read_scenario_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                            InputProblems& problems) {
  Scenario scenario;
  std::vector<Override> own = overrides;
  std::vector<Override> of_crane = common::take_overrides("crane.", own), of_axis = common::take_overrides("axis.", own);
  scenario.controller_overrides = common::take_overrides("controller.", own);

  YamlNode root = common::load_yaml_file(file, own, problems);
  if (root.kind != YamlNode::Kind::map) return scenario;
  YamlReader reader(root, "", problems);
  const bool has_axis = root.find("axis") != nullptr && root.find("crane") == nullptr;
  const MachineKind kind = scenario.crane.kind = has_axis ? MachineKind::axis : MachineKind::crane;
  scenario.crane_overrides = has_axis ? of_axis : of_crane;
  for (const Override& stray : has_axis ? of_crane : of_axis) {
    reader.report(name_of(kind), "--set " + std::string(has_axis ? "crane." : "axis.") + stray.key,
                  std::string(name_of(kind)) + "." + stray.key + ": the machine of this scenario is " + (has_axis ? "an axis" : "a crane"));
  }
  read_scenario(reader, scenario);
  const std::string_view key_of_machine = name_of(kind);

  if (is_there(reader, key_of_machine, scenario.crane_file)) {
    try {
      scenario.crane = load_machine_file(scenario.crane_file, scenario.crane_overrides);
      if (scenario.crane.kind != kind) {
        reader.report(name_of(kind), "'" + scenario.crane_file.string() + "', whose kind is " + std::string(name_of(scenario.crane.kind)),
                      std::string(name_of(scenario.crane.kind)) + ": with that file's name");
      }
      for (const EffectSwitch& change : scenario.effect_switches) {
        const auto is_it = [&](const YamlNode& entry) {
          const YamlNode* name = entry.find("effect");
          return name != nullptr && name->scalar == change.effect;
        };
        const std::vector<YamlNode>& effects = scenario.crane.effects.items;
        if (std::any_of(effects.begin(), effects.end(), is_it)) continue;
        reader.report("effect_switches", "'" + change.effect + "'", "an effect that stands under 'effects' of the machine");
      }
      check_motions(reader, scenario, problems);
      if (scenario.expectation.standing_by) scenario.expectation.standing_angle = standing_angle_of(scenario.crane.parameters);
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  scenario.faults = read_faults(reader, scenario.controller_period, scenario.crane.parameters.drive,
                                static_cast<std::uint64_t>(scenario.seed));
  reader.finish();
  YamlNode controller;
  if (is_there(reader, "controller", scenario.controller_file)) {
    // What is wrong in it is for the controller's own reader to tell; only that it is there matters here.
    InputProblems told_elsewhere;
    controller =
        common::load_yaml_file(scenario.controller_file, scenario.controller_overrides, told_elsewhere);
    if (controller.kind != YamlNode::Kind::map) {
      reader.report("controller", "'" + scenario.controller_file.string() + "', which cannot be used",
                    "the name of a controller's file");
    }
  }
  scenario.configuration_text = std::string(name_of(kind)) + " " + scenario.crane.canonical_text + "\ncontroller " +
                                common::canonical_text(controller) + "\nscenario " + own_text(std::move(root)) + "\n";
  return scenario;
}

Scenario load_scenario_file(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  InputProblems problems;
  Scenario scenario = read_scenario_file(file, overrides, problems);
  if (!problems.empty()) throw InputError(problems);
  return scenario;
}

}  // namespace slewlab::sim
