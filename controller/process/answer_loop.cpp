#include "controller/process/answer_loop.h"

#include <cmath>

#include "msgs/codec.h"

namespace slewlab::controller {

void begin_answer(const msgs::Encoder& encoder, std::int64_t answers, msgs::Torque& torque, msgs::ControllerState& state) {
  const auto set_head = [&](auto& message) {
    message.sequence = answers;
    message.simulated_time = encoder.simulated_time;
    message.configuration_hash = encoder.configuration_hash;
    message.run_identity = encoder.run_identity;
    message.answered_sequence = encoder.sequence;
  };
  set_head(torque);
  set_head(state);
  torque.alive_counter = answers;
  torque.state_follows = 1;
}

AnswerLoop::AnswerLoop(msgs::Bus& bus, Compute compute)
    : bus_(bus),
      fresh_compute_(std::move(compute)),
      operator_subscription_(bus, msgs::kOperatorChannel, [this](msgs::Bytes bytes) { receive_operator(bytes); }),
      encoder_subscription_(bus, msgs::kEncoderChannel, [this](msgs::Bytes bytes) { receive_encoder(bytes); }) {}

void AnswerLoop::receive_operator(msgs::Bytes bytes) {
  if (msgs::decode(bytes, incoming_operator_) != msgs::DecodeStatus::ok) {
    ++counts_.undecodable;
    return;
  }
  const bool of_this_run = have_run_ && incoming_operator_.run_identity == run_;
  msgs::Operator& held = of_this_run ? operator_ : other_operator_;
  bool& have = of_this_run ? have_operator_ : have_other_operator_;
  if (have && incoming_operator_.run_identity == held.run_identity && incoming_operator_.sequence <= held.sequence) return;
  held = incoming_operator_;
  have = true;
}

bool AnswerLoop::is_of_this_run() {
  if (have_run_ && encoder_.run_identity == run_) {
    have_candidate_ = false;
    return true;
  }
  if (have_run_ && !(have_candidate_ && encoder_.run_identity == candidate_)) {
    candidate_ = encoder_.run_identity;
    have_candidate_ = true;
    ++counts_.first_of_another_run;
    return false;
  }
  begin_run();
  return true;
}

void AnswerLoop::begin_run() {
  run_ = encoder_.run_identity;
  have_run_ = true;
  have_candidate_ = false;
  compute_ = fresh_compute_;
  answers_ = 0;
  answered_ = -1;
  cycle_ = 0.0;
  leaps_ = 0;
  have_operator_ = have_other_operator_ && other_operator_.run_identity == run_;
  if (have_operator_) operator_ = other_operator_;
  have_other_operator_ = false;
  ++counts_.runs;
}

bool AnswerLoop::comes_in_its_time() {
  constexpr int kBelieved = 2;
  if (answered_ < 0) return true;
  // Differences of doubles: what arrives may be any integer, and their difference none.
  const double cycles = static_cast<double>(encoder_.sequence) - static_cast<double>(answered_);
  const double elapsed = static_cast<double>(encoder_.simulated_time) - static_cast<double>(answered_time_);
  const bool follows = cycles == 1.0;
  const bool fits = follows || cycle_ <= 0.0 || std::fabs(elapsed - cycles * cycle_) <= 0.5 * cycle_;
  if (!fits && ++leaps_ < kBelieved) {
    ++counts_.leaps;
    return false;
  }
  leaps_ = 0;
  if (follows) cycle_ = elapsed;
  return true;
}

void AnswerLoop::receive_encoder(msgs::Bytes bytes) {
  if (msgs::decode(bytes, encoder_) != msgs::DecodeStatus::ok) {
    ++counts_.undecodable;
    return;
  }
  if (!is_of_this_run()) return;
  if (encoder_.sequence == answered_) {
    ++counts_.repeated_answers;
    send_answer();
    return;
  }
  if (encoder_.sequence < answered_) {
    ++counts_.stale_questions;
    return;
  }
  if (!have_operator_ || operator_.sequence < encoder_.operator_sequence) {
    ++counts_.waits_for_operator;
    return;
  }

  if (!comes_in_its_time()) return;

  begin_answer(encoder_, answers_, torque_, state_);
  compute_(encoder_, operator_, torque_, state_);
  ++counts_.answers;
  ++answers_;
  answered_ = encoder_.sequence;
  answered_time_ = encoder_.simulated_time;
  msgs::encode(torque_, torque_bytes_);
  if (torque_.state_follows) msgs::encode(state_, state_bytes_);
  send_answer();
}

void AnswerLoop::send_answer() {
  if (torque_.state_follows) bus_.publish(msgs::kControllerStateChannel, state_bytes_);
  bus_.publish(msgs::kTorqueChannel, torque_bytes_);
}

}  // namespace slewlab::controller
