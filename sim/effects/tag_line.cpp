#include "sim/effects/tag_line.h"

#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class TagLine : public Running<TagLine> {
 public:
  explicit TagLine(const EffectStart& start)
      : stiffness_(start.values[0]),
        damping_(start.values[1]),
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
                                .meaning = "of the line across the boom",
                                .lower = 0.0,
                                .upper = 2e4,
                                .typical = 500.0,
                                .prior_scale = 300.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "damping",
                                .unit = common::Unit::newton_second_per_metre,
                                .meaning = "of the line across the boom",
                                .lower = 0.0,
                                .upper = 5e4,
                                .typical = 2000.0,
                                .prior_scale = 1000.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TagLine>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
