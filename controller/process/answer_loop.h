#pragma once

// The controller's side of the wire: every ENCODER is answered by a TORQUE, with a CONTROLLER_STATE sent
// before it. What it computes is a function handed in.
//
// - A repeated ENCODER is answered by the same bytes again, without computing: the answer got lost.
// - ENCODER names the OPERATOR message that belongs before it. If that one is not here yet, there is no
//   answer; the plant sends both again.
// - An ENCODER older than the newest answered is left alone, and so is what cannot be decoded; both are
//   counted.
// - An ENCODER of another run (run_identity) begins that run: state anew, counting anew. One message alone may be a bit
//   that turned over on its way; the second of the same identity counts, and a plant asks again until it is answered. A
//   controller that has answered nothing yet takes the first.
// - So with a sequence number that leaps while the time does not: one alone is not answered, or whoever believed it would
//   take all that come after it for old. The second in a row counts.

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
  std::int64_t runs = 0;              // begun
  std::int64_t answers = 0;           // computed, in all runs
  std::int64_t repeated_answers = 0;  // sent again
  std::int64_t stale_questions = 0;
  std::int64_t waits_for_operator = 0;
  std::int64_t first_of_another_run = 0;  // not answered: ENCODER with an identity not heard before
  std::int64_t leaps = 0;                 // not answered: sequence and time that do not fit each other
  std::int64_t undecodable = 0;
};

class AnswerLoop {
 public:
  // Subscribes; from then on whoever handles the bus makes it answer. The bus must outlive this. Every run is computed by
  // a copy of `compute` as it is handed in.
  AnswerLoop(msgs::Bus& bus, Compute compute);
  AnswerLoop(const AnswerLoop&) = delete;
  AnswerLoop& operator=(const AnswerLoop&) = delete;

  const AnswerCounts& counts() const { return counts_; }

 private:
  void receive_operator(msgs::Bytes bytes);
  bool is_of_this_run();  // ENCODER; begins its run where that is due
  void begin_run();
  bool comes_in_its_time();  // ENCODER, newer than the newest answered
  void receive_encoder(msgs::Bytes bytes);
  void send_answer();

  msgs::Bus& bus_;
  Compute fresh_compute_;
  Compute compute_;  // of this run
  AnswerCounts counts_;
  bool have_run_ = false;
  std::int64_t run_ = 0;        // identity
  std::int64_t candidate_ = 0;  // of another run, heard once
  bool have_candidate_ = false;
  std::int64_t answers_ = 0;    // computed in this run
  std::int64_t answered_ = -1;  // the newest ENCODER answered
  std::int64_t answered_time_ = 0;  // [ns] of that one
  double cycle_ = 0.0;              // [ns] between the last two that followed each other; 0 before there were any
  int leaps_ = 0;                   // in a row

  msgs::Operator incoming_operator_{};
  msgs::Operator operator_{};        // the newest of this run
  msgs::Operator other_operator_{};  // the newest of another run, whose ENCODER may follow
  bool have_operator_ = false;
  bool have_other_operator_ = false;
  msgs::Encoder encoder_{};
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
  std::vector<std::uint8_t> torque_bytes_;
  std::vector<std::uint8_t> state_bytes_;
  msgs::Subscription operator_subscription_;
  msgs::Subscription encoder_subscription_;
};

}  // namespace slewlab::controller
