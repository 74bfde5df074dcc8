#include "diagnosis/validate_lead.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controller/effects/catalogue.h"
#include "diagnosis/doubt.h"
#include "diagnosis/stochastic.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kMostValidated = 4;  // causes that are asked to predict before none is believed
constexpr double kWorthReading = 0.05;  // probability from which a cause behind the lead is asked as well; chosen

ValidationError on_both(const std::vector<ValidationError>& errors) { return together(errors[0], errors[1]); }

}  // namespace

Validator::Validator(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, Point parameters_of_all, bool are_parameters_likely)
    : problem_(problem), whitening_(whitening), controller_(controller), parameters_of_all_(std::move(parameters_of_all)), are_parameters_likely_(are_parameters_likely) {}

void Validator::make_parts() {
  if (!parts_.empty()) return;
  for (const HeldOutPart held : {HeldOutPart::last, HeldOutPart::first}) parts_.emplace_back(problem_, whitening_, held);
  for (HeldOutData& data : parts_) {
    const HeldOut fitted = data.fit(parameters_of_all_);
    nominal_.push_back(data.error({}, controller_));
    parameters_.push_back(data.error(fitted, controller_));
    parameters_points_.push_back(fitted.point);
  }
}

bool Validator::is_nothing_left() const { return are_parameters_likely_ && std::min(on_both(nominal_).residual_ratio, on_both(parameters_).residual_ratio) <= 1.0; }

// Puts what the parts have simulated to the problem's count.
void Validator::count() {
  std::int64_t simulations = 0, simulation_time = 0;
  for (const HeldOutData& data : parts_) {
    simulations += data.simulations();
    simulation_time += data.simulation_time();
  }
  problem_.simulations += simulations - std::exchange(simulations_, simulations);
  problem_.simulation_time += simulation_time - std::exchange(simulation_time_, simulation_time);
}

// `part` is what of the cause's machine can be fitted again.
Validator::Predicted Validator::predict(const Cause& cause, const Point& part) {
  make_parts();
  const bool is_said_by_parameters =
      !are_parameters_likely_ && std::all_of(part.effects.begin(), part.effects.end(), [&](const common::EffectInstance& effect) {
        return !problem_.catalogue.at(effect.name).stands_for.empty();
      });
  // Of a draw only the power is fitted again, not its shape (how long a burst lasts): the last part alone is asked.
  const bool has_draws = !stochastic_part(problem_.catalogue, part).empty();
  Predicted predicted;
  std::vector<HeldOut>& fitted = predicted.fitted;
  for (HeldOutData& data : parts_) {
    if (fitted.empty() || !has_draws) fitted.push_back(data.fit(part));
  }
  Validation& validation = predicted.validation;
  validation.nominal = has_draws ? nominal_[0] : on_both(nominal_);
  validation.parameters = has_draws ? parameters_[0] : on_both(parameters_);
  std::optional<controller::ControllerSettings> with = controller_;
  if (with) with = controller::with_effects(*controller_, cause.controller_effects);
  validation.cause = parts_[0].error(fitted[0], with);
  if (has_draws) {
    const Point rest = without_stochastic(problem_.catalogue, fitted[0].point);
    validation.unknown_cost = std::min(parts_[0].unknown_cost(rest), parts_[0].unknown_cost(parameters_points_[0]));
  } else {
    validation.cause = together(validation.cause, parts_[1].error(fitted[1], with));
  }
  validation.is_said_by_parameters = is_said_by_parameters;
  validation.holds = holds(validation, is_said_by_parameters);
  count();
  return predicted;
}

std::optional<HeldOut> Validator::validate_lead(Ranking& ranking, std::vector<std::string>& remarks) {
  for (int tried = 0;; ++tried) {
    sort_causes(ranking.causes);
    Cause& lead = ranking.causes.front();
    if (lead.effects.empty() || lead.validation || kOutsideTheCatalogue * ranking.unknown > lead.probability) return std::nullopt;
    const std::optional<Point> part = fitted_part(problem_.catalogue, lead.point);
    if (!part) return std::nullopt;
    if (tried == kMostValidated) {
      for (Cause& cause : ranking.causes) {
        if (!cause.effects.empty()) take_away(1.0, is_nothing_left(), cause, ranking);
      }
      remarks.push_back("no cause that was tried predicts data that were not fitted better than the nominal machine");
      continue;
    }
    Predicted predicted = predict(lead, *part);
    const Validation& validation = predicted.validation;
    lead.validation = validation;
    if (validation.holds) {
      const std::optional<double> before = validation.parameters.closed_loop, after = validation.cause.closed_loop;
      if (before && after && *after > kWorse * *before) {
        remarks.push_back(fmt::format("the closed loop with {} is further off than with parameters alone ({:.2g} after {:.2g} of the signals), though where the model "
                                                "is led along the record, the residual variance ratio is {:.2g} and not {:.2g}",
                                                name_of(lead), *after, *before, validation.cause.residual_ratio, validation.parameters.residual_ratio));
      }
      return std::move(predicted.fitted.front());
    }
    if (validation.unknown_cost && !is_nothing_left()) {
      hand_on(1.0, [&](const std::string& effect) { return is_stochastic(problem_.catalogue, effect); }, false, lead, ranking);
    } else {
      take_away(1.0, is_nothing_left(), lead, ranking);
    }
  }
}

void Validator::validate_others(Ranking& ranking) {
  for (Cause& cause : ranking.causes) {
    if (cause.effects.empty() || cause.validation || cause.probability < kWorthReading) continue;
    if (const std::optional<Point> part = fitted_part(problem_.catalogue, cause.point)) cause.validation = predict(cause, *part).validation;
  }
}

}  // namespace slewlab::diagnosis
