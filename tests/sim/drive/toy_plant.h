#pragma once

// A plant whose every output is known in closed form: one rotating mass per motor group, driven by the torque held,
// advanced exactly. With inertia J = 1 kg m^2 the speed after a torque T over t is T t.

#include <map>
#include <vector>

#include "sim/drive/driven_plant.h"

namespace slewlab::sim {

class ToyPlant : public DrivenPlant {
 public:
  explicit ToyPlant(int group_count = 2, double step = 1e-3)
      : step_(step), torque_(group_count), speed_(group_count), position_(group_count) {}

  void read_encoder(msgs::Encoder& message) override {
    message.group_count = static_cast<int>(speed_.size());
    message.shaft_speed = speed_;
    message.shaft_position = position_;
  }
  void begin_cycle(std::int64_t) override {}
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override {
    ++received[status];
    if (status != msgs::DecodeStatus::ok || message.motor_torque.size() != speed_.size()) return;
    torque_ = message.motor_torque;
    ++commands;
  }
  void step(const PlantConditions&) override {
    for (std::size_t i = 0; i < speed_.size(); ++i) {
      position_[i] += step_ * (speed_[i] + 0.5 * step_ * torque_[i]);
      speed_[i] += step_ * torque_[i];
    }
    ++steps;
  }
  void read_sensors(msgs::Sensors& message) override { message.slew_angle = position_[0]; }
  void read_truth(msgs::Truth& message) override {
    message.house_speed = speed_[0];
    message.group_count = message.element_count = message.mode_count = 0;
  }
  void read_status(msgs::PlantStatus& message) override {
    message.drive_state = 1;
    message.fault_count = message.bin_count = 0;
  }

  std::map<msgs::DecodeStatus, int> received;
  int commands = 0;  // taken
  int steps = 0;

 private:
  double step_;
  std::vector<double> torque_;
  std::vector<double> speed_;
  std::vector<double> position_;
};

}  // namespace slewlab::sim
