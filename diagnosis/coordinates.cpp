#include "diagnosis/coordinates.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/unit.h"

namespace slewlab::diagnosis {

namespace {

// Of a parameter's prior.
double centre_of(const common::EffectParameter& parameter) {
  return parameter.absent && std::isfinite(*parameter.absent) ? *parameter.absent : parameter.typical;
}

}  // namespace

double to_coordinate(const common::EffectParameter& parameter, double value) {
  if (parameter.scale == common::ParameterScale::logarithmic) {
    return std::log(value / centre_of(parameter)) / parameter.prior_scale;
  }
  return (value - centre_of(parameter)) / parameter.prior_scale;
}

bool is_all_round(const common::EffectParameter& parameter) {
  return parameter.unit == common::Unit::radian && !parameter.absent && parameter.lower <= -std::numbers::pi &&
         parameter.upper >= std::numbers::pi;
}

bool is_at_a_bound(const common::EffectParameter& parameter, double value) {
  return !is_all_round(parameter) && (value <= parameter.lower || value >= parameter.upper);
}

double value_at(const common::EffectParameter& parameter, double coordinate) {
  const double centre = centre_of(parameter);
  const double value = parameter.scale == common::ParameterScale::logarithmic
                           ? centre * std::exp(coordinate * parameter.prior_scale)
                           : centre + coordinate * parameter.prior_scale;
  return is_all_round(parameter) ? std::remainder(value, 2.0 * std::numbers::pi) : std::clamp(value, parameter.lower, parameter.upper);
}

Eigen::VectorXd effect_coordinates(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> effects) {
  std::vector<double> x;
  for (const common::EffectInstance& effect : effects) {
    const common::EffectAbout& about = catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p) x.push_back(to_coordinate(about.parameters[p], effect.values[p]));
  }
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::vector<common::EffectInstance> effects_at(const common::EffectCatalogue& catalogue, std::vector<common::EffectInstance> effects,
                                               const Eigen::VectorXd& coordinates) {
  Eigen::Index i = 0;
  for (common::EffectInstance& effect : effects) {
    const common::EffectAbout& about = catalogue.at(effect.name);
    for (std::size_t p = 0; p < effect.values.size(); ++p) effect.values[p] = value_at(about.parameters[p], coordinates(i++));
  }
  return effects;
}

double value_per_deviation(const common::EffectParameter& parameter, double value) {
  return parameter.scale == common::ParameterScale::logarithmic ? value * parameter.prior_scale : parameter.prior_scale;
}

}  // namespace slewlab::diagnosis
