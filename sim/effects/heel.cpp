// Heel: the vessel lies inclined by phi, downhill at the angle psi from the boom's first direction.
// Gravity then has a part across the boom,
//   f = g sin(phi) sin(psi - theta_house)  [m/s^2],
// on every mass of boom, load and rod; the house's centre of mass lies on the axis. An accelerometer
// cannot tell gravity from motion: it reads a - f. The loss of gravity along the rope, 1 - cos(phi), is
// left out.
// Source: textbook; thesis 1.1 names "static heel of the crane" as part of the current calculations.
#include "sim/effects/effect.h"

#include "sim/effects/accelerometers.h"
#include <cmath>
#include <numbers>

#include "sim/integrate/body_force.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class Heel : public Running<Heel> {
 public:
  explicit Heel(const EffectStart& start)
      : gravity_(kGravity * std::sin(start.value("angle"))),
        direction_(start.value("direction")),
        masses_(masses_of(start.model.parameters)) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    add_body_force(masses_, gravity_ * std::sin(direction_ - moment.house_angle), ports);
  }

  void sensor(const SensorMoment& moment, PlantReadings& readings) override {
    const double lateral = gravity_ * std::sin(direction_ - moment.house_angle);
    add_to_accelerometers(readings, [&](std::string_view) { return -lateral; });
  }

 private:
  double gravity_;  // [m/s^2] along the slope
  double direction_;
  BodyMasses masses_;
};

}  // namespace

const EffectDescription& heel() {
  static const EffectDescription description{
      .about = {.name = "heel",
                .subsystem = common::Subsystem::house,
                .physics = "the crane stands inclined, so that gravity pushes the boom downhill",
                .parameters = {{.name = "angle",
                                .unit = common::Unit::radian,
                                .meaning = "inclination",
                                .lower = 0.0,
                                .upper = 0.15,
                                .typical = 0.02,
                                .prior_scale = 0.01,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("direction",
                                                       "downhill, from the boom's first direction", 0.5 * std::numbers::pi)},
                .is_arrow = true,
                .needs = {.boom = true},
                .family = common::Family::gravity},
      .ports = {EffectPort::force, EffectPort::sensor},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Heel>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
