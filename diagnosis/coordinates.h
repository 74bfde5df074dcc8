// Parameters of effects as coordinates: in standard deviations of their priors, zero where the effect is absent or, where that is nowhere finite, at
// its typical size (docs/diagnosis/method.md, 6).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/effect.h"

namespace slewlab::diagnosis {

// Coordinates of effect parameters in standard deviations of their priors.
double to_coordinate(const common::EffectParameter& parameter, double value);
// The same back, within the parameter's bounds.
double value_at(const common::EffectParameter& parameter, double coordinate);
// An angle that may be any: what goes beyond half a turn comes back from the other side.
bool is_all_round(const common::EffectParameter& parameter);
// Whether it ends there; an angle that may be any has no bounds.
bool is_at_a_bound(const common::EffectParameter& parameter, double value);
// How much `value` changes per standard deviation of its prior, in its own unit.
double value_per_deviation(const common::EffectParameter& parameter, double value);

// Of all parameters of the effects, in their order; and the effects with their parameters there, within their bounds.
Eigen::VectorXd effect_coordinates(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> effects);
std::vector<common::EffectInstance> effects_at(const common::EffectCatalogue& catalogue, std::vector<common::EffectInstance> effects,
                                               const Eigen::VectorXd& coordinates);

// A step in coordinates, from effects to the same with other parameters, and back. Of an effect that is an arrow (common/effect.h) size r and angle a span the plane of the arrow's tip,
//
//   along = r' cos(a' - a) - r,    across / r = r' sin(a' - a) / r,
//
// so that a descent has no curved valley before it where two arrows do nearly the same, and passes through none at all to the other side; elsewhere it is the difference of the coordinates, angles by the shorter way round.
std::vector<common::EffectInstance> effects_moved(const common::EffectCatalogue& catalogue, std::vector<common::EffectInstance> effects, const Eigen::VectorXd& step);
Eigen::VectorXd effects_step(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> from, std::span<const common::EffectInstance> to);

// What steps from `from` are as steps from `to`: those from `to` times this, where differences by the former are known. The axes of an arrow turn with it.
Eigen::MatrixXd step_axes(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> from, std::span<const common::EffectInstance> to);

}  // namespace slewlab::diagnosis
