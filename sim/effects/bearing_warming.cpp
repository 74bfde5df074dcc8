// Friction of the axis that falls as it warms by moving: dry and viscous friction of the cold machine,
//   (T_c + d |omega|) (1 - f (1 - exp(-s / s_w))),   s = integral of |omega| over the time,
// holding at rest. By direction, and with a give, as bearing_friction.h. s is the way that the axis has gone since the start, to either side:
// what a friction of about one size turns into heat goes with it. f is the share that is lost when warm, s_w the way in which 63 % of that are.
// The way is summed by the speed in each step's middle, of second order in the step.
// Assumption: the machine is cold at the start, and does not cool in the run.
// Source: textbook (viscosity falls with temperature), the exponential as the simplest law. Not in the thesis.
#include "sim/effects/bearing_friction.h"

#include <cmath>

namespace slewlab::sim {

namespace {

struct WarmingLevel {
  double torque;       // [Nm]
  double coefficient;  // [Nm s/rad]
  double fall;         // [-]
  double way;          // [rad]
  double gone = 0.0;   // [rad] at the step's start
  explicit WarmingLevel(const EffectStart& start)
      : torque(start.value("torque")), coefficient(start.value("coefficient")), fall(start.value("fall")), way(start.value("way")) {}
  double operator()(const EffectMoment& moment) {
    const double speed = std::fabs(moment.house_speed), moved = speed * moment.step;
    const double level = (torque + coefficient * speed) * (1.0 + fall * std::expm1(-(gone + 0.5 * moved) / way));
    gone += moved;
    return level;
  }
};

}  // namespace

const EffectDescription& bearing_warming() {
  static const EffectDescription description{
      .about = {.name = "bearing_warming",
                .subsystem = common::Subsystem::house,
                .physics = "friction that falls as the machine warms",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "dry friction of the cold machine",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.05,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "coefficient",
                                .unit = common::Unit::newton_metre_second_per_radian,
                                .per = common::ScaleOf::axis_damping,
                                .meaning = "friction per speed of the cold machine",
                                .lower = 0.0,
                                .upper = 0.61,
                                .typical = 0.03,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "fall",
                                .unit = common::Unit::none,
                                .meaning = "share of the friction that is lost when warm",
                                .lower = 0.0,
                                .upper = 0.95,
                                .typical = 0.5,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "way",
                                .unit = common::Unit::radian,
                                .per = common::ScaleOf::axis_angle,
                                .meaning = "of the axis, to either side, in which 63 % of the fall have come",
                                .lower = 0.5,
                                .upper = 2000.0,
                                .typical = 10.0,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {2.0, 50.0}},
                               asymmetry_parameter(),
                               bearing_give_parameter()},
                .family = common::Family::friction,
                .parts = [](const common::EffectValues& values) { return dry_and_viscous(values["torque"], values["coefficient"], values); }},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingFriction<WarmingLevel>>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
