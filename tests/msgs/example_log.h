#pragma once

// A log as a lockstep run writes it, event by event, and what may happen to one.

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "msgs/codec.h"
#include "msgs/log_writer.h"
#include "tests/msgs/example_messages.h"

namespace slewlab::msgs::example {

struct Event {
  std::string channel;
  std::int64_t time = 0;  // [ns]
  std::vector<std::uint8_t> bytes;
};

template <class Message>
Event event(const char* channel, Message message, std::int64_t sequence, std::int64_t time) {
  message.sequence = sequence;
  message.simulated_time = time;
  message.configuration_hash = 1;
  message.run_identity = 5;
  if constexpr (requires { message.answered_sequence; }) message.answered_sequence = sequence;
  Event made{channel, time, {}};
  encode(message, made.bytes);
  return made;
}

// As a lockstep run logs it, cycles of `period` [ns].
inline std::vector<Event> run(std::int64_t cycles, std::int64_t period = 10'000'000) {
  std::vector<Event> events;
  for (std::int64_t k = 0; k < cycles; ++k) {
    const std::int64_t time = k * period;
    if (k % 17 == 0) events.push_back(event("OPERATOR", operator_move(), k / 17, time));
    events.push_back(event("ENCODER", encoder(), k, time));
    events.push_back(event("CONTROLLER_STATE", controller_state(), k, time));
    events.push_back(event("TORQUE", torque(), k, time));
    if (k % 50 == 0) events.push_back(event("PLANT_STATUS", plant_status(), k / 50, time));
    for (int i = 0; i < 2; ++i) events.push_back(event("SENSORS", sensors(), 2 * k + i, time + i * period / 2));
    events.push_back(event("TRUTH", truth(), k, time + period / 2));
  }
  return events;
}

inline void write(const std::filesystem::path& path, const std::vector<Event>& events) {
  LogWriter writer(path);
  for (const Event& each : events) writer.append(each.channel, each.time / 1000, each.bytes);
  writer.finish();
}

// Up to three events repeated, lost, moved or with a bit turned over, or a stretch of them lost.
inline std::vector<Event> damaged(const std::vector<Event>& whole, unsigned seed) {
  std::mt19937 draw(seed);
  const auto any = [&](std::size_t below) { return std::uniform_int_distribution<std::size_t>(0, below - 1)(draw); };
  std::vector<Event> events = whole;
  for (std::size_t changes = any(4); changes > 0; --changes) {
    const std::size_t at = any(events.size() - 40);
    switch (any(6)) {
      case 0: events.insert(events.begin() + static_cast<std::ptrdiff_t>(any(events.size())), Event(events[at])); break;
      case 1: events.erase(events.begin() + static_cast<std::ptrdiff_t>(at), events.begin() + static_cast<std::ptrdiff_t>(at + 1 + any(30))); break;
      case 2: std::swap(events[at], events[any(events.size())]); break;
      case 3: events[at].bytes[8 + any(32)] ^= static_cast<std::uint8_t>(1u << any(8)); break;  // of the head
      case 4: std::swap(events[at], events[at + 1 + any(3)]); break;
      default: events[at].bytes.resize(any(events[at].bytes.size()));
    }
  }
  return events;
}

}  // namespace slewlab::msgs::example
