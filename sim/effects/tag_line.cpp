// Tag line: a line from the load to a winch on the crane house keeps the load from swinging,
//   F = -k (y_1 - r_tip theta_house) - c (y_1' - r_tip omega_house)
// on the load, and the moment -F r_tip on the house. It pulls against the house's rotation, not against the
// bending boom.
// Source: textbook; not in the thesis.
#include "sim/effects/effect.h"

#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class TagLine : public Running<TagLine> {
 public:
  explicit TagLine(const EffectStart& start)
      : stiffness_(start.value("stiffness")),
        damping_(start.value("damping")),
        radius_(tip_radius(start.model.parameters.boom)),
        has_load_(start.model.has_load) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (!has_load_) return;
    const double force = -stiffness_ * (moment.load_displacement - radius_ * moment.house_angle) -
                         damping_ * (moment.load_velocity - radius_ * moment.house_speed);
    ports.load_force += force;
    ports.house_torque -= force * radius_;
  }

 private:
  double stiffness_, damping_, radius_;
  bool has_load_;
};

}  // namespace

const EffectDescription& tag_line() {
  static const EffectDescription description{
      .about = {.name = "tag_line",
                .subsystem = common::Subsystem::load,
                .physics = "a line to the crane house holds the load back",
                .parameters = {{.name = "stiffness",
                                .unit = common::Unit::newton_per_metre,
                                .per = common::ScaleOf::lateral_stiffness,
                                .meaning = "of the line across the boom",
                                .lower = 0.0,
                                .upper = 0.2409,
                                .typical = 0.006021,
                                .prior_scale = 0.003612,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "damping",
                                .unit = common::Unit::newton_second_per_metre,
                                .per = common::ScaleOf::lateral_damping,
                                .meaning = "of the line across the boom",
                                .lower = 0.0,
                                .upper = 0.5976,
                                .typical = 0.0239,
                                .prior_scale = 0.01195,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.boom = true, .load = true},
                .family = common::Family::elasticity,
                .linear = true},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TagLine>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
