#include "sim/effects/wind.h"

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
      : speed_(start.values[0]),
        direction_(start.values[1]),
        boom_radius_(0.5 * (start.model.parameters.boom.pivot_radius + tip_radius(start.model.parameters.boom))),
        areas_(drag_areas(start.model.parameters, start.values[2], start.values[3])) {}

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
                                .meaning = "of the wind",
                                .lower = 0.0,
                                .upper = 50.0,
                                .typical = 15.0,
                                .prior_scale = 5.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               common::angle_parameter("direction",
                                                       "where it blows to, from the boom's first direction", 0.5 * std::numbers::pi),
                               boom_drag_area_parameter(),
                               load_drag_area_parameter()}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Wind>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
