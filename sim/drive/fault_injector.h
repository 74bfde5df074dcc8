#pragma once

// Brings a scenario's faults into a run, at the edge of the plant's loop: messages between plant and controller,
// what the encoders say, what fails on the crane, and when the controller's process is to be killed, started, stopped and
// continued.
// Without faults every call passes through.
//
// Message faults act on a message in the order of the schedule; the first that hits decides. Held messages come out
// at the beginning of the period in which they are due, reordered ones at its end.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "msgs/messages.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/fault.h"

namespace slewlab::sim {

enum class ControllerAction { kill, start, stop, resume };

// What becomes of a controller that is stopped on purpose. Lockstep would wait for it for ever: there its questions are
// held back. Against the wall clock its process is stopped (SIGSTOP), the questions go on.
enum class Stopping { questions_held, process_stopped };

class FaultInjector {
 public:
  FaultInjector(std::vector<Fault> faults, std::int64_t controller_period, Stopping stopping = Stopping::questions_held);

  bool empty() const { return faults_.empty(); }

  // While it runs: a fault behind all others, which acts from its `from` on; an end to the fault of that number.
  void add(const Fault& fault);
  void end(std::size_t number, std::int64_t time);

  // What has failed on the crane during a step that begins at `time`.
  PlantConditions conditions(std::int64_t time) const;

  // What is to be done to the controller's process before the period that begins at `time` [ns], in this order; every
  // action is told once.
  std::vector<ControllerAction> controller_actions(std::int64_t time);
  // Killed and not started again: nobody is to be asked.
  bool controller_absent(std::int64_t time) const;

  // What the encoders say instead.
  void alter(std::int64_t time, msgs::Encoder& message);

  struct Message {
    std::int64_t sequence = 0;  // of the ENCODER, or the one that TORQUE answers
    std::vector<std::uint8_t> bytes;
  };
  // Hands a message to the channel; what arrives in the present period is then in arrivals(). Call begin_period
  // first, then pass for each message of the period, then end_period.
  void begin_period(FaultChannel channel, std::int64_t time);
  void pass(FaultChannel channel, std::int64_t time, std::int64_t sequence, std::span<const std::uint8_t> bytes);
  void end_period(FaultChannel channel);
  const std::vector<Message>& arrivals(FaultChannel channel) const { return side(channel).arriving; }

 private:
  struct Held {
    std::int64_t due;  // [ns]
    bool behind;       // the period's own messages
    Message message;
    std::optional<std::size_t> fault = {};  // until whose end it is held, where that may come earlier
  };
  struct Side {
    std::vector<Held> held;
    std::vector<Message> arriving;
    std::int64_t time = 0;
    bool is_heard = true;  // somebody is there
  };
  Side& side(FaultChannel channel) { return sides_[static_cast<int>(channel)]; }
  const Side& side(FaultChannel channel) const { return sides_[static_cast<int>(channel)]; }
  void release(Side& side, bool behind);
  void corrupt(std::size_t fault, std::uint64_t draw, Message& message);

  std::vector<Fault> faults_;
  std::int64_t controller_period_;
  Stopping stopping_;
  std::vector<int> actions_done_;  // of each fault: 0, 1 killed or stopped, 2 started or continued
  Side sides_[2];
  struct Frozen {
    bool held = false;
    std::vector<double> speed, position;
  };
  std::vector<Frozen> frozen_;                             // of each fault
  std::vector<std::optional<std::int64_t>> alive_counter_;  // of each fault: at which it holds the alive counter
};

}  // namespace slewlab::sim
