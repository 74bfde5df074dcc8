#pragma once

// Messages with every field set to a value of its own, so that a swapped or lost field shows.

#include "msgs/messages.h"

namespace slewlab::msgs::example {

template <class Message>
void set_head(Message& message) {
  message.sequence = 7;
  message.simulated_time = 8'000'000;
  message.configuration_hash = -0x123456789abcdefLL;
  message.run_identity = 0x0fedcba987654321LL;
}

inline Encoder encoder(int groups = 2) {
  Encoder m{};
  set_head(m);
  m.operator_sequence = 3;
  m.group_count = groups;
  for (int i = 0; i < groups; ++i) {
    m.shaft_speed.push_back(1.5 + i);
    m.shaft_position.push_back(-2.5 - i);
  }
  return m;
}

inline Torque torque(int groups = 2) {
  Torque m{};
  set_head(m);
  m.answered_sequence = 7;
  m.alive_counter = 9;
  m.enable = 1;
  m.state_follows = 1;
  m.group_count = groups;
  for (int i = 0; i < groups; ++i) m.motor_torque.push_back(100.0 + i);
  return m;
}

inline Operator operator_move() {
  Operator m{};
  set_head(m);
  m.speed_request = -0.25;
  m.emergency_stop = 1;
  return m;
}

inline Sensors sensors() {
  Sensors m{};
  set_head(m);
  m.house_acceleration = 0.1;
  m.pivot_acceleration = 0.2;
  m.middle_acceleration = 0.3;
  m.tip_acceleration = 0.4;
  m.slew_angle = 0.5;
  return m;
}

inline Truth truth(int groups = 2, int elements = 6, int modes = 12) {
  Truth m{};
  set_head(m);
  m.group_count = groups;
  m.gearbox_torque.assign(groups, 1.0);
  m.gear_deflection.assign(groups, 2.0);
  m.play_crossings.assign(groups, 3);
  m.house_speed = 4.0;
  m.supplied_work = 5.0;
  m.element_count = elements;
  m.shear_force.assign(elements, 6.0);
  m.mode_count = modes;
  m.modal_energy.assign(modes, 7.0);
  return m;
}

inline ControllerState controller_state(int groups = 2) {
  ControllerState m{};
  set_head(m);
  m.answered_sequence = 7;
  m.mode = 2;
  m.ramped_speed = 0.05;
  m.average_torque = 48.0;
  m.offset_torque = 45.0;
  m.group_count = groups;
  m.proportional_torque.assign(groups, 11.0);
  m.integral_torque.assign(groups, 12.0);
  return m;
}

inline PlantStatus plant_status(int faults = 9, int bins = 5) {
  PlantStatus m{};
  set_head(m);
  m.drive_state = 1;
  m.trip_cause = 2;
  m.trip_time = 18;
  m.fault_count = faults;
  m.faults.assign(faults, 13);
  m.stale_commands = 14;
  m.missed_deadlines = 15;
  m.bin_count = bins;
  m.bin_edge.assign(bins, 1e-6);
  m.wakeup_latency.assign(bins, 16);
  m.step_time.assign(bins, 17);
  return m;
}

inline Motion motion() {
  Motion m{};
  set_head(m);
  m.rope_length = 20.5;
  m.hoisting_speed = 0.21;
  m.boom_angle = 0.22;
  m.luffing_speed = 0.023;
  m.travelled = 24.5;
  m.travelling_speed = 0.25;
  return m;
}

}  // namespace slewlab::msgs::example
