#include "tools/replay/controller_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr int kIdleMessagesPerResend = 100;  // waits that bring messages but never the answer

// ENCODER numbers that a record may span, for each of its ENCODER and to begin with; chosen.
constexpr double kNumbersPerMessage = 100.0;
constexpr double kNumbersAtLeast = 1000.0;

// Of a counter that may hold any number.
std::int64_t advance(std::int64_t from, std::int64_t to) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from));
}

double on_line(double from, double to, double share) { return from + share * (to - from); }

// Between two recorded ENCODER, on a straight line.
msgs::Encoder made_up(const msgs::Encoder& before, const msgs::Encoder& after, std::int64_t sequence) {
  const double share = static_cast<double>(sequence - before.sequence) /
                       static_cast<double>(after.sequence - before.sequence);
  msgs::Encoder message = before;
  message.sequence = sequence;
  message.simulated_time = before.simulated_time + static_cast<std::int64_t>(
      share * static_cast<double>(after.simulated_time - before.simulated_time));
  const std::size_t groups = std::min(before.shaft_speed.size(), after.shaft_speed.size());
  for (std::size_t i = 0; i < groups; ++i) {
    message.shaft_speed[i] = on_line(before.shaft_speed[i], after.shaft_speed[i], share);
    message.shaft_position[i] = on_line(before.shaft_position[i], after.shaft_position[i], share);
  }
  return message;
}

class Asking {
 public:
  Asking(msgs::Bus& bus, const msgs::RunStream& record, const AskSettings& settings)
      : bus_(bus),
        record_(record),
        settings_(settings),
        moves_(record),
        torque_subscription_(bus, msgs::kTorqueChannel, [this](msgs::Bytes bytes) { receive(bytes, torque_); }),
        state_subscription_(bus, msgs::kControllerStateChannel, [this](msgs::Bytes bytes) { receive(bytes, state_); }) {}

  // False if asked to stop before the answer came.
  bool ask(const msgs::Encoder& encoder) {
    asked_ = encoder.sequence;
    torque_.reset();
    state_.reset();
    send(encoder, false);
    std::chrono::milliseconds patience = settings_.first_resend;
    int idle_messages = 0;
    while (!(torque_ && (state_ || !torque_->state_follows))) {
      const bool heard = bus_.handle_one(patience);
      if (settings_.stop && settings_.stop()) return false;
      if (heard && ++idle_messages < kIdleMessagesPerResend) continue;
      idle_messages = 0;
      patience = std::min(2 * patience, settings_.longest_resend);
      send(encoder, true);
    }
    return true;
  }

  const msgs::Torque& torque() const { return *torque_; }
  const std::optional<msgs::ControllerState>& state() const { return state_; }

 private:
  template <class Message>
  void receive(msgs::Bytes bytes, std::optional<Message>& answer) const {
    Message message;
    if (msgs::decode(bytes, message) != msgs::DecodeStatus::ok) return;
    const bool is_answer = message.answered_sequence == asked_ && message.run_identity == record_.run_identity;
    if (!answer && is_answer) answer = message;
  }

  void send(const msgs::Encoder& encoder, bool again) {
    // Every OPERATOR that belongs before this ENCODER; the newest once more with a repetition.
    bool sent = false;
    for (; moves_.current() != nullptr && moves_.current()->sequence <= encoder.operator_sequence; moves_.advance()) {
      operator_ = *moves_.current();
      publish_operator();
      sent = true;
    }
    if (operator_.sequence < encoder.operator_sequence) {  // missing in the record: as before, under its number
      operator_.sequence = encoder.operator_sequence;
      operator_.configuration_hash = record_.configuration_hash;
      operator_.run_identity = record_.run_identity;
      publish_operator();
      sent = true;
    }
    if (again && !sent) publish_operator();
    msgs::encode(encoder, bytes_);
    bus_.publish(msgs::kEncoderChannel, bytes_);
  }
  void publish_operator() {
    msgs::encode(operator_, bytes_);
    bus_.publish(msgs::kOperatorChannel, bytes_);
  }

