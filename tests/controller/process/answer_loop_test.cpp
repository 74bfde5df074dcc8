#include "controller/process/answer_loop.h"

#include <gtest/gtest.h>

#include "msgs/memory_bus.h"

namespace slewlab::controller {
namespace {

using msgs::Bytes;

// The computation under test counts its calls in the torque, so that a second computation would show.
class AnswerLoopTest : public testing::Test {
 protected:
  AnswerLoopTest() {
    plant_->subscribe("TORQUE", [this](Bytes bytes) {
      order_ += 'T';
      torques_.emplace_back(bytes.begin(), bytes.end());
    });
    plant_->subscribe("CONTROLLER_STATE", [this](Bytes) { order_ += 'S'; });
  }

  void send_operator(std::int64_t sequence, double speed_request) {
    msgs::Operator message{};
    message.sequence = sequence;
    message.run_identity = run_;
    message.speed_request = speed_request;
    send("OPERATOR", message);
  }
  void send_encoder(std::int64_t sequence, std::int64_t operator_sequence) {
    send_encoder_at(1000 * sequence, sequence, operator_sequence);
  }
  void send_encoder_at(std::int64_t time, std::int64_t sequence, std::int64_t operator_sequence) {
    msgs::Encoder message{};
    message.sequence = sequence;
    message.simulated_time = time;
    message.configuration_hash = 5;
    message.run_identity = run_;
    message.operator_sequence = operator_sequence;
    message.group_count = 1;
    message.shaft_speed = message.shaft_position = {0.0};
    send("ENCODER", message);
  }
  template <class Message>
  void send(const char* channel, const Message& message) {
    std::vector<std::uint8_t> bytes;
    msgs::encode(message, bytes);
    plant_->publish(channel, bytes);
    controller_->drain();
    plant_->drain();
  }
  msgs::Torque torque(std::size_t index) {
    msgs::Torque message;
    EXPECT_EQ(msgs::decode(torques_.at(index), message), msgs::DecodeStatus::ok);
    return message;
  }

