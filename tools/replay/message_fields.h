#pragma once

// The fields of the wire's messages one by one, for comparing messages of two runs to the bit, with the names and units of
// the .lcm files (msgs/layouts.cmake). Left out are the configuration and the run's identity (a replay takes over the
// recorded ones), what a message is found by (key_of), the counts that lengths of arrays show, whether a CONTROLLER_STATE
// follows a TORQUE (that one is compared itself), and of PLANT_STATUS what a wall clock or the recorder counts.

#include <array>
#include <bit>
#include <cstdint>
#include <slewlab_msgs/fields.hpp>
#include <string_view>
#include <type_traits>
#include <vector>

#include "msgs/messages.h"

namespace slewlab::tools {

struct FieldValue {
  const char* name;
  int index;          // in an array, -1 otherwise
  const char* unit;
  double value;       // for people
  std::int64_t bits;  // equal if and only if the fields are the same to the bit
};

// By what a message finds its like in the other run.
inline std::int64_t key_of(const msgs::Encoder& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Sensors& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Truth& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::PlantStatus& message) { return message.sequence; }
inline std::int64_t key_of(const msgs::Torque& message) { return message.answered_sequence; }
inline std::int64_t key_of(const msgs::ControllerState& message) { return message.answered_sequence; }

template <class Message>
bool is_compared(std::string_view field) {
  if (field == "configuration_hash" || field == "run_identity") return false;
  if constexpr (std::is_same_v<Message, msgs::PlantStatus>) {
    return field == "simulated_time" || field == "drive_state" || field == "trip_cause";
  } else if constexpr (std::is_same_v<Message, msgs::Torque> || std::is_same_v<Message, msgs::ControllerState>) {
    return field != "answered_sequence" && field != "state_follows";
  } else {
    return field != "sequence" && field != "element_count" && field != "mode_count";
  }
}

// Calls visit(FieldValue) for every number that is compared.
template <class Message, class Visit>
void visit_compared(const Message& message, Visit visit) {
  const auto number = [&](const char* name, const char* unit, auto value, int index) {
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      visit(FieldValue{name, index, unit, value, std::bit_cast<std::int64_t>(static_cast<double>(value))});
    } else {
      visit(FieldValue{name, index, unit, static_cast<double>(value), static_cast<std::int64_t>(value)});
    }
  };
  const auto field = [&](const char* name, const char* unit, const auto& value) {
    if (!is_compared<Message>(name)) return;
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
      number(name, unit, value, -1);
    } else {
      for (std::size_t i = 0; i < value.size(); ++i) number(name, unit, value[i], static_cast<int>(i));
    }
  };
  msgs::visit_fields(message, field);
}

}  // namespace slewlab::tools
