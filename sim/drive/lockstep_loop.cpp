#include "sim/drive/lockstep_loop.h"

#include <algorithm>

#include "msgs/codec.h"
#include "sim/drive/plant_output.h"

namespace slewlab::sim {
namespace {

using ByteBuffer = std::vector<std::uint8_t>;

// Waits that bring messages but never the one that is awaited end as a time-out would.
constexpr int kIdleMessagesPerResend = 100;

void require_multiple(std::int64_t value, std::int64_t of, const char* what) {
  if (of <= 0 || value <= 0 || value % of != 0) {
    throw std::invalid_argument(std::string(what) + " of " + std::to_string(value) +
                                " ns is not a multiple of " + std::to_string(of) + " ns");
  }
}

class Lockstep {
 public:
  Lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus, const LogSink& log,
           const LockstepHooks& hooks)
      : settings_(settings),
        plant_(plant),
        bus_(bus),
        hooks_(hooks),
        output_(settings, plant, bus, log),
        faults_(settings.faults, settings.controller_period),
        torque_subscription_(bus, msgs::kTorqueChannel, [this](msgs::Bytes bytes) { receive_torque(bytes); }),
        state_subscription_(bus, msgs::kControllerStateChannel, [this](msgs::Bytes bytes) { receive_state(bytes); }) {
    require_multiple(settings.controller_period, settings.plant_step, "a controller period");
    require_multiple(settings.sensors_period, settings.plant_step, "a sensors period");
    require_multiple(settings.truth_period, settings.plant_step, "a truth period");
    require_multiple(settings.status_period, settings.plant_step, "a status period");
    require_multiple(settings.live_period, settings.plant_step, "a live period");
  }

  LockstepCounts run() {
    const std::int64_t steps_per_period = settings_.controller_period / settings_.plant_step;
    output_.send_series(counts_.simulated_time);
    output_.check_plant(counts_.simulated_time);
    while (counts_.simulated_time < settings_.duration && !stop_asked()) {
      if (hooks_.steer && !steer()) break;
      if (!talk()) break;
      for (std::int64_t i = 0; i < steps_per_period; ++i) {
        plant_.step(faults_.conditions(counts_.simulated_time));
        counts_.simulated_time += settings_.plant_step;
        output_.send_series(counts_.simulated_time);
      }
      output_.check_plant(counts_.simulated_time);
      ++counts_.cycles;
      if (hooks_.after_cycle) hooks_.after_cycle(counts_);
    }
    return counts_;
  }

 private:
  bool stop_asked() const { return hooks_.stop && hooks_.stop(); }

  void log(const char* channel, const ByteBuffer& bytes) { output_.log(channel, counts_.simulated_time, bytes); }

  // False where the run ends here.
  bool steer() {
    const SteeredPeriod period = hooks_.steer(counts_.simulated_time);
    if (period.ends_run || stop_asked()) {
      counts_.ended_by_operator = period.ends_run;
      return false;
    }
    take(period, counts_.simulated_time, output_, faults_);
    return true;
  }

  // What plant and controller say to each other at the start of a period; false if asked to stop meanwhile.
  bool talk() {
    // The controller is told where the joystick stands before it is asked for the first time.
    output_.send_operator_moves(counts_.simulated_time);

    output_.set_head(encoder_, counts_.cycles, counts_.simulated_time);
    encoder_.operator_sequence = output_.operator_sequence();
    plant_.read_encoder(encoder_);
    faults_.alter(counts_.simulated_time, encoder_);
    msgs::encode(encoder_, encoder_bytes_);
    log(msgs::kEncoderChannel, encoder_bytes_);
    plant_.begin_cycle(encoder_.sequence);

    if (faults_.empty()) {
      if (!ask(encoder_.sequence, encoder_bytes_)) return false;
      hand_over(torque_bytes_);
      return true;
    }
    return talk_with_faults();
  }

  // To the drive, and into the log.
  void hand_over(const ByteBuffer& bytes) {
    log(msgs::kTorqueChannel, bytes);
    const msgs::DecodeStatus status = msgs::decode(bytes, torque_);
    plant_.receive(status, torque_);
  }

  bool talk_with_faults() {
    const std::int64_t time = counts_.simulated_time;
    for (const ControllerAction action : faults_.controller_actions(time)) {
      if (hooks_.controller_action) hooks_.controller_action(action);
      newest_torque_ = -1;
      introduce_ = action == ControllerAction::start;
    }
    faults_.begin_period(FaultChannel::encoder, time);
    if (!faults_.controller_absent(time)) {
      faults_.pass(FaultChannel::encoder, time, encoder_.sequence, encoder_bytes_);
    }
    faults_.end_period(FaultChannel::encoder);

    faults_.begin_period(FaultChannel::torque, time);
    for (const FaultInjector::Message& question : faults_.arrivals(FaultChannel::encoder)) {
      switch (reading_of(question)) {
        case Reading::question:
          if (!ask(question.sequence, question.bytes)) return false;
          faults_.pass(FaultChannel::torque, time, question.sequence, torque_bytes_);
          break;
        case Reading::no_question: send_question(question.bytes, false); break;
        case Reading::other_question: break;
      }
    }
    faults_.end_period(FaultChannel::torque);
    for (const FaultInjector::Message& answer : faults_.arrivals(FaultChannel::torque)) hand_over(answer.bytes);
    return true;
  }

