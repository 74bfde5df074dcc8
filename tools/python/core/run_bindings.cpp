#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "common/effect.h"
#include "controller/controller_file.h"
#include "msgs/configuration_hash.h"
#include "sim/drive/scenario_file.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "tools/acceptance/judgement.h"
#include "tools/python/core/bindings.h"
#include "tools/python/core/recorded_run.h"
#include "tools/python/core/tables.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]

struct Scenario {
  Scenario(const std::filesystem::path& path, const Changes& made)
      : file(path), changes(made), scenario(sim::load_scenario_file(path, overrides_of(made))) {}

  std::filesystem::path file;
  Changes changes;
  sim::Scenario scenario;
};

// What a controller in Python answers.
struct Answer {
  std::vector<double> motor_torque;  // [N m] per motor of each group
  bool enable = true;
  bool brake = false;
  std::optional<bool> acknowledge;  // of a tripped drive; as the operator says it where the controller says nothing
};

Answer answer_of(const nb::object& said, int group_count) {
  Answer answer;
  if (!nb::try_cast(said, answer) && !nb::try_cast(said, answer.motor_torque)) {
    throw nb::type_error(("the controller answered " + std::string(nb::repr(said).c_str()) +
                          ", expected a motor torque [N m] for each of the " + std::to_string(group_count) +
                          " groups, or a slewlab.Answer").c_str());
  }
  if (answer.motor_torque.size() != static_cast<std::size_t>(group_count)) {
    throw nb::value_error(("the controller answered " + std::to_string(answer.motor_torque.size()) + " motor torque(s), expected " +
                           std::to_string(group_count) + ": one per motor group").c_str());
  }
  return answer;
}

// A callable as the controller: asked once a controller period, with the interpreter's lock taken for as long. It sends no
// CONTROLLER_STATE. A class is made anew at every start of the controller; what stands in for all starts is called on.
controller::Compute called(const nb::callable& callable) {
  // The callable's reference is counted under the lock alone, wherever copies of the function go.
  auto* kept = new nb::callable(callable);
  const std::shared_ptr<nb::callable> shared(kept, [](nb::callable* p) {
    const nb::gil_scoped_acquire lock;
    delete p;
  });
  return [shared](const msgs::Encoder& encoder, const msgs::Operator& operator_move, msgs::Torque& torque, msgs::ControllerState&) {
    const nb::gil_scoped_acquire lock;
    const Answer answer = answer_of((*shared)(encoder, operator_move), encoder.group_count);
    torque.enable = answer.enable;
    torque.brake = answer.brake;
    torque.acknowledge = answer.acknowledge.value_or(operator_move.acknowledge != 0);
    torque.state_follows = false;
    torque.group_count = encoder.group_count;
    torque.motor_torque = answer.motor_torque;
  };
}

// Ctrl-C ends the run: asked every so many controller periods, for the lock is not free.
std::function<bool()> interrupted_by_user() {
  return [periods = 0]() mutable {
    constexpr int kPeriods = 2000;
    if (++periods % kPeriods != 0) return false;
    const nb::gil_scoped_acquire lock;
    return PyErr_CheckSignals() != 0;
  };
}

nb::dict tables_of(RecordedRun& run) {
  nb::dict tables;
  for (std::size_t i = 0; i < msgs::kChannels; ++i) {
    RecordedChannel& channel = run.channels[i];
    if (channel.row_count == 0) continue;
    tables[std::string(msgs::wire_messages()[i].channel).c_str()] = nb::make_tuple(layout_of(channel.layout), row_bytes(std::move(channel.rows)));
  }
  return tables;
}

nb::dict run(const Scenario& scenario, const std::optional<nb::callable>& controller, const std::vector<std::string>& channels,
             const std::filesystem::path& log) {
  RecordedRunOptions options;
  options.log = log;
  options.stop = interrupted_by_user();
  for (const std::string& name : channels) {
    const std::optional<std::size_t> index = msgs::channel_index(name);
    if (!index) throw nb::key_error(name.c_str());
    options.keep[*index] = true;
  }
  diagnosis::NewController start;
  if (!controller) {
    start = [compute = scenario_controller(scenario.scenario)] { return compute; };
  } else if (PyType_Check(controller->ptr()) != 0) {
    start = [&controller] {
      const nb::gil_scoped_acquire lock;
      return called(nb::cast<nb::callable>((*controller)()));
    };
  } else {
    start = [compute = called(*controller)] { return compute; };
  }
  RecordedRun recorded;
  {
    const nb::gil_scoped_release release;
    recorded = record_run(scenario.scenario, start, options);
  }
  if (PyErr_Occurred() != nullptr) throw nb::python_error();
  if (recorded.controller_is_dead) throw std::runtime_error("the controller was ended by a fault of the scenario and did not come back");
  return tables_of(recorded);
}

// (why there is no verdict, [(check, verdict, measured, limit, unit, time, reason)])
nb::tuple judge(const Scenario& scenario, const std::filesystem::path& log, const std::filesystem::path& limits) {
  Judgement judgement;
  {
    const nb::gil_scoped_release release;
    judgement = judge_log(scenario.scenario, log, load_acceptance_limits(limits));
  }
  nb::list checks;
  for (const CheckResult& check : judgement.checks) {
    const bool is_number = std::isfinite(check.measured) && !check.unit.empty();
    checks.append(nb::make_tuple(check.name, std::string(verdict_name(check.verdict)), is_number ? nb::cast(check.measured) : nb::none(),
                                 check.unit.empty() ? nb::none() : nb::cast(check.limit), check.unit,
                                 check.time < 0.0 ? nb::none() : nb::cast(check.time), check.reason));
  }
  return nb::make_tuple(judgement.no_verdict, checks);
}

