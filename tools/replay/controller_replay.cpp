#include "tools/replay/controller_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
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
  Asking(msgs::Bus& bus, const msgs::RunLog& record, const AskSettings& settings)
      : bus_(bus),
        record_(record),
        settings_(settings),
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
    const auto& moves = record_.operator_moves;
    bool sent = false;
    while (next_move_ < moves.size() && moves[next_move_].sequence <= encoder.operator_sequence) {
      operator_ = moves[next_move_++];
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
  const msgs::RunLog& record_;
  const AskSettings& settings_;
  std::size_t next_move_ = 0;
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

}  // namespace

Questions recorded_questions(const msgs::RunLog& record) {
  Questions questions;
  const auto& encoders = record.encoder;
  if (encoders.empty()) {
    questions.remarks.push_back("no ENCODER in the record: nothing to ask the controller");
    return questions;
  }
  if (record.torque.empty()) {
    questions.remarks.push_back("no TORQUE in the record: nothing to compare the controller's answers with");
    return questions;
  }
  std::vector<const msgs::Torque*> answers;
  for (const msgs::Torque& torque : record.torque) answers.push_back(&torque);
  std::sort(answers.begin(), answers.end(), [](const msgs::Torque* a, const msgs::Torque* b) {
    return a->answered_sequence < b->answered_sequence;
  });
  std::map<std::int64_t, const msgs::Encoder*> known;
  for (const msgs::Encoder& encoder : encoders) known.emplace(encoder.sequence, &encoder);

  const std::int64_t last = known.rbegin()->first;
  const double span = static_cast<double>(last) - static_cast<double>(known.begin()->first);
  if (span > kNumbersPerMessage * static_cast<double>(encoders.size()) + kNumbersAtLeast) {
    questions.remarks.push_back(fmt::format("the record's {} ENCODER speak of number {} to {}: too far apart for a record of that size, a "
                                            "number in it must be damaged; nothing is asked", encoders.size(), known.begin()->first, last));
    return questions;
  }

  std::int64_t made_up_count = 0;
  std::int64_t unanswered = 0;
  const auto ask = [&](std::int64_t sequence) {
    const auto after = known.lower_bound(sequence);
    if (after == known.end()) return;
    if (after->first == sequence) {
      questions.starts.back().push_back({*after->second, false});
    } else if (after != known.begin()) {
      questions.starts.back().push_back({made_up(*std::prev(after)->second, *after->second, sequence), true});
      ++made_up_count;
    }
  };

  const std::int64_t first = known.begin()->first;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const msgs::Torque& torque = *answers[i];
    const bool fresh = i == 0 || (torque.alive_counter < answers[i - 1]->alive_counter &&
                                  torque.sequence < answers[i - 1]->sequence);
    const std::int64_t from = i == 0 ? first : answers[i - 1]->answered_sequence + 1;
    const std::int64_t gap = std::max<std::int64_t>(0, torque.answered_sequence - from);
    if (fresh) questions.starts.emplace_back();
    // Of the ENCODER since the last answer in the record, as many as the alive counter says were computed.
    const std::int64_t computed =
        fresh ? torque.alive_counter : advance(answers[i - 1]->alive_counter, torque.alive_counter) - 1;
    const std::int64_t asked = std::clamp<std::int64_t>(computed, 0, gap);
    unanswered += gap - asked;
    const std::int64_t begin = fresh ? torque.answered_sequence - asked : from;
    const std::int64_t end = std::min(begin + asked, last + 1);
    for (std::int64_t sequence = std::max(begin, first); sequence < end; ++sequence) ask(sequence);
    if (torque.answered_sequence >= first) ask(torque.answered_sequence);
  }
  std::erase_if(questions.starts, [](const auto& start) { return start.empty(); });

  const std::int64_t behind = std::count_if(encoders.begin(), encoders.end(), [&](const msgs::Encoder& encoder) {
    return encoder.sequence > answers.back()->answered_sequence;
  });
  if (first > 0) {
    questions.remarks.push_back(
        fmt::format("the record begins at ENCODER {} ({:.3f} s): how the controller stood then is not known, it starts "
                    "afresh there",
                    first, static_cast<double>(encoders.front().simulated_time) / kNanosecondsPerSecond));
  }
  if (questions.starts.size() > 1) {
    questions.remarks.push_back(
        fmt::format("the recorded controller was started {} times: a fresh one for each", questions.starts.size()));
  }
  if (made_up_count > 0) {
    questions.remarks.push_back(fmt::format(
        "{} ENCODER that were answered are missing in the record: put on a line between their neighbours",
        made_up_count));
  }
  if (unanswered > 0) {
    questions.remarks.push_back(
        fmt::format("{} ENCODER were never answered by the recorded controller: not asked", unanswered));
  }
  if (behind > 0) {
    questions.remarks.push_back(fmt::format("{} ENCODER behind the last recorded TORQUE: not asked", behind));
  }
  return questions;
}

bool ask_controller(msgs::Bus& bus, const msgs::RunLog& record, const std::vector<Question>& questions,
                    const AskSettings& settings, ControllerReplay& replay) {
  Asking asking(bus, record, settings);
  std::map<std::int64_t, const msgs::Torque*> answers;
  for (const msgs::Torque& torque : record.torque) answers.emplace(torque.answered_sequence, &torque);
  std::map<std::int64_t, std::int64_t> state_sequences;
  for (const msgs::ControllerState& state : record.controller_state) {
    state_sequences.emplace(state.answered_sequence, state.sequence);
  }
  std::optional<std::int64_t> sequence_offset;
  std::optional<std::int64_t> alive_offset;
  std::optional<std::int64_t> state_offset;
  for (const Question& question : questions) {
    if (!asking.ask(question.encoder)) return false;
    if (question.made_up) continue;
    msgs::Torque torque = asking.torque();
    const auto recorded = answers.find(question.encoder.sequence);
    if (recorded != answers.end() && !sequence_offset) {
      sequence_offset = recorded->second->sequence - torque.sequence;
      alive_offset = recorded->second->alive_counter - torque.alive_counter;
    }
    torque.sequence += sequence_offset.value_or(0);
    torque.alive_counter += alive_offset.value_or(0);
    replay.torque.push_back(torque);
    if (!asking.state()) continue;
    msgs::ControllerState state = *asking.state();
    const auto recorded_state = state_sequences.find(question.encoder.sequence);
    if (recorded_state != state_sequences.end() && !state_offset) state_offset = recorded_state->second - state.sequence;
    state.sequence += state_offset.value_or(0);
    replay.controller_state.push_back(state);
  }
  return true;
}

}  // namespace slewlab::tools
