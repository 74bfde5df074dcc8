#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "common/input_error.h"
#include "diagnosis/evaluation/make.h"
#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "tools/campaign/study.h"
#include "tools/python/core/bindings.h"
#include "tools/soak/task_run.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

nb::str text(std::string_view words) { return nb::str(words.data(), words.size()); }

nb::dict study_of(const std::filesystem::path& path, const Changes& changes) {
  const Study study = load_study_file(path, overrides_of(changes));
  nb::list scenarios, vary;
  for (const std::filesystem::path& each : study.scenarios) scenarios.append(nb::cast(each));
  for (const VariedKey& each : study.vary) {
    nb::dict varied;
    varied["key"] = each.key;
    varied["spread"] = text(name_of(each.spread));
    varied["values"] = nb::cast(each.values);
    varied["unit"] = each.unit;
    varied["whole"] = each.whole;
    vary.append(varied);
  }
  nb::dict told;
  told["scenarios"] = scenarios;
  told["limits"] = study.limits.empty() ? nb::object(nb::none()) : nb::cast(study.limits);
  told["draw"] = text(name_of(study.draw));
  told["runs"] = study.runs;
  told["seed"] = study.seed;
  told["vary"] = vary;
  told["soak"] = nb::none();
  told["withheld"] = nb::none();
  if (study.soak) {
    nb::dict soak;
    soak["settings"] = nb::cast(study.soak->settings);
    soak["crane"] = nb::cast(study.soak->crane);
    soak["controller"] = nb::cast(study.soak->controller);
    soak["faults"] = study.soak->faults;
    told["soak"] = soak;
  }
  if (study.withheld) {
    nb::dict withheld;
    withheld["crane"] = nb::cast(study.withheld->crane);
    withheld["controller"] = nb::cast(study.withheld->controller);
    withheld["rate"] = study.withheld->rate;
    withheld["sensors"] = study.withheld->sensors;
    withheld["begin"] = study.withheld->begin;
    told["withheld"] = withheld;
  }
  return told;
}

SoakPlan soak_plan(const std::filesystem::path& settings, const std::filesystem::path& crane, const std::filesystem::path& controller, bool faults,
                   std::uint64_t seed) {
  SoakPlan plan;
  plan.settings = load_soak_settings(settings);
  plan.crane = crane;
  plan.controller = controller;
  plan.faults = faults;
  plan.seed = seed;
  return plan;
}

nb::dict soak_task(const SoakPlan& plan, std::int64_t number, const std::filesystem::path& folder) {
  const TaskResult result = [&] {
    const nb::gil_scoped_release release;
    return run_task(plan, number, folder, [] { return false; });
  }();
  nb::dict verdicts;
  for (const char* name : kInvariantNames) verdicts[name] = "pass";
  nb::list reasons;
  constexpr double kSecond = 1e9;  // [ns]
  for (const Violation& one : result.violations) {
    verdicts[name_of(one.invariant)] = "fail";
    reasons.append(nb::make_tuple(name_of(one.invariant), static_cast<double>(one.time) / kSecond, one.what));
  }
  verdicts.attr("pop")(name_of(Invariant::memory));  // is over a worker's tasks, and no one task's
  nb::dict told;
  told["description"] = result.description;
  told["log_digest"] = msgs::hash_text(static_cast<std::int64_t>(result.log_digest));
  told["simulated_seconds"] = static_cast<double>(result.simulated_time) / kSecond;
  told["trips"] = result.trips;
  told["play_crossings"] = result.play_crossings;
  told["verdicts"] = verdicts;
  told["violations"] = reasons;
  // What was measured, and its limit: [-], [rad/s], [rad].
  nb::dict measured;
  const SoakLimits& limits = plan.settings.limits;
  measured[name_of(Invariant::energy_balance)] = nb::make_tuple(result.energy_error, limits.energy_error, "-");
  measured[name_of(Invariant::speed_limit)] = nb::make_tuple(result.house_speed, limits.house_speed, "rad/s");
  measured[name_of(Invariant::angle_limit)] = nb::make_tuple(result.sidelead, limits.sidelead, "rad");
  told["measured"] = measured;
  return told;
}

diagnosis::withheld::MakeSettings withheld_set(int cases, std::uint64_t seed, const std::filesystem::path& folder, const std::filesystem::path& crane,
                                               const std::filesystem::path& controller, double rate, const std::string& sensors, const std::string& begin) {
  using namespace diagnosis::withheld;
  MakeSettings settings;
  settings.cases = cases;
  settings.seed = seed;
  settings.purpose = seed < kFirstScoringSeed ? Purpose::kTune : Purpose::kScore;
  settings.directory = folder;
  settings.crane = crane;
  settings.controller = controller;
  settings.record_period = settings.controller_period = 1.0 / rate;
  settings.sensors = sensors_named(sensors);
  settings.begin = begin_named(begin);
  return settings;
}

}  // namespace

void bind_campaign(nb::module_& m) {
  m.def("load_study", &study_of, nb::arg("path"), nb::arg("changes"), "A study file as a dict; InputError with every problem of it.");
  m.def("log_digest", [](const std::filesystem::path& path) { return msgs::hash_text(msgs::log_digest(path)); }, nb::arg("path"),
        "Of every byte of a log, as summary.json of a run tells it.");

  nb::class_<SoakPlan>(m, "SoakPlan", "The tasks of a soak (docs/soak.md).")
      .def("__init__",
           [](SoakPlan* self, const std::filesystem::path& settings, const std::filesystem::path& crane, const std::filesystem::path& controller, bool faults,
              std::uint64_t seed) { new (self) SoakPlan(soak_plan(settings, crane, controller, faults, seed)); },
           nb::arg("settings"), nb::arg("crane"), nb::arg("controller"), nb::arg("faults"), nb::arg("seed"))
      .def_prop_ro("configuration_hash", [](const SoakPlan& plan) { return msgs::hash_text(msgs::configuration_hash(plan_text(plan))); },
                   "Equal hash, equal tasks for equal seed and faults.")
      .def("run", &soak_task, nb::arg("number"), nb::arg("folder"), "Runs a task, its log in the folder; what it was and what broke.");

  using diagnosis::withheld::MakeSettings;
  nb::class_<MakeSettings>(m, "WithheldSet", "A set of withheld cases (docs/withheld.md).")
      .def("__init__",
           [](MakeSettings* self, int cases, std::uint64_t seed, const std::filesystem::path& folder, const std::filesystem::path& crane,
              const std::filesystem::path& controller, double rate, const std::string& sensors, const std::string& begin) {
             new (self) MakeSettings(withheld_set(cases, seed, folder, crane, controller, rate, sensors, begin));
           },
           nb::arg("cases"), nb::arg("seed"), nb::arg("folder"), nb::arg("crane"), nb::arg("controller"), nb::arg("rate"), nb::arg("sensors"), nb::arg("begin"))
      .def("begin", &diagnosis::withheld::begin_set, nb::call_guard<nb::gil_scoped_release>(), "Before its first case.")
      .def("make", &diagnosis::withheld::make_one, nb::arg("number"), nb::call_guard<nb::gil_scoped_release>(),
           "A case, from 1 on, where it is not complete yet.")
      .def("seal", &diagnosis::withheld::seal_set, nb::call_guard<nb::gil_scoped_release>(), "When all are there.");
}

}  // namespace slewlab::tools
