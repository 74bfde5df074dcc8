// Steady wind from one direction on boom and load, quasi-steady: lateral forces
//   F = 1/2 rho (C A) (v^2 sin a - v u (1 + sin^2 a)),    a = psi - theta_house,
// evenly along the boom and on the load; psi is where the wind blows to, from the boom's first direction, u the crane's own
// lateral speed, of the boom's middle as it turns and of the load. That is the drag of the relative wind across the boom to
// first order in u: the wind damps what moves in it. The drag of own speeds in still air is left to air_drag.
// Source: textbook (drag on bluff bodies; aerodynamic damping of quasi-steady wind loads). Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>
#include <numbers>

#include "sim/effects/wind_force.h"
#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class Wind : public Running<Wind> {
 public:
  explicit Wind(const EffectStart& start)
      : speed_(start.value("speed")),
        direction_(start.value("direction")),
        boom_radius_(0.5 * (start.model.parameters.boom.pivot_radius + tip_radius(start.model.parameters.boom))),
        areas_(drag_areas(start.model.parameters, start.value("boom_drag_area"), start.value("load_drag_area"))) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double sine = std::sin(direction_ - moment.house_angle);
    const double still = speed_ * speed_ * sine;
    const double damping = speed_ * (1.0 + sine * sine);
    add_wind(areas_, 0.5 * kAirDensity * (still - damping * boom_radius_ * moment.house_speed),
             0.5 * kAirDensity * (still - damping * moment.load_velocity), ports);
  }

 private:
  double speed_;        // [m/s]
  double direction_;    // [rad]
  double boom_radius_;  // [m] of the boom's middle
  DragAreas areas_;
};

}  // namespace

const EffectDescription& wind() {
  static const EffectDescription description{
      .about = {.name = "wind",
                .subsystem = common::Subsystem::boom,
                .physics = "steady wind pushes boom and load",
                .parameters = {{.name = "speed",
                                .unit = common::Unit::metre_per_second,
                                .per = common::ScaleOf::wind_speed,
                                .meaning = "of the wind",
                                .lower = 0.0,
                                .upper = 2.853,
                                .typical = 0.8558,
                                .prior_scale = 0.2853,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("direction",
                                                       "where it blows to, from the boom's first direction", 0.5 * std::numbers::pi),
                               boom_drag_area_parameter(),
                               load_drag_area_parameter()},
                .is_arrow = true,
                .needs = {.boom = true},
                .family = common::Family::wind},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Wind>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
