// Dry friction of the axis that depends on where it stands: an uneven raceway, a bent rail or spindle, seals that are tight
// in one place,
//   T_c max(0, 1 + v cos(2 pi theta / l + phi) + s sin(4 pi theta / l) + c cos(4 pi theta / l)),
// holding at rest, l the length after which it comes again: a turn of the axis, or of a pinion, or a rail's length. By direction, and with a
// give, as bearing_friction.h.
// Source: textbook (Fourier series of a position-dependent Coulomb level). Not in the thesis.
#include "sim/effects/bearing_friction.h"
#include "sim/effects/ripple.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slewlab::sim {

namespace {

struct UnevenLevel {
  double torque;                        // [Nm]
  double variation;                     // [-]
  double order;                         // [1/rad]
  double phase;                         // [rad]
  double second_sine, second_cosine;    // [-]
  explicit UnevenLevel(const EffectStart& start)
      : torque(start.value("torque")),
        variation(start.value("variation")),
        order(2.0 * std::numbers::pi / start.value("wavelength")),
        phase(start.value("phase")),
        second_sine(start.value("second_sine")),
        second_cosine(start.value("second_cosine")) {}
  double operator()(const EffectMoment& moment) const {
    const double at = order * moment.house_angle;
    const double share = 1.0 + variation * std::cos(at + phase) + second_sine * std::sin(2.0 * at) + second_cosine * std::cos(2.0 * at);
    return torque * std::max(0.0, share);
  }
};

// A share of the mean, where Ripple's is one of the amplitude.
common::EffectParameter second(common::EffectParameter parameter, std::string_view meaning) {
  parameter.meaning = meaning;
  return parameter;
}

}  // namespace

const EffectDescription& bearing_uneven() {
  static const EffectDescription description{
      .about = {.name = "bearing_uneven",
                .subsystem = common::Subsystem::house,
                .physics = "dry friction that depends on where the axis stands",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction, mean over all places",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.05,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "variation",
                                .unit = common::Unit::none,
                                .meaning = "amplitude over the place, share of the mean",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 0.5,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "wavelength",
                                .unit = common::Unit::radian,
                                .meaning = "angle of the axis after which the friction comes again",
                                .lower = 0.02,
                                .upper = 13.0,
                                .typical = 2.0 * std::numbers::pi,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {0.1, 0.25, 0.6, 1.5},
                                .recurs = true},
                               common::angle_parameter("phase", "at the start; 0: most friction there"),
                               second(second_sine_parameter(), "sine of half the wavelength, share of the mean"),
                               second(second_cosine_parameter(), "cosine of half the wavelength, share of the mean"),
                               asymmetry_parameter(),
                               bearing_give_parameter()},
                .family = common::Family::friction,
                .parts = [](const common::EffectValues& values) { return dry(values["torque"], values); }},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingFriction<UnevenLevel>>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