  // What a controller makes of an ENCODER: it answers it, or it does not. One whose head was changed on its way counts
  // as lost, for nobody can say what a controller does with it.
  enum class Reading { question, no_question, other_question };
  Reading reading_of(const FaultInjector::Message& message) {
    if (msgs::decode(message.bytes, incoming_encoder_) != msgs::DecodeStatus::ok) return Reading::no_question;
    if (incoming_encoder_.sequence != message.sequence ||
        incoming_encoder_.configuration_hash != settings_.configuration_hash ||
        incoming_encoder_.run_identity != settings_.run_identity ||
        incoming_encoder_.operator_sequence < 0 || incoming_encoder_.operator_sequence > output_.operator_sequence()) {
      return Reading::other_question;
    }
    return message.sequence > asked_ ? Reading::question : Reading::no_question;
  }

  // Sends ENCODER until it is answered; false if asked to stop before the answer came.
  bool ask(std::int64_t sequence, const ByteBuffer& question) {
    asked_ = sequence;
    late_answers_ = std::max<std::int64_t>(0, late_answers_ + questions_ - answers_);
    questions_ = 0;
    answers_ = 0;
    have_torque_ = false;
    have_state_ = false;
    send_question(question, introduce_);
    introduce_ = false;
    std::chrono::milliseconds patience = settings_.first_resend;
    int idle_messages = 0;
    while (!answered()) {
      const bool heard = bus_.handle_one(patience);
      if (stop_asked()) return false;
      if (heard && ++idle_messages < kIdleMessagesPerResend) continue;
      idle_messages = 0;
      patience = std::min(2 * patience, settings_.longest_resend);
      ++counts_.resends;
      send_question(question, true);
      if (hooks_.while_waiting) hooks_.while_waiting(counts_);
    }
    if (expects_state()) log(msgs::kControllerStateChannel, state_bytes_);
    return true;
  }

  // With the newest OPERATOR, where that may have been lost or the controller has only just come up.
  void send_question(const ByteBuffer& question, bool with_operator) {
    if (with_operator) output_.repeat_operator();
    bus_.publish(msgs::kEncoderChannel, question);
    ++questions_;
  }

  bool expects_state() const {
    return torque_status_ == msgs::DecodeStatus::ok && torque_.answered_sequence == asked_ &&
           torque_.state_follows;
  }
  bool answered() const { return have_torque_ && (have_state_ || !expects_state()); }

  void receive_torque(msgs::Bytes bytes) {
    if (bytes.size() > kLargestAnswer) {
      bytes = bytes.first(kLargestAnswer);
      ++counts_.cut_answers;
    }
    const msgs::DecodeStatus status = msgs::decode(bytes, incoming_torque_);
    if (status == msgs::DecodeStatus::ok && incoming_torque_.run_identity != settings_.run_identity) {
      ++counts_.foreign_answers;
      return;
    }
    ++answers_;
    if (status == msgs::DecodeStatus::ok) {
      if (incoming_torque_.sequence <= newest_torque_ && incoming_torque_.answered_sequence != asked_) {
        ++counts_.stale_answers;
        return;
      }
      newest_torque_ = std::max(newest_torque_, incoming_torque_.sequence);
    }
    const bool right = status == msgs::DecodeStatus::ok && incoming_torque_.answered_sequence == asked_ &&
                       incoming_torque_.configuration_hash == settings_.configuration_hash;
    if (have_torque_ || (!right && answers_ <= late_answers_)) {
      ++counts_.stale_answers;
      return;
    }
    if (!right) ++counts_.wrong_answers;
    std::swap(torque_, incoming_torque_);
    torque_status_ = status;
    torque_bytes_.assign(bytes.begin(), bytes.end());
    have_torque_ = true;
  }

  void receive_state(msgs::Bytes bytes) {
    if (msgs::decode(bytes, state_) != msgs::DecodeStatus::ok) return;
    if (have_state_ || state_.answered_sequence != asked_ ||
        state_.configuration_hash != settings_.configuration_hash || state_.run_identity != settings_.run_identity) {
      return;
    }
    state_bytes_.assign(bytes.begin(), bytes.end());
    have_state_ = true;
  }

  const LockstepSettings& settings_;
  DrivenPlant& plant_;
  msgs::Bus& bus_;
  const LockstepHooks& hooks_;
  PlantOutput output_;

  LockstepCounts counts_;
  std::int64_t asked_ = -1;  // the newest ENCODER that was to be answered
  bool introduce_ = false;   // the controller has only just come up
  std::int64_t newest_torque_ = -1;  // sequence number of the controller's newest TORQUE
  std::int64_t questions_ = 0;       // how often the present ENCODER was sent
  std::int64_t answers_ = 0;         // TORQUE heard since
  std::int64_t late_answers_ = 0;    // that may still come to repeated questions of earlier periods
  bool have_torque_ = false;
  bool have_state_ = false;
  msgs::DecodeStatus torque_status_ = msgs::DecodeStatus::ok;

  FaultInjector faults_;

  msgs::Encoder encoder_{};
  msgs::Encoder incoming_encoder_{};
  msgs::Torque torque_{};
  msgs::Torque incoming_torque_{};
  msgs::ControllerState state_{};

  ByteBuffer encoder_bytes_;
  ByteBuffer torque_bytes_;
  ByteBuffer state_bytes_;

  msgs::Subscription torque_subscription_;
  msgs::Subscription state_subscription_;
};

}  // namespace

LockstepCounts run_lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus,
                            const LogSink& log, const LockstepHooks& hooks) {
  return Lockstep(settings, plant, bus, log, hooks).run();
}

LockstepCounts run_lockstep(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus,
                            msgs::LogWriter& log, const LockstepHooks& hooks) {
  const LogSink sink = [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) {
    log.append(channel, timestamp_us, bytes);
  };
  return run_lockstep(settings, plant, bus, sink, hooks);
}

}  // namespace slewlab::sim
