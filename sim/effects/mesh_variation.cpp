#include "sim/effects/mesh_variation.h"

#include "sim/effects/accelerometers.h"
#include "sim/effects/mesh_torque.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class MeshVariation : public Running<MeshVariation> {
 public:
  MeshVariation(const EffectStart& start, double amplitude, const GroupRipples& ripples, MeshAngle angle)
      : amplitude_(amplitude),
        ripples_(ripples),
        angle_(angle),
        gear_(start.model.gear),
        group_count_(start.model.group_count),
        ratio_(start.model.ratio) {
    const PlantModel& model = start.model;
    double pivot = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(model.mode_count); ++k) {
      pivot += model.pivot[k] * model.house[k];
      middle_ += model.middle[k] * model.house[k];
      tip_ += model.tip_sensor[k] * model.house[k];
    }
    house_ = model.parameters.house.sensor_radius * pivot;
    pivot_ = model.parameters.boom.pivot_radius * pivot;
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    held_ = 0.0;
    for (int i = 0; i < group_count_; ++i) {
      const double motor = moment.motor_angle[i], motor_speed = moment.motor_speed[i];
      const double change = mesh_torque(
          gear_[i],
          angle_ == MeshAngle::house ? share(i, moment.house_angle, moment.house_speed * moment.step)
                                     : share(i, motor, motor_speed * moment.step),
          motor - moment.house_angle, motor_speed - moment.house_speed);
      ports.motor_torque[i] -= change;
      ports.house_torque += change;
      held_ += change;
    }
  }

  void sensor(const SensorMoment& moment, PlantReadings& readings) override {
    double missing = -held_;
    for (int i = 0; i < group_count_; ++i) {
      const double motor = moment.truth.shaft_position[i] / ratio_, motor_speed = moment.truth.shaft_speed[i] / ratio_;
      missing += mesh_torque(gear_[i], share(i, angle_ == MeshAngle::house ? moment.house_angle : motor, 0.0),
                             motor - moment.house_angle, motor_speed - moment.house_speed);
    }
    add_to_accelerometers(readings, [&](std::string_view place) {
      return (place == "house" ? house_ : place == "pivot" ? pivot_ : place == "middle" ? middle_ : tip_) * missing;
    });
  }

 private:
  double share(int group, double angle, double turned) const {
    return amplitude_ * mean_ripple(ripples_[static_cast<std::size_t>(group)], angle, turned);
  }

  double amplitude_;
  GroupRipples ripples_;  // over the slew axis
  MeshAngle angle_;
  std::array<GearContact, kMaximumGroupCount> gear_;
  int group_count_;
  double ratio_;                                                   // motor turns per turn of the crane
  double house_ = 0.0, pivot_ = 0.0, middle_ = 0.0, tip_ = 0.0;  // [m/s^2 / Nm] readings to torque on the house
  double held_ = 0.0;                                              // [Nm] on the house over the last step
};

}  // namespace

std::unique_ptr<RunningEffect> start_mesh_variation(const EffectStart& start, double amplitude, const GroupRipples& ripples,
                                                    MeshAngle angle) {
  return std::make_unique<MeshVariation>(start, amplitude, ripples, angle);
}

}  // namespace slewlab::sim
