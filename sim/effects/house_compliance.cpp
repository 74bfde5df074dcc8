#include "sim/effects/house_compliance.h"

#include <algorithm>
#include <limits>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class HouseCompliance : public Running<HouseCompliance> {
 public:
  explicit HouseCompliance(const EffectStart& start)
      : stiffness_(start.values[0]), group_count_(start.model.group_count), gear_(start.model.gear) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    double torque = 0.0;
    double stiffness = stiffness_;
    for (int i = 0; i < group_count_; ++i) {
      if (moment.gear_torque[i] == 0.0) continue;
      torque += moment.gear_torque[i];
      stiffness += gear_[i].stiffness;
    }
    const double twist = torque / stiffness;
    for (int i = 0; i < group_count_; ++i) {
      const double rigid = moment.gear_torque[i];
      double change = gear_[i].stiffness * twist;
      // Teeth push and never pull: the twist can take a gear's torque away, no more.
      change = rigid > 0.0 ? std::min(change, rigid) : rigid < 0.0 ? std::max(change, rigid) : 0.0;
      ports.motor_torque[i] += change;
      ports.house_torque -= change;
    }
  }

 private:
  double stiffness_;
  int group_count_;
  std::array<GearContact, kMaximumGroupCount> gear_;
};

}  // namespace

const EffectDescription& house_compliance() {
  static const EffectDescription description{
      .about = {.name = "house_compliance",
                .subsystem = common::Subsystem::house,
                .physics = "the crane house twists between slew ring and boom pivot",
                .parameters = {{.name = "stiffness",
                                .unit = common::Unit::newton_metre_per_radian,
                                .meaning = "of the house in torsion, (2.9)",
                                .lower = 1e9,
                                .upper = 1e12,
                                .typical = 1e10,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity()}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<HouseCompliance>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
