// A constant torque on the axis: a load that gravity holds to one side, a cable or hose that pulls, a drive's or a torque
// sensor's offset,
//   T = T_0.
// Source: textbook (offset of a torque balance). Not in the thesis.
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

class TorqueOffset : public Running<TorqueOffset> {
 public:
  explicit TorqueOffset(const EffectStart& start) : torque_(start.value("torque")) {}

  void force(const EffectMoment&, PortForces& forces) override { forces.house_torque += torque_; }

 private:
  double torque_;  // [Nm]
};

}  // namespace

const EffectDescription& torque_offset() {
  static const EffectDescription description{
      .about = {.name = "torque_offset",
                .subsystem = common::Subsystem::house,
                .physics = "a constant torque acts on the axis",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "on the axis, positive in the direction of positive speed",
                                .lower = -0.7312,
                                .upper = 0.7312,
                                .typical = 0.05,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .family = common::Family::gravity},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TorqueOffset>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