  msgs::MemoryWire wire_;
  std::unique_ptr<msgs::MemoryBus> plant_ = wire_.connect();
  std::unique_ptr<msgs::MemoryBus> controller_ = wire_.connect();
  std::int64_t run_ = 11;  // of what is sent
  int computed_ = 0;
  AnswerLoop loop_{*controller_, [this](const msgs::Encoder&, const msgs::Operator& operator_move,
                                        msgs::Torque& torque, msgs::ControllerState& state) {
                     ++computed_;
                     torque.group_count = 1;
                     torque.motor_torque = {operator_move.speed_request + computed_};
                     state.group_count = 0;
                   }};
  std::string order_;
  std::vector<std::vector<std::uint8_t>> torques_;
};

// Any bit of a sequence number that turns over on its way: that ENCODER gets no answer, the next one does.
TEST_F(AnswerLoopTest, ASequenceNumberThatLeapsAloneIsNotBelieved) {
  send_operator(0, 0.5);
  std::int64_t next = 0;
  while (next < 2) send_encoder(next++, 0);
  for (int bit = 0; bit < 63; ++bit) {
    const std::int64_t turned = next ^ (std::int64_t{1} << bit);
    send_encoder_at(1000 * next, turned, 0);
    ++next;
    const int computed = computed_;
    send_encoder(next++, 0);
    EXPECT_EQ(computed_, computed + 1) << "bit " << bit;
  }
}

TEST_F(AnswerLoopTest, LostQuestionsAreNoLeap) {
  send_operator(0, 0.5);
  for (const std::int64_t sequence : {0, 1, 2, 7, 8, 600}) send_encoder(sequence, 0);
  EXPECT_EQ(computed_, 6);
  EXPECT_EQ(loop_.counts().leaps, 0);
}

TEST_F(AnswerLoopTest, TheSecondLeapInARowCounts) {
  send_operator(0, 0.5);
  for (const std::int64_t sequence : {0, 1, 2}) send_encoder(sequence, 0);
  send_encoder_at(3000, 100, 0);
  EXPECT_EQ(computed_, 3);
  send_encoder_at(3000, 100, 0);
  EXPECT_EQ(computed_, 4);
  EXPECT_EQ(loop_.counts().leaps, 1);
}

TEST_F(AnswerLoopTest, AnswersBySequenceWithTheStateFirst) {
  send_operator(0, 0.5);
  send_encoder(0, 0);
  EXPECT_EQ(order_, "ST");
  const msgs::Torque answer = torque(0);
  EXPECT_EQ(answer.answered_sequence, 0);
  EXPECT_EQ(answer.configuration_hash, 5);
  EXPECT_EQ(answer.run_identity, 11);
  EXPECT_EQ(answer.motor_torque.at(0), 1.5);
  send_encoder(1, 0);
  EXPECT_EQ(torque(1).answered_sequence, 1);
  EXPECT_EQ(torque(1).simulated_time, 1000);
  EXPECT_EQ(torque(1).alive_counter, torque(0).alive_counter + 1);
}

TEST_F(AnswerLoopTest, ARepeatedQuestionGetsTheSameBytesWithoutComputing) {
  send_operator(0, 0.0);
  send_encoder(0, 0);
  send_encoder(0, 0);
  EXPECT_EQ(computed_, 1);
  ASSERT_EQ(torques_.size(), 2u);
  EXPECT_EQ(torques_[0], torques_[1]);
  EXPECT_EQ(order_, "STST");
  EXPECT_EQ(loop_.counts().repeated_answers, 1);
}

TEST_F(AnswerLoopTest, WaitsForTheOperatorMessageThatBelongsBefore) {
  send_encoder(0, 0);
  EXPECT_EQ(computed_, 0);
  send_operator(0, 0.0);
  send_encoder(0, 0);
  EXPECT_EQ(computed_, 1);
  send_encoder(1, 1);  // OPERATOR 1 was lost
  EXPECT_EQ(computed_, 1);
  send_operator(1, 0.25);
  send_encoder(1, 1);
  EXPECT_EQ(torque(1).motor_torque.at(0), 2.25);
  EXPECT_EQ(loop_.counts().waits_for_operator, 2);
}

TEST_F(AnswerLoopTest, AnOlderOperatorMessageDoesNotComeBack) {
  send_operator(1, 0.75);
  send_operator(0, -1.0);
  send_encoder(0, 1);
  EXPECT_EQ(torque(0).motor_torque.at(0), 1.75);
}

TEST_F(AnswerLoopTest, OlderQuestionsAndBrokenBytesGetNoAnswer) {
  send_operator(0, 0.0);
  send_encoder(3, 0);
  send_encoder(2, 0);
  plant_->publish("ENCODER", std::vector<std::uint8_t>{1, 2, 3});
  controller_->drain();
  plant_->drain();
  EXPECT_EQ(torques_.size(), 1u);
  EXPECT_EQ(loop_.counts().stale_questions, 1);
  EXPECT_EQ(loop_.counts().undecodable, 1);
}

TEST_F(AnswerLoopTest, TheNextRunIsAnsweredFromItsFirstQuestionOnWhenAskedAgain) {
  send_operator(4, 0.5);
  send_encoder(100, 4);
  run_ = 12;
  send_operator(0, 0.25);
  send_encoder(0, 0);
  EXPECT_EQ(torques_.size(), 1u);  // a bit that turned over would look the same
  send_operator(0, 0.25);
  send_encoder(0, 0);
  ASSERT_EQ(torques_.size(), 2u);
  EXPECT_EQ(torque(1).run_identity, 12);
  EXPECT_EQ(torque(1).answered_sequence, 0);
  EXPECT_EQ(torque(1).sequence, 0);
  EXPECT_EQ(torque(1).motor_torque.at(0), 2.25);  // the new run's OPERATOR, though its number is lower
  send_encoder(1, 0);
  EXPECT_EQ(torque(2).answered_sequence, 1);
  EXPECT_EQ(loop_.counts().runs, 2);
}

TEST_F(AnswerLoopTest, OneQuestionOfAnotherRunDisturbsNothing) {
  send_operator(0, 0.5);
  send_encoder(0, 0);
  for (int k = 1; k <= 3; ++k) {
    run_ = 12;
    send_operator(9, -1.0);
    send_encoder(k, 0);
    run_ = 11;
    send_encoder(k, 0);
  }
  ASSERT_EQ(torques_.size(), 4u);
  EXPECT_EQ(torque(3).answered_sequence, 3);
  EXPECT_EQ(torque(3).run_identity, 11);
  EXPECT_EQ(torque(3).motor_torque.at(0), 4.5);  // by the OPERATOR of its own run
  EXPECT_EQ(loop_.counts().runs, 1);
  EXPECT_EQ(loop_.counts().first_of_another_run, 3);
}

TEST_F(AnswerLoopTest, EveryRunIsComputedByAFreshState) {
  int steps = 0;
  AnswerLoop loop(*controller_, [calls = 0, &steps](const msgs::Encoder&, const msgs::Operator&, msgs::Torque& answer,
                                                    msgs::ControllerState& state) mutable {
    steps = ++calls;
    answer.group_count = 0;
    answer.motor_torque.clear();
    state.group_count = 0;
  });
  send_operator(0, 0.0);
  for (int k = 0; k < 3; ++k) send_encoder(k, 0);
  EXPECT_EQ(steps, 3);
  run_ = 12;
  send_operator(0, 0.0);
  send_encoder(0, 0);
  send_encoder(0, 0);
  EXPECT_EQ(steps, 1);
}

}  // namespace
}  // namespace slewlab::controller