  msgs::Bus& bus_;
  const msgs::RunStream& record_;
  const AskSettings& settings_;
  msgs::MessageReader<msgs::Operator> moves_;
  msgs::Operator operator_ = [] {
    msgs::Operator none{};
    none.sequence = -1;
    return none;
  }();
  std::int64_t asked_ = -1;
  std::optional<msgs::Torque> torque_;
  std::optional<msgs::ControllerState> state_;
  std::vector<std::uint8_t> bytes_;
  msgs::Subscription torque_subscription_;
  msgs::Subscription state_subscription_;
};

// The questions in their order, and what is told of them.
class Asked {
 public:
  explicit Asked(const msgs::RunStream& record)
      : first_(msgs::extent_of<msgs::Encoder>(record).first_key),
        last_(msgs::extent_of<msgs::Encoder>(record).last_key),
        torque_(record),
        encoder_(record) {}

  const Question* next() {
    for (;;) {
      for (; sequence_ < end_;) {
        if (ask(sequence_++)) return &question_;
      }
      if (has_answer_) {  // whose own ENCODER comes behind those before it
        has_answer_ = false;
        before_ = *torque_.current();
        torque_.advance();
        if (before_->answered_sequence >= first_ && ask(before_->answered_sequence)) return &question_;
      }
      if (torque_.current() == nullptr) return nullptr;
      begin_answer(*torque_.current());
    }
  }

  // Of what was given so far.
  std::int64_t starts = 0, made_up = 0, unanswered = 0;
  std::int64_t last_answered() const { return before_ ? before_->answered_sequence : first_ - 1; }

 private:
  // Which ENCODER before the one that is answered the controller computed.
  void begin_answer(const msgs::Torque& torque) {
    const bool fresh = !before_ || (torque.alive_counter < before_->alive_counter && torque.sequence < before_->sequence);
    const std::int64_t from = before_ ? before_->answered_sequence + 1 : first_;
    const std::int64_t gap = std::max<std::int64_t>(0, torque.answered_sequence - from);
    is_fresh_ = is_fresh_ || fresh;
    // Of the ENCODER since the last answer in the record, as many as the alive counter says were computed.
    const std::int64_t computed = fresh ? torque.alive_counter : advance(before_->alive_counter, torque.alive_counter) - 1;
    const std::int64_t asked = std::clamp<std::int64_t>(computed, 0, gap);
    unanswered += gap - asked;
    const std::int64_t begin = fresh ? torque.answered_sequence - asked : from;
    end_ = std::min(begin + asked, last_ + 1);
    sequence_ = std::max(begin, first_);
    has_answer_ = true;
  }

  bool ask(std::int64_t sequence) {
    for (; encoder_.current() != nullptr && encoder_.current()->sequence < sequence; encoder_.advance()) earlier_ = *encoder_.current();
    const msgs::Encoder* after = encoder_.current();
    if (after == nullptr) return false;
    if (after->sequence == sequence) {
      question_ = {*after, false, is_fresh_};
    } else if (earlier_) {
      question_ = {slewlab::tools::made_up(*earlier_, *after, sequence), true, is_fresh_};
      ++made_up;
    } else {
      return false;
    }
    if (is_fresh_) ++starts;
    is_fresh_ = false;
    return true;
  }

  std::int64_t first_, last_;  // ENCODER
  msgs::MessageReader<msgs::Torque> torque_;
  msgs::MessageReader<msgs::Encoder> encoder_;
  std::optional<msgs::Torque> before_;    // the answer before the current one
  std::optional<msgs::Encoder> earlier_;  // before the current ENCODER
  std::int64_t sequence_ = 0, end_ = 0;   // of those before the one that the current TORQUE answers, still to be asked
  bool has_answer_ = false;               // the current TORQUE's own ENCODER is still to be asked
  bool is_fresh_ = false;                 // the next question is the first of a start
  Question question_;
};

}  // namespace

