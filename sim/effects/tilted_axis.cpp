// Gravity on an axis that is not upright: what turns with it has its centre of mass to one side, and gravity pulls that
// downhill,
//   T = T_g sin(psi - theta),   T_g = m g r sin(tilt),
// psi being the angle of the axis at which the centre of mass lies lowest. Of a horizontal axis tilt is 90 degrees.
// It acts on the axis as a whole; heel is what a crane's boom and load make of the same inclination.
// Source: textbook (physical pendulum). Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>
#include <numbers>

namespace slewlab::sim {

namespace {

class TiltedAxis : public Running<TiltedAxis> {
 public:
  explicit TiltedAxis(const EffectStart& start) : torque_(start.value("torque")), direction_(start.value("direction")) {}

  void force(const EffectMoment& moment, PortForces& forces) override {
    forces.house_torque += torque_ * std::sin(direction_ - moment.house_angle);
  }

 private:
  double torque_;     // [Nm]
  double direction_;  // [rad]
};

}  // namespace

const EffectDescription& tilted_axis() {
  static const EffectDescription description{
      .about = {.name = "tilted_axis",
                .subsystem = common::Subsystem::house,
                .physics = "gravity pulls what turns on a tilted axis downhill",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "largest, a quarter turn from the lowest place",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 0.05,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("direction", "angle of the axis, from where it stands at first, at which the centre of mass is lowest",
                                                       0.5 * std::numbers::pi)},
                .is_arrow = true,
                .family = common::Family::gravity},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TiltedAxis>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
