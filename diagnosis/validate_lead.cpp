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

}  // namespace

std::optional<HeldOut> validate_lead(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const Point& parameters_of_all,
                                     bool are_parameters_likely, Ranking& ranking, std::vector<std::string>& remarks) {
  std::optional<HeldOut> held_out;
  std::vector<HeldOutData> parts;  // held out each in its turn, once there is a lead to ask
  std::vector<Point> parameters_points;               // of each part
  std::vector<ValidationError> nominal, parameters;  // on each part
  const auto on_both = [](const std::vector<ValidationError>& errors) { return together(errors[0], errors[1]); };
  for (int tried = 0;; ++tried) {
    sort_causes(ranking.causes);
    Cause& lead = ranking.causes.front();
    if (lead.effects.empty() || lead.validation || kOutsideTheCatalogue * ranking.unknown > lead.probability) break;
    const std::optional<Point> part = fitted_part(problem.catalogue, lead.point);
    if (!part) break;
    if (parts.empty()) {
      for (const HeldOutPart held : {HeldOutPart::last, HeldOutPart::first}) parts.emplace_back(problem, whitening, held);
      for (HeldOutData& data : parts) {
        const HeldOut fitted = data.fit(parameters_of_all);
        nominal.push_back(data.error({}, controller));
        parameters.push_back(data.error(fitted, controller));
        parameters_points.push_back(fitted.point);
      }
    }
    const bool is_nothing_left = are_parameters_likely && std::min(on_both(nominal).residual_ratio, on_both(parameters).residual_ratio) <= 1.0;
    const bool is_said_by_parameters =
        !are_parameters_likely && std::all_of(part->effects.begin(), part->effects.end(), [&](const common::EffectInstance& effect) {
          return !problem.catalogue.at(effect.name).stands_for.empty();
        });
    if (tried == kMostValidated) {
      for (Cause& cause : ranking.causes) {
        if (!cause.effects.empty()) take_away(1.0, is_nothing_left, cause, ranking);
      }
      remarks.push_back("no cause that was tried predicts data that were not fitted better than the nominal machine");
      continue;
    }
    // Of a draw only the power is fitted again, not its shape (how long a burst lasts): the last part alone is asked.
    const bool has_draws = !stochastic_part(problem.catalogue, *part).empty();
    std::vector<HeldOut> fitted;
    for (HeldOutData& data : parts) {
      if (fitted.empty() || !has_draws) fitted.push_back(data.fit(*part));
    }
    Validation validation{has_draws ? nominal[0] : on_both(nominal), has_draws ? parameters[0] : on_both(parameters), {}, {}, false};
    std::optional<controller::ControllerSettings> with = controller;
    if (with) with = controller::with_effects(*controller, lead.controller_effects);
    validation.cause = parts[0].error(fitted[0], with);
    if (has_draws) {
      const Point rest = without_stochastic(problem.catalogue, fitted[0].point);
      validation.unknown_cost = std::min(parts[0].unknown_cost(rest), parts[0].unknown_cost(parameters_points[0]));
    } else {
      validation.cause = together(validation.cause, parts[1].error(fitted[1], with));
    }
    validation.is_said_by_parameters = is_said_by_parameters;
    validation.holds = holds(validation, is_said_by_parameters);
    lead.validation = validation;
    if (validation.holds) {
      const std::optional<double> before = validation.parameters.closed_loop, after = validation.cause.closed_loop;
      if (before && after && *after > kWorse * *before) {
        remarks.push_back(fmt::format("the closed loop with {} is further off than with parameters alone ({:.2g} after {:.2g} of the signals), though where the model "
                                                "is led along the record, the residual variance ratio is {:.2g} and not {:.2g}",
                                                name_of(lead), *after, *before, validation.cause.residual_ratio, validation.parameters.residual_ratio));
      }
      held_out = std::move(fitted.front());
      break;
    }
    const bool is_better_without_stochastic = validation.unknown_cost && !is_nothing_left;
    if (is_better_without_stochastic) {
      hand_on(1.0, [&](const std::string& effect) { return is_stochastic(problem.catalogue, effect); }, false, lead, ranking);
    } else {
      take_away(1.0, is_nothing_left, lead, ranking);
    }
  }
  for (const HeldOutData& data : parts) {
    problem.simulations += data.simulations();
    problem.simulation_time += data.simulation_time();
  }
  return held_out;
}

}  // namespace slewlab::diagnosis
