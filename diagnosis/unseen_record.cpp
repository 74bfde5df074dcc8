#include "diagnosis/unseen_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "diagnosis/admit.h"
#include "diagnosis/doubt.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kFarAboveNoise = 4.0;  // residual variance ratio, chosen: what another simulator's laws and mesh leave stays below
// Of what parameters alone leave there: a share, and times the share that the cause leaves of the fitted records, chosen.
constexpr double kLargeShare = 0.1, kTimesTheFitted = 10.0;
constexpr double kNearlyAsMuch = 0.9;   // of what is missing in the fitted records, that a cause explains which may lead in another one's place
constexpr std::size_t kMostAsked = 4;

double share_left(const Validation& validation) { return validation.cause.residual_ratio / validation.parameters.residual_ratio; }

}  // namespace

UnseenRecords::UnseenRecords(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all, std::vector<Record> unseen,
                             std::vector<std::string>& remarks)
    : problem_(problem), controller_(controller) {
  for (Record& record : unseen) {
    const std::string name = record.name;
    record.effects_from = effects_from({problem.records.data(), problem.records.size()}, record);
    try {
      HeldOutData data(problem, whitening, std::move(record), remarks);
      const HeldOut parameters = data.fit(parameters_of_all);
      const ValidationError parameters_error = data.error(parameters, controller);
      const double parameters_torque = data.missing_torque(parameters);
      UnseenRecord by_parameters{parameters.record, "", {data.error({}, controller), parameters_error, parameters_error, {}, false}, data.missing_torque({}), parameters_torque, parameters_torque};
      records_.push_back({std::move(data), std::move(by_parameters)});
    } catch (const NotAdmitted& problem_of_it) {
      remarks.push_back(fmt::format("{} could not be predicted: {}", name, problem_of_it.what()));
    }
  }
}

std::vector<UnseenRecord> UnseenRecords::judge(const Cause* cause) {
  std::optional<Point> answer;
  if (cause != nullptr) answer = fitted_part(problem_.catalogue, cause->point);
  std::vector<UnseenRecord> all;
  std::int64_t simulations = 0, simulation_time = 0;
  for (One& one : records_) {
    UnseenRecord& judged = all.emplace_back(one.by_parameters);
    if (answer) {
      const HeldOut fitted = one.data.fit(*answer);
      judged.cause = name_of(*cause);
      judged.validation.cause = one.data.error(fitted, controller_);
      judged.validation.is_said_by_parameters = cause->validation && cause->validation->is_said_by_parameters;
      judged.validation.holds = holds(judged.validation, judged.validation.is_said_by_parameters);
      judged.cause_torque = one.data.missing_torque(fitted);
    }
    simulations += one.data.simulations();
    simulation_time += one.data.simulation_time();
  }
  problem_.simulations += simulations - std::exchange(simulations_, simulations);
  problem_.simulation_time += simulation_time - std::exchange(simulation_time_, simulation_time);
  return all;
}

bool leads_astray(const Cause& cause, double parameters_mean_square, const UnseenRecord& unseen) {
  const double of_the_fitted = cause.mean_square / parameters_mean_square;
  return !unseen.cause.empty() && unseen.validation.cause.residual_ratio > kFarAboveNoise && share_left(unseen.validation) > std::max(kLargeShare, kTimesTheFitted * of_the_fitted);
}

void lead_by_what_is_unseen(UnseenRecords& records, double parameters_mean_square, std::vector<Cause>& causes, double& probability_unknown, std::vector<UnseenRecord>& judged, std::vector<std::string>& remarks) {
  if (causes.empty()) return;
  Cause& lead = causes.front();
  const auto astray = std::find_if(judged.begin(), judged.end(), [&](const UnseenRecord& one) { return leads_astray(lead, parameters_mean_square, one); });
  if (astray == judged.end()) return;
  std::string told = fmt::format("{} leaves {:.2g} times the noise of the fitted records and {:.2g} times that of {}, where the machine goes on otherwise: what it says holds for the fitted ones", name_of(lead), lead.mean_square,
                                 astray->validation.cause.residual_ratio, astray->record);
  const double lost = kDoubtTakes * lead.probability;
  std::size_t asked = 0;
  for (std::size_t behind = 1; behind < causes.size() && asked < kMostAsked; ++behind) {
    Cause& other = causes[behind];
    if (other.effects.empty() || other.explained < kNearlyAsMuch * lead.explained) continue;
    ++asked;
    std::vector<UnseenRecord> of_other = records.judge(&other);
    const bool predicts = !of_other.empty() && std::all_of(of_other.begin(), of_other.end(), [&](const UnseenRecord& one) { return one.validation.holds && !leads_astray(other, parameters_mean_square, one); });
    if (!predicts) continue;
    const UnseenRecord& there = of_other[static_cast<std::size_t>(astray - judged.begin())];
    remarks.push_back(fmt::format("{}. {} leaves {:.2g} and {:.2g} times it: it leads, and neither is sure", told, name_of(other), other.mean_square, there.validation.cause.residual_ratio));
    other.probability += lead.probability - lost;
    lead.probability = lost;
    if (!other.validation) other.validation = there.validation;
    judged = std::move(of_other);
    sort_causes(causes);
    return;
  }
  remarks.push_back(told + ", and no other cause predicts both. Judge by more logs");
  lead.probability -= lost;
  probability_unknown += lost;
}

}  // namespace slewlab::diagnosis
