#include "sim/drive/wall_clock_loop.h"

#include <cmath>
#include <stdexcept>

#include "msgs/codec.h"
#include "sim/drive/plant_output.h"

namespace slewlab::sim {
namespace {

using ByteBuffer = std::vector<std::uint8_t>;

class WallClock {
 public:
  WallClock(const LockstepSettings& settings, double speed, DrivenPlant& plant, msgs::Bus& bus, const LogSink& log,
            LoopClock& clock, const WallClockHooks& hooks)
      : settings_(settings),
        speed_(speed),
        plant_(plant),
        bus_(bus),
        clock_(clock),
        hooks_(hooks),
        output_(settings, plant, bus, log),
        faults_(settings.faults, settings.controller_period, Stopping::process_stopped),
        torque_subscription_(bus, msgs::kTorqueChannel, [this](msgs::Bytes bytes) { receive_torque(bytes); }),
        state_subscription_(bus, msgs::kControllerStateChannel, [this](msgs::Bytes bytes) { receive_state(bytes); }) {
    if (!(speed > 0.0) || !std::isfinite(speed)) throw std::invalid_argument("a speed must be a positive number");
    if (settings.plant_step <= 0 || settings.controller_period % settings.plant_step != 0) {
      throw std::invalid_argument("a controller period must be a multiple of the plant step");
    }
  }

  WallClockReport run() {
    send_series();
    output_.check_plant(report_.simulated_time);
    if (!meet_controller()) return report_;
    const std::int64_t start = clock_.now();
    const auto due = [&](std::int64_t step) {
      return start + static_cast<std::int64_t>(
                         std::llround(static_cast<double>(step) * static_cast<double>(settings_.plant_step) / speed_));
    };
    const double budget = static_cast<double>(settings_.plant_step) / speed_;  // [ns]
    for (std::int64_t step = 0; report_.simulated_time < settings_.duration && !stop_asked(); ++step) {
      clock_.sleep_until(due(step));
      const std::int64_t awake = clock_.now();
      const std::int64_t worked = clock_.processor_time();
      report_.wakeup_latency.add(awake - due(step));

      bus_.drain();
      if (step > 0 && report_.simulated_time % settings_.controller_period == 0) {
        output_.check_plant(report_.simulated_time);
        begin_period();
      }
      plant_.step(faults_.conditions(report_.simulated_time));
      report_.simulated_time += settings_.plant_step;
      send_series();
      if (report_.simulated_time % settings_.controller_period == 0) {
        ++report_.cycles;
        if (hooks_.after_cycle) hooks_.after_cycle(report_);
      }

      const std::int64_t done = clock_.now();
      report_.step_time.add(done - awake);
      if (done > due(step + 1)) {
        ++report_.missed_deadlines;
        if (static_cast<double>(clock_.processor_time() - worked) > budget) ++report_.missed_by_own_computation;
      }
    }
    return report_;
  }

 private:
  bool stop_asked() const { return report_.ended_by_operator || (hooks_.stop && hooks_.stop()); }

  void log(const char* channel, msgs::Bytes bytes) { output_.log(channel, report_.simulated_time, bytes); }

  void send_series() {
    output_.send_series(report_.simulated_time, [this](msgs::PlantStatus& status) { add_health(status); });
  }

  // Asks for the first time until something comes back; false if asked to stop before.
  bool meet_controller() {
    constexpr std::chrono::milliseconds kPatience{50};
    begin_period();
    while (!heard_) {
      if (stop_asked()) return false;
      if (bus_.handle_one(kPatience)) continue;
      output_.repeat_operator();
      bus_.publish(msgs::kEncoderChannel, encoder_bytes_);
      if (hooks_.while_waiting) hooks_.while_waiting(report_);
    }
    return true;
  }

  void begin_period() {
    const std::int64_t time = report_.simulated_time;
    answers_ = undecodable_answers_ = 0;
    if (encoder_sequence_ >= 0) {
      faults_.end_period(FaultChannel::torque);
      hand_over();
    }
    if (hooks_.steer) {
      const SteeredPeriod period = hooks_.steer(time);
      report_.ended_by_operator = period.ends_run;
      take(period, time, output_, faults_);
    }
    if (!faults_.empty()) {
      for (const ControllerAction action : faults_.controller_actions(time)) {
        if (hooks_.controller_action) hooks_.controller_action(action);
        if (action == ControllerAction::start) newcomer_until_ = time + kIntroduction;
      }
    }
    output_.send_operator_moves(time);
    // A controller that was started anew subscribes when it is ready, and nobody waits for it.
    if (time < newcomer_until_) output_.repeat_operator();

    output_.set_head(encoder_, ++encoder_sequence_, time);
    encoder_.operator_sequence = output_.operator_sequence();
    plant_.read_encoder(encoder_);
    faults_.alter(time, encoder_);
    msgs::encode(encoder_, encoder_bytes_);
    log(msgs::kEncoderChannel, encoder_bytes_);
    plant_.begin_cycle(encoder_sequence_);
    if (faults_.empty()) {
      bus_.publish(msgs::kEncoderChannel, encoder_bytes_);
      return;
    }
    faults_.begin_period(FaultChannel::encoder, time);
    if (!faults_.controller_absent(time)) {
      faults_.pass(FaultChannel::encoder, time, encoder_sequence_, encoder_bytes_);
    }
    faults_.end_period(FaultChannel::encoder);
    for (const auto& message : faults_.arrivals(FaultChannel::encoder)) {
      bus_.publish(msgs::kEncoderChannel, message.bytes);
    }
    faults_.begin_period(FaultChannel::torque, time);
    handed_over_ = 0;
    hand_over();
  }

