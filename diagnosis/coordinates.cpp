#include "diagnosis/coordinates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "common/unit.h"

namespace slewlab::diagnosis {

namespace {

// Of a parameter's prior.
double centre_of(const common::EffectParameter& parameter) {
  return parameter.absent && std::isfinite(*parameter.absent) ? *parameter.absent : parameter.typical;
}

// Place of an arrow's angle among its parameters.
std::size_t angle_of(const common::EffectAbout& about) {
  return static_cast<std::size_t>(std::find_if(about.parameters.begin(), about.parameters.end(), is_all_round) - about.parameters.begin());
}

// An arrow's length, in the unit of its size, and its direction [rad], with the parameters that they are.
struct Arrow {
  const common::EffectParameter& size;
  const common::EffectParameter& angle;
  double length, direction;
  Arrow(const common::EffectAbout& about, const common::EffectInstance& effect)
      : size(about.parameters[common::kSize]), angle(about.parameters[angle_of(about)]), length(effect.values[common::kSize]), direction(effect.values[angle_of(about)]) {}
  double turn_to(const Arrow& other) const { return std::remainder(other.direction - direction, 2.0 * std::numbers::pi); }
};

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

std::vector<common::EffectInstance> effects_moved(const common::EffectCatalogue& catalogue, std::vector<common::EffectInstance> effects, const Eigen::VectorXd& step) {
  const std::vector<common::EffectInstance> from = effects;
  effects = effects_at(catalogue, std::move(effects), effect_coordinates(catalogue, from) + step);
  Eigen::Index i = 0;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    const common::EffectAbout& about = catalogue.at(effects[e].name);
    if (about.is_arrow) {
      const Arrow arrow(about, from[e]);
      const std::size_t angle = angle_of(about);
      const double along = arrow.length + arrow.size.prior_scale * step(i + static_cast<Eigen::Index>(common::kSize));
      const double across = arrow.length * arrow.angle.prior_scale * step(i + static_cast<Eigen::Index>(angle));
      effects[e].values[common::kSize] = std::clamp(std::hypot(along, across), arrow.size.lower, arrow.size.upper);
      effects[e].values[angle] = std::remainder(arrow.direction + std::atan2(across, along), 2.0 * std::numbers::pi);
    }
    i += static_cast<Eigen::Index>(effects[e].values.size());
  }
  return effects;
}

Eigen::VectorXd effects_step(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> from, std::span<const common::EffectInstance> to) {
  Eigen::VectorXd step = effect_coordinates(catalogue, to) - effect_coordinates(catalogue, from);
  Eigen::Index i = 0;
  for (std::size_t e = 0; e < from.size(); ++e) {
    const common::EffectAbout& about = catalogue.at(from[e].name);
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      double& part = step(i + static_cast<Eigen::Index>(p));
      if (is_all_round(about.parameters[p])) part = std::remainder(part, 2.0 * std::numbers::pi / about.parameters[p].prior_scale);
    }
    if (about.is_arrow) {
      const Arrow arrow(about, from[e]), other(about, to[e]);
      const double turn = arrow.turn_to(other);
      step(i + static_cast<Eigen::Index>(common::kSize)) = (other.length * std::cos(turn) - arrow.length) / arrow.size.prior_scale;
      // The angle of an arrow of no length says nothing.
      step(i + static_cast<Eigen::Index>(angle_of(about))) = arrow.length > 0.0 ? other.length * std::sin(turn) / arrow.length / arrow.angle.prior_scale : 0.0;
    }
    i += static_cast<Eigen::Index>(from[e].values.size());
  }
  return step;
}

Eigen::MatrixXd step_axes(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> from, std::span<const common::EffectInstance> to) {
  const Eigen::Index count = effect_coordinates(catalogue, from).size();
  Eigen::MatrixXd axes = Eigen::MatrixXd::Identity(count, count);
  Eigen::Index i = 0;
  for (std::size_t e = 0; e < from.size(); ++e) {
    const common::EffectAbout& about = catalogue.at(from[e].name);
    if (about.is_arrow) {
      const Arrow arrow(about, from[e]), other(about, to[e]);
      const double turn = arrow.turn_to(other), size = arrow.size.prior_scale, angle = arrow.angle.prior_scale;
      const Eigen::Index r = i + static_cast<Eigen::Index>(common::kSize), a = i + static_cast<Eigen::Index>(angle_of(about));
      axes(r, r) = std::cos(turn);
      axes(r, a) = -std::sin(turn) * other.length * angle / size;
      axes(a, r) = arrow.length > 0.0 ? std::sin(turn) * size / (arrow.length * angle) : 0.0;
      axes(a, a) = arrow.length > 0.0 ? std::cos(turn) * other.length / arrow.length : 0.0;
    }
    i += static_cast<Eigen::Index>(from[e].values.size());
  }
  return axes;
}

double value_per_deviation(const common::EffectParameter& parameter, double value) {
  return parameter.scale == common::ParameterScale::logarithmic ? value * parameter.prior_scale : parameter.prior_scale;
}

}  // namespace slewlab::diagnosis