controller::ControllerSettings controller_settings(const Scenario& scenario) {
  return controller::load_controller_file(scenario.scenario.controller_file, scenario.scenario.controller_overrides).settings;
}

// The machine's effects as a loop of shaft speed and torque has them: delay [s] of those that are a delay and nothing else, together, their names,
// and the names of all others. Encoders and commands may be late in any order where all between them is linear.
std::tuple<double, std::vector<std::string>, std::vector<std::string>> loop_effects(const Scenario& scenario) {
  const common::EffectCatalogue known = sim::effects_for(scenario.scenario.crane);
  double delay = 0.0;
  std::vector<std::string> late, others;
  for (const common::EffectInstance& effect : sim::machine_settings(scenario.scenario.crane).effects) {
    const bool is_delay = known.at(effect.name).pure_delay != common::PureDelay::none;
    if (is_delay) delay += effect.values.at(common::kSize);
    (is_delay ? late : others).push_back(effect.name);
  }
  return {delay, late, others};
}

double seconds(std::int64_t time) { return static_cast<double>(time) * kNanosecond; }

}  // namespace

void bind_run(nb::module_& m) {
  nb::class_<msgs::Encoder>(m, "Encoder", "What the encoders on the motor shafts say at one instant.")
      .def_prop_ro("time", [](const msgs::Encoder& e) { return seconds(e.simulated_time); }, "[s] simulated")
      .def_ro("sequence", &msgs::Encoder::sequence, "counts controller periods from 0")
      .def_ro("group_count", &msgs::Encoder::group_count)
      .def_ro("shaft_speed", &msgs::Encoder::shaft_speed, "[rad/s] of each motor group, on the motor's shaft")
      .def_ro("shaft_position", &msgs::Encoder::shaft_position, "[rad] of each motor group since the start");
  nb::class_<msgs::Operator>(m, "Operator", "What the operator wants.")
      .def_ro("speed_request", &msgs::Operator::speed_request, "[-] -1 to 1 of top speed")
      .def_prop_ro("emergency_stop", [](const msgs::Operator& o) { return o.emergency_stop != 0; })
      .def_prop_ro("acknowledge", [](const msgs::Operator& o) { return o.acknowledge != 0; });
  nb::class_<Answer>(m, "Answer", "What a controller answers, where motor torques alone do not say it.")
      .def(nb::init<std::vector<double>, bool, bool, std::optional<bool>>(), nb::arg("motor_torque"), nb::arg("enable") = true,
           nb::arg("brake") = false, nb::arg("acknowledge") = nb::none())
      .def_rw("motor_torque", &Answer::motor_torque, "[N m] per motor of each group, on the motor's shaft")
      .def_rw("enable", &Answer::enable, "the drives may deliver torque")
      .def_rw("brake", &Answer::brake, "apply the disk brakes")
      .def_rw("acknowledge", &Answer::acknowledge, "of a tripped drive; None: as the operator says it");

  nb::class_<Scenario>(m, "Scenario")
      .def(nb::init<const std::filesystem::path&, const Changes&>(), nb::arg("path"), nb::arg("changes"))
      .def_ro("path", &Scenario::file)
      .def_ro("changes", &Scenario::changes)
      .def_prop_ro("duration", [](const Scenario& s) { return seconds(s.scenario.duration); })
      .def_prop_ro("plant_step", [](const Scenario& s) { return seconds(s.scenario.plant_step); })
      .def_prop_ro("controller_period", [](const Scenario& s) { return seconds(s.scenario.controller_period); })
      .def_prop_ro("seed", [](const Scenario& s) { return s.scenario.seed; })
      .def_prop_ro("machine_file", [](const Scenario& s) { return s.scenario.crane_file; })
      .def_prop_ro("controller_file", [](const Scenario& s) { return s.scenario.controller_file; })
      .def_prop_ro("machine_key", [](const Scenario& s) { return std::string(sim::name_of(s.scenario.crane.kind)); })
      .def_prop_ro("configuration_hash", [](const Scenario& s) { return msgs::hash_text(msgs::configuration_hash(s.scenario.configuration_text)); })
      .def_prop_ro("speed_loop",
                   [](const Scenario& s) {
                     const controller::ControllerSettings settings = controller_settings(s);
                     return std::tuple{settings.speed_control.proportional_gain, settings.speed_control.integral_time, settings.speed_filter_time};
                   },
                   "Proportional gain [N m s/rad] per motor, integral time [s], time constant of the filter on the measured speed [s].")
      .def_prop_ro("loop_effects", &loop_effects, "Delay [s] of the machine's effects that are a delay alone, their names, and the names of all others.")
      .def("run", &run, nb::arg("controller").none(), nb::arg("channels"), nb::arg("log"),
           "{channel: ((fields, row bytes), rows)}; the interpreter's lock is free meanwhile.")
      .def("judge", &judge, nb::arg("log"), nb::arg("limits"),
           "(why there is no verdict, [(check, verdict, measured, limit, unit, time, reason)]) of a log of this scenario.");
}

}  // namespace slewlab::tools