  void receive_torque(msgs::Bytes bytes) {
    if (bytes.size() > kLargestAnswer) {
      bytes = bytes.first(kLargestAnswer);
      ++report_.cut_answers;
    }
    const bool known = msgs::decode(bytes, torque_) == msgs::DecodeStatus::ok;
    if (known && torque_.run_identity != settings_.run_identity) {
      ++report_.foreign_answers;
      return;
    }
    if (known ? ++answers_ > kAnswersPerPeriod : ++undecodable_answers_ > kUndecodablePerPeriod) {
      ++report_.flooding_answers;
      return;
    }
    heard_ = true;
    if (faults_.empty()) {
      give_to_drive(bytes);
      return;
    }
    faults_.pass(FaultChannel::torque, report_.simulated_time, known ? torque_.answered_sequence : encoder_sequence_,
                 bytes);
    hand_over();
  }

  void receive_state(msgs::Bytes bytes) {
    if (msgs::decode(bytes, state_) != msgs::DecodeStatus::ok || state_.run_identity != settings_.run_identity) return;
    log(msgs::kControllerStateChannel, bytes);
  }

  // What the faults have let through since the last time.
  void hand_over() {
    const auto& arrived = faults_.arrivals(FaultChannel::torque);
    for (; handed_over_ < arrived.size(); ++handed_over_) give_to_drive(arrived[handed_over_].bytes);
  }

  void give_to_drive(msgs::Bytes bytes) {
    log(msgs::kTorqueChannel, bytes);
    const msgs::DecodeStatus status = msgs::decode(bytes, torque_);
    plant_.receive(status, torque_);
  }

  void add_health(msgs::PlantStatus& status) const {
    constexpr double kNanosecond = 1e-9;  // [s]
    status.missed_deadlines = report_.missed_deadlines;
    status.bin_count = LatencyHistogram::kOctaves;
    status.bin_edge.resize(LatencyHistogram::kOctaves);
    status.wakeup_latency.resize(LatencyHistogram::kOctaves);
    status.step_time.resize(LatencyHistogram::kOctaves);
    for (int i = 0; i < LatencyHistogram::kOctaves; ++i) {
      status.bin_edge[i] = LatencyHistogram::octave_edge(i) * kNanosecond;
      status.wakeup_latency[i] = report_.wakeup_latency.octave_count(i);
      status.step_time[i] = report_.step_time.octave_count(i);
    }
  }

  static constexpr std::int64_t kIntroduction = 5'000'000'000;  // [ns] a program takes that long to come up at most

  static constexpr int kAnswersPerPeriod = 1000;   // chosen: of a controller that stood still for 10 s at 10 ms
  static constexpr int kUndecodablePerPeriod = 4;  // chosen: a field bus brings one telegram

  const LockstepSettings& settings_;
  double speed_;
  DrivenPlant& plant_;
  msgs::Bus& bus_;
  LoopClock& clock_;
  const WallClockHooks& hooks_;
  PlantOutput output_;
  FaultInjector faults_;

  WallClockReport report_;
  bool heard_ = false;
  int answers_ = 0;              // on TORQUE in this period that decode
  int undecodable_answers_ = 0;  // that do not
  std::size_t handed_over_ = 0;  // of the TORQUE that arrived in this period
  std::int64_t newcomer_until_ = 0;  // [ns]
  std::int64_t encoder_sequence_ = -1;

  msgs::Encoder encoder_{};
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
  ByteBuffer encoder_bytes_;

  msgs::Subscription torque_subscription_;
  msgs::Subscription state_subscription_;
};

}  // namespace

WallClockReport run_wall_clock(const LockstepSettings& settings, double speed, DrivenPlant& plant, msgs::Bus& bus,
                               const LogSink& log, LoopClock& clock, const WallClockHooks& hooks) {
  return WallClock(settings, speed, plant, bus, log, clock, hooks).run();
}

}  // namespace slewlab::sim
