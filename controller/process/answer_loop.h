#pragma once

// The controller's side of the wire: every ENCODER is answered by a TORQUE, with a CONTROLLER_STATE sent
// before it. What it computes is a function handed in.
//
// - A repeated ENCODER is answered by the same bytes again, without computing: the answer got lost.
// - ENCODER names the OPERATOR message that belongs before it. If that one is not here yet, there is no
//   answer; the plant sends both again.
// - An ENCODER older than the newest answered is left alone, and so is what cannot be decoded; both are
//   counted.

#include <cstdint>
#include <functional>
#include <vector>

#include "msgs/bus.h"
#include "msgs/messages.h"

namespace slewlab::controller {

// Fills `torque` and `state`; their heads, answered_sequence, alive_counter and state_follows (true) are
// set before.
using Compute = std::function<void(const msgs::Encoder& encoder, const msgs::Operator& operator_move,
                                   msgs::Torque& torque, msgs::ControllerState& state)>;

// Sets the heads of the `answers`-th answer (from 0) and what else every answer says of itself.
void begin_answer(const msgs::Encoder& encoder, std::int64_t answers, msgs::Torque& torque, msgs::ControllerState& state);

struct AnswerCounts {
  std::int64_t answers = 0;           // computed
  std::int64_t repeated_answers = 0;  // sent again
  std::int64_t stale_questions = 0;
  std::int64_t waits_for_operator = 0;
  std::int64_t undecodable = 0;
};

class AnswerLoop {
 public:
  // Subscribes; from then on whoever handles the bus makes it answer. The bus must outlive this.
  AnswerLoop(msgs::Bus& bus, Compute compute);
  AnswerLoop(const AnswerLoop&) = delete;
  AnswerLoop& operator=(const AnswerLoop&) = delete;

  const AnswerCounts& counts() const { return counts_; }

 private:
  void receive_operator(msgs::Bytes bytes);
  void receive_encoder(msgs::Bytes bytes);
  void send_answer();

  msgs::Bus& bus_;
  Compute compute_;
  AnswerCounts counts_;
  std::int64_t answered_ = -1;  // the newest ENCODER answered

  msgs::Operator operator_{};
  msgs::Operator incoming_operator_{};
  bool have_operator_ = false;
  msgs::Encoder encoder_{};
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
  std::vector<std::uint8_t> torque_bytes_;
  std::vector<std::uint8_t> state_bytes_;
};

}  // namespace slewlab::controller
