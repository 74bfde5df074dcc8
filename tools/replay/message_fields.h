#pragma once

// The fields of the wire's messages one by one, for comparing messages of two runs to the bit. Left out are the
// configuration (a replay takes over the recorded one), what a message is found by (key_of), and whether a
// CONTROLLER_STATE follows a TORQUE (that one is compared itself).

#include <bit>
#include <cstdint>

#include "msgs/messages.h"

namespace slewlab::tools {

struct FieldValue {
  const char* name;
  int index;          // in an array, -1 otherwise
  const char* unit;
  double value;       // for people
  std::int64_t bits;  // equal if and only if the fields are the same to the bit
};

template <class Visit>
class FieldVisitor {
 public:
  explicit FieldVisitor(Visit& visit) : visit_(visit) {}

  void number(const char* name, const char* unit, double value, int index = -1) {
    visit_(FieldValue{name, index, unit, value, std::bit_cast<std::int64_t>(value)});
  }
  void integer(const char* name, const char* unit, std::int64_t value, int index = -1) {
    visit_(FieldValue{name, index, unit, static_cast<double>(value), value});
  }
  void numbers(const char* name, const char* unit, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) number(name, unit, values[i], static_cast<int>(i));
  }
  void integers(const char* name, const char* unit, const std::vector<std::int64_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) integer(name, unit, values[i], static_cast<int>(i));
  }

 private:
  Visit& visit_;
};

template <class Visit>
void visit_fields(const msgs::Encoder& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.integer("operator_sequence", "-", message.operator_sequence);
  fields.integer("group_count", "-", message.group_count);
  fields.numbers("shaft_speed", "rad/s", message.shaft_speed);
  fields.numbers("shaft_position", "rad", message.shaft_position);
}

template <class Visit>
void visit_fields(const msgs::Sensors& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.number("house_acceleration", "m/s^2", message.house_acceleration);
  fields.number("pivot_acceleration", "m/s^2", message.pivot_acceleration);
  fields.number("middle_acceleration", "m/s^2", message.middle_acceleration);
  fields.number("tip_acceleration", "m/s^2", message.tip_acceleration);
  fields.number("slew_angle", "rad", message.slew_angle);
}

template <class Visit>
void visit_fields(const msgs::Truth& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.integer("group_count", "-", message.group_count);
  fields.numbers("gearbox_torque", "Nm", message.gearbox_torque);
  fields.numbers("gear_deflection", "rad", message.gear_deflection);
  fields.integers("play_crossings", "-", message.play_crossings);
  fields.number("house_speed", "rad/s", message.house_speed);
  fields.number("tip_displacement", "m", message.tip_displacement);
  fields.number("tip_velocity", "m/s", message.tip_velocity);
  fields.number("rope_angle", "rad", message.rope_angle);
  fields.number("rod_angle", "rad", message.rod_angle);
  fields.number("mechanical_energy", "J", message.mechanical_energy);
  fields.number("supplied_work", "J", message.supplied_work);
  fields.numbers("shear_force", "N", message.shear_force);
  fields.numbers("modal_energy", "J", message.modal_energy);
}

// What the drive did; the counts of a wall clock are no part of it.
template <class Visit>
void visit_fields(const msgs::PlantStatus& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.integer("drive_state", "-", message.drive_state);
  fields.integer("trip_cause", "-", message.trip_cause);
}

template <class Visit>
void visit_fields(const msgs::Torque& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("sequence", "-", message.sequence);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.integer("alive_counter", "-", message.alive_counter);
  fields.integer("enable", "-", message.enable);
  fields.integer("brake", "-", message.brake);
  fields.integer("acknowledge", "-", message.acknowledge);
  fields.integer("group_count", "-", message.group_count);
  fields.numbers("motor_torque", "Nm", message.motor_torque);
}

template <class Visit>
void visit_fields(const msgs::ControllerState& message, Visit visit) {
  FieldVisitor fields(visit);
  fields.integer("sequence", "-", message.sequence);
  fields.integer("simulated_time", "ns", message.simulated_time);
  fields.integer("mode", "-", message.mode);
  fields.number("ramped_speed", "rad/s", message.ramped_speed);
  fields.number("average_torque", "Nm", message.average_torque);
  fields.number("offset_torque", "Nm", message.offset_torque);
  fields.integer("group_count", "-", message.group_count);
  fields.numbers("proportional_torque", "Nm", message.proportional_torque);
  fields.numbers("integral_torque", "Nm", message.integral_torque);
}

// By what a message finds its like in the other run.
inline std::int64_t key_of(const msgs::Encoder& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Sensors& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Truth& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::PlantStatus& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Torque& message) { return message.answered_sequence; }
inline std::int64_t key_of(const msgs::ControllerState& message) { return message.answered_sequence; }

}  // namespace slewlab::tools
