// Air drag of the load in still air: F = -1/2 rho (C A) |v| v with v the load's lateral velocity, slewing
// included.
// Source: textbook (drag on bluff bodies). Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/wind_force.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class AirDrag : public Running<AirDrag> {
 public:
  explicit AirDrag(const EffectStart& start) : factor_(0.5 * kAirDensity * start.value("drag_area")) {}

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
                                .per = common::ScaleOf::drag_area,
                                .meaning = "drag coefficient times area of the load",
                                .lower = 0.0,
                                .upper = 2.873,
                                .typical = 0.2873,
                                .prior_scale = 0.07181,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.boom = true, .load = true},
                .family = common::Family::wind},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<AirDrag>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
