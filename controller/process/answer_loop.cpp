#include "controller/process/answer_loop.h"

#include "msgs/codec.h"

namespace slewlab::controller {

void begin_answer(const msgs::Encoder& encoder, std::int64_t answers, msgs::Torque& torque, msgs::ControllerState& state) {
  const auto set_head = [&](auto& message) {
    message.sequence = answers;
    message.simulated_time = encoder.simulated_time;
    message.configuration_hash = encoder.configuration_hash;
    message.answered_sequence = encoder.sequence;
  };
  set_head(torque);
  set_head(state);
  torque.alive_counter = answers;
  torque.state_follows = 1;
}

AnswerLoop::AnswerLoop(msgs::Bus& bus, Compute compute) : bus_(bus), compute_(std::move(compute)) {
  bus_.subscribe(msgs::kOperatorChannel, [this](msgs::Bytes bytes) { receive_operator(bytes); });
  bus_.subscribe(msgs::kEncoderChannel, [this](msgs::Bytes bytes) { receive_encoder(bytes); });
}

void AnswerLoop::receive_operator(msgs::Bytes bytes) {
  if (msgs::decode(bytes, incoming_operator_) != msgs::DecodeStatus::ok) {
    ++counts_.undecodable;
    return;
  }
  if (have_operator_ && incoming_operator_.sequence <= operator_.sequence) return;
  operator_ = incoming_operator_;
  have_operator_ = true;
}

void AnswerLoop::receive_encoder(msgs::Bytes bytes) {
  if (msgs::decode(bytes, encoder_) != msgs::DecodeStatus::ok) {
    ++counts_.undecodable;
    return;
  }
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

  begin_answer(encoder_, counts_.answers, torque_, state_);
  compute_(encoder_, operator_, torque_, state_);
  ++counts_.answers;
  answered_ = encoder_.sequence;
  msgs::encode(torque_, torque_bytes_);
  if (torque_.state_follows) msgs::encode(state_, state_bytes_);
  send_answer();
}

void AnswerLoop::send_answer() {
  if (torque_.state_follows) bus_.publish(msgs::kControllerStateChannel, state_bytes_);
  bus_.publish(msgs::kTorqueChannel, torque_bytes_);
}

}  // namespace slewlab::controller
