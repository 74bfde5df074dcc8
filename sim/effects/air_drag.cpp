#include "sim/effects/air_drag.h"

#include <cmath>

#include "sim/effects/wind_force.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class AirDrag : public Running<AirDrag> {
 public:
  explicit AirDrag(const EffectStart& start) : factor_(0.5 * kAirDensity * start.values[0]) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    ports.load_force -= factor_ * std::fabs(moment.load_velocity) * moment.load_velocity;
  }

 private:
  double factor_;  // [kg/m]
};

}  // namespace

const EffectDescription& air_drag() {
  static const EffectDescription description{
      .about = {.name = "air_drag",
                .subsystem = common::Subsystem::load,
                .physics = "the air slows the load down",
                .parameters = {{.name = "drag_area",
                                .unit = common::Unit::square_metre,
                                .meaning = "drag coefficient times area of the load",
                                .lower = 0.0,
                                .upper = 2000.0,
                                .typical = 200.0,
                                .prior_scale = 50.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<AirDrag>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