Questions recorded_questions(const msgs::RunStream& record) {
  Questions questions;
  questions.open = [] { return [] { return static_cast<const Question*>(nullptr); }; };
  const msgs::ChannelExtent& encoders = msgs::extent_of<msgs::Encoder>(record);
  if (encoders.messages == 0) {
    questions.remarks.push_back("no ENCODER in the record: nothing to ask the controller");
    return questions;
  }
  if (msgs::extent_of<msgs::Torque>(record).messages == 0) {
    questions.remarks.push_back("no TORQUE in the record: nothing to compare the controller's answers with");
    return questions;
  }
  const double span = static_cast<double>(encoders.last_key) - static_cast<double>(encoders.first_key);
  if (span > kNumbersPerMessage * static_cast<double>(encoders.messages) + kNumbersAtLeast) {
    questions.remarks.push_back(fmt::format("the record's {} ENCODER speak of number {} to {}: too far apart for a record of that size, a "
                                            "number in it must be damaged; nothing is asked", encoders.messages, encoders.first_key, encoders.last_key));
    return questions;
  }

  Asked all(record);
  while (all.next() != nullptr) {
  }
  questions.starts = all.starts;
  questions.open = [record]() -> Questions::Next {
    return [each = std::make_shared<Asked>(record)] { return each->next(); };
  };
  std::int64_t behind = 0;
  for (msgs::MessageReader<msgs::Encoder> encoder(record); encoder.current() != nullptr; encoder.advance()) {
    if (encoder.current()->sequence > all.last_answered()) ++behind;
  }
  if (encoders.first_key > 0) {
    questions.remarks.push_back(
        fmt::format("the record begins at ENCODER {} ({:.3f} s): how the controller stood then is not known, it starts "
                    "afresh there",
                    encoders.first_key, static_cast<double>(encoders.first_time) / kNanosecondsPerSecond));
  }
  if (questions.starts > 1) {
    questions.remarks.push_back(
        fmt::format("the recorded controller was started {} times: a fresh one for each", questions.starts));
  }
  if (all.made_up > 0) {
    questions.remarks.push_back(fmt::format(
        "{} ENCODER that were answered are missing in the record: put on a line between their neighbours", all.made_up));
  }
  if (all.unanswered > 0) {
    questions.remarks.push_back(
        fmt::format("{} ENCODER were never answered by the recorded controller: not asked", all.unanswered));
  }
  if (behind > 0) {
    questions.remarks.push_back(fmt::format("{} ENCODER behind the last recorded TORQUE: not asked", behind));
  }
  return questions;
}

bool ask_controller(msgs::Bus& bus, const msgs::RunStream& record, const Question*& question, const Questions::Next& next,
                    const AskSettings& settings, const ControllerListener& listener) {
  Asking asking(bus, record, settings);
  msgs::MessageReader<msgs::Torque> answers(record);
  msgs::MessageReader<msgs::ControllerState> states(record);
  const auto of_question = [&](auto& reader) {
    while (reader.current() != nullptr && reader.current()->answered_sequence < question->encoder.sequence) reader.advance();
    return reader.current() != nullptr && reader.current()->answered_sequence == question->encoder.sequence ? reader.current() : nullptr;
  };
  std::optional<std::int64_t> sequence_offset;
  std::optional<std::int64_t> alive_offset;
  std::optional<std::int64_t> state_offset;
  for (bool is_next = false; question != nullptr && !(is_next && question->is_first); question = next(), is_next = true) {
    if (!asking.ask(question->encoder)) return false;
    if (question->made_up) continue;
    msgs::Torque torque = asking.torque();
    if (!sequence_offset) {
      if (const msgs::Torque* recorded = of_question(answers)) {
        sequence_offset = recorded->sequence - torque.sequence;
        alive_offset = recorded->alive_counter - torque.alive_counter;
      }
    }
    torque.sequence += sequence_offset.value_or(0);
    torque.alive_counter += alive_offset.value_or(0);
    listener.torque(torque);
    if (!asking.state()) continue;
    msgs::ControllerState state = *asking.state();
    if (!state_offset) {
      if (const msgs::ControllerState* recorded = of_question(states)) state_offset = recorded->sequence - state.sequence;
    }
    state.sequence += state_offset.value_or(0);
    listener.controller_state(state);
  }
  return true;
}

}  // namespace slewlab::tools
