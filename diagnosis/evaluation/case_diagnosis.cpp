#include "diagnosis/evaluation/case_diagnosis.h"

#include <algorithm>

#include "controller/controller_file.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/evaluation/random.h"
#include "diagnosis/live_hypotheses.h"
#include "diagnosis/prediction.h"
#include "msgs/run_log.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_file.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

Record load_record(const std::filesystem::path& log, const AdmissionSettings& admission, bool accelerometers) {
  const msgs::RunLogs logs = msgs::read_run_logs(log);
  msgs::RunLog run = logs.runs.at(0);
  if (!accelerometers) run.sensors.clear();
  return make_record(run, log.filename().string(), admission);
}

// In ramps, as candidate_manoeuvres() has them.
withheld::Manoeuvre planned(const Manoeuvre& manoeuvre) {
  withheld::Manoeuvre plan{{}, kManoeuvreDuration};
  for (const SpeedRequest& request : manoeuvre.requests) plan.requests.push_back({request.time, request.speed});
  return plan;
}

}  // namespace

CaseData load_case(const withheld::CaseInput& input, bool accelerometers) {
  CaseData data;
  data.nominal = sim::machine_settings(sim::load_machine_file(input.crane));
  data.controller = controller::load_controller_file(input.controller).settings;
  const AdmissionSettings admission = thresholds_of(sim::describe(data.nominal.crane)).admission;
  for (const std::filesystem::path& log : input.logs) {
    data.records.push_back(load_record(log, admission, accelerometers));
  }
  data.unseen = load_record(input.unseen, admission, true);
  return data;
}

withheld::CaseResult diagnose_case(const withheld::CaseInput& input, const CaseSettings& settings,
                                   const std::function<bool()>& is_stopped) {
  withheld::CaseResult result;
  result.name = input.name;
  try {
    CaseData data = load_case(input, settings.accelerometers);
    DiagnosisSettings with = settings.diagnosis;
    with.without = input.without;
    const Diagnosis diagnosis = diagnose(data.nominal, data.controller, data.records, with, {}, is_stopped);
    result.gap = diagnosis.gap;
    result.probability_unknown = diagnosis.probability_unknown;
    result.subsystems = diagnosis.subsystems;
    result.seconds = diagnosis.total_seconds;
    result.simulations = diagnosis.simulations;
    for (const Cause& cause : diagnosis.causes) {
      withheld::NamedCause named{cause.effects, cause.probability, {}, {}, cause.residual_power, cause.prior,
                                 {cause.information.begin(), cause.information.end()}, cause.mean_square, {}, {}};
      if (cause.validation) {
        named.held_out_ratio = cause.validation->cause.residual_ratio;
        named.nominal_held_out_ratio = cause.validation->nominal.residual_ratio;
      }
      for (const std::vector<std::string>& other : cause.also) named.group.push_back(name_of(other));
      for (const Alike& other : cause.group) named.group.push_back(other.name);
      for (const Size& size : cause.sizes) {
        const std::size_t dot = size.parameter.find('.');
        named.sizes.push_back({size.parameter.substr(0, dot), size.parameter.substr(dot + 1), size.value, size.low, size.high});
      }
      result.causes.push_back(named);
    }
    result.follows = followed_variables(diagnosis.discrepancies);
    const sim::MachineSettings cut = as_fitted(data.nominal, diagnosis);
    if (const auto next = manoeuvre_after(cut, data.controller, diagnosis, data.records.front(), is_stopped)) {
      result.next = planned(next->manoeuvre);
      result.drawn = planned(candidate_manoeuvres(1, withheld::Random(1, input.name).bits()).back());
    }
    result.unseen_before = predict(data.nominal, data.controller, data.unseen).relative_gap;
    result.unseen_after = result.unseen_before;
    if (!diagnosis.causes.empty()) {
      const Cause& first = diagnosis.causes.front();
      result.unseen_after =
          predict(machine_at(cut, diagnosis.nuisances, first.point), controller::with_effects(data.controller, first.controller_effects), data.unseen)
              .relative_gap;
    }
  } catch (const NotAdmitted& problem) {
    result.refusal = problem.what();
  }
  return result;
}

double informed_gap(const withheld::CaseInput& input, const std::vector<std::string>& effects,
                    const CaseSettings& settings, const std::function<bool()>& is_stopped) {
  CaseData data = load_case(input, settings.accelerometers);
  DiagnosisSettings with = settings.diagnosis;
  // Told the effects: everything else is left out of the catalogue.
  const auto told = [&](std::string_view name) { return std::find(effects.begin(), effects.end(), name) != effects.end(); };
  const common::EffectCatalogue known = joined(sim::effects_for(data.nominal), controller::effects_for(data.controller));
  for (const common::EffectAbout& about : known.effects) {
    if (!told(about.name)) with.without.emplace_back(about.name);
  }
  const Diagnosis diagnosis = diagnose(data.nominal, data.controller, data.records, with, {}, is_stopped);
  double best = predict(data.nominal, data.controller, data.unseen).relative_gap;
  // Of its fits, the one with most of the told effects and the smallest residual.
  const Cause* chosen = nullptr;
  for (const Cause& cause : diagnosis.causes) {
    if (chosen == nullptr || cause.effects.size() > chosen->effects.size() ||
        (cause.effects.size() == chosen->effects.size() && cause.mean_square < chosen->mean_square)) {
      chosen = &cause;
    }
  }
  if (chosen != nullptr) {
    best = predict(machine_at(as_fitted(data.nominal, diagnosis), diagnosis.nuisances, chosen->point),
                   controller::with_effects(data.controller, chosen->controller_effects), data.unseen)
               .relative_gap;
  }
  return best;
}

}  // namespace slewlab::diagnosis
