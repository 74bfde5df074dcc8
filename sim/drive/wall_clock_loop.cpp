#include "sim/drive/wall_clock_loop.h"

#include <cmath>
#include <stdexcept>

#include "msgs/codec.h"

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
        log_(log),
        clock_(clock),
        hooks_(hooks),
        faults_(settings.faults, settings.controller_period, Stopping::process_stopped) {
    if (!(speed > 0.0) || !std::isfinite(speed)) throw std::invalid_argument("a speed must be a positive number");
    if (settings.plant_step <= 0 || settings.controller_period % settings.plant_step != 0) {
      throw std::invalid_argument("a controller period must be a multiple of the plant step");
    }
    bus_.subscribe(msgs::kTorqueChannel, [this](msgs::Bytes bytes) { receive_torque(bytes); });
    bus_.subscribe(msgs::kControllerStateChannel, [this](msgs::Bytes bytes) { this->log(msgs::kControllerStateChannel, bytes); });
  }

  WallClockReport run() {
    output();
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
      if (step > 0 && report_.simulated_time % settings_.controller_period == 0) begin_period();
      plant_.step(faults_.conditions(report_.simulated_time));
      report_.simulated_time += settings_.plant_step;
      output();

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
  bool stop_asked() const { return hooks_.stop && hooks_.stop(); }

  void log(const char* channel, msgs::Bytes bytes) { log_(channel, report_.simulated_time / 1000, bytes); }

  template <class Message>
  void set_head(Message& message, std::int64_t sequence) {
    message.sequence = sequence;
    message.simulated_time = report_.simulated_time;
    message.configuration_hash = settings_.configuration_hash;
  }

  // Asks for the first time until something comes back; false if asked to stop before.
  bool meet_controller() {
    constexpr std::chrono::milliseconds kPatience{50};
    begin_period();
    while (!heard_) {
      if (stop_asked()) return false;
      if (bus_.handle_one(kPatience)) continue;
      bus_.publish(msgs::kOperatorChannel, operator_bytes_);
      bus_.publish(msgs::kEncoderChannel, encoder_bytes_);
    }
    return true;
  }

  void begin_period() {
    const std::int64_t time = report_.simulated_time;
    if (encoder_sequence_ >= 0) {
      faults_.end_period(FaultChannel::torque);
      hand_over();
      ++report_.cycles;
      if (hooks_.after_cycle) hooks_.after_cycle(report_);
    }
    if (!faults_.empty()) {
      for (const ControllerAction action : faults_.controller_actions(time)) {
        if (hooks_.controller_action) hooks_.controller_action(action);
        if (action == ControllerAction::start) newcomer_until_ = time + kIntroduction;
      }
    }
    const auto& moves = settings_.operator_moves;
    while (next_move_ < moves.size() && moves[next_move_].time <= time) send_operator(moves[next_move_++]);
    if (operator_sequence_ < 0) send_operator(OperatorMove{});
    // A controller that was started anew subscribes when it is ready, and nobody waits for it.
    if (time < newcomer_until_) bus_.publish(msgs::kOperatorChannel, operator_bytes_);

    set_head(encoder_, ++encoder_sequence_);
    encoder_.operator_sequence = operator_sequence_;
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

  void send_operator(const OperatorMove& move) {
    set_head(operator_, ++operator_sequence_);
    operator_.speed_request = move.speed_request;
    operator_.emergency_stop = move.emergency_stop;
    operator_.acknowledge = move.acknowledge;
    msgs::encode(operator_, operator_bytes_);
    log(msgs::kOperatorChannel, operator_bytes_);
    bus_.publish(msgs::kOperatorChannel, operator_bytes_);
  }

  void receive_torque(msgs::Bytes bytes) {
    heard_ = true;
    if (faults_.empty()) {
      give_to_drive(bytes);
      return;
    }
    const bool known = msgs::decode(bytes, torque_) == msgs::DecodeStatus::ok;
    faults_.pass(FaultChannel::torque, report_.simulated_time, known ? torque_.answered_sequence : encoder_sequence_,
                 bytes);
    hand_over();
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

  void output() {
    const std::int64_t time = report_.simulated_time;
    const bool live = time % settings_.live_period == 0;
    if (time % settings_.sensors_period == 0) {
      set_head(sensors_, sensors_sequence_++);
      plant_.read_sensors(sensors_);
      output(msgs::kSensorsChannel, sensors_, live);
    }
    if (time % settings_.truth_period == 0) {
      set_head(truth_, truth_sequence_++);
      plant_.read_truth(truth_);
      output(msgs::kTruthChannel, truth_, live);
    }
    if (time % settings_.status_period == 0) {
      set_head(status_, status_sequence_++);
      plant_.read_status(status_);
      fill_health();
      output(msgs::kPlantStatusChannel, status_, live);
    }
  }

  void fill_health() {
    constexpr double kNanosecond = 1e-9;  // [s]
    status_.missed_deadlines = report_.missed_deadlines;
    status_.bin_count = LatencyHistogram::kOctaves;
    status_.bin_edge.resize(LatencyHistogram::kOctaves);
    status_.wakeup_latency.resize(LatencyHistogram::kOctaves);
    status_.step_time.resize(LatencyHistogram::kOctaves);
    for (int i = 0; i < LatencyHistogram::kOctaves; ++i) {
      status_.bin_edge[i] = LatencyHistogram::octave_edge(i) * kNanosecond;
      status_.wakeup_latency[i] = report_.wakeup_latency.octave_count(i);
      status_.step_time[i] = report_.step_time.octave_count(i);
    }
  }

  template <class Message>
  void output(const char* channel, const Message& message, bool live) {
    msgs::encode(message, output_bytes_);
    log(channel, output_bytes_);
    if (live) bus_.publish(channel, output_bytes_);
  }

  static constexpr std::int64_t kIntroduction = 5'000'000'000;  // [ns] a program takes that long to come up at most

  const LockstepSettings& settings_;
  double speed_;
  DrivenPlant& plant_;
  msgs::Bus& bus_;
  const LogSink& log_;
  LoopClock& clock_;
  const WallClockHooks& hooks_;
  FaultInjector faults_;

  WallClockReport report_;
  bool heard_ = false;
  std::size_t handed_over_ = 0;  // of the TORQUE that arrived in this period
  std::size_t next_move_ = 0;
  std::int64_t newcomer_until_ = 0;  // [ns]
  std::int64_t operator_sequence_ = -1;
  std::int64_t encoder_sequence_ = -1;
  std::int64_t sensors_sequence_ = 0;
  std::int64_t truth_sequence_ = 0;
  std::int64_t status_sequence_ = 0;

  msgs::Encoder encoder_{};
  msgs::Operator operator_{};
  msgs::Torque torque_{};
  msgs::Sensors sensors_{};
  msgs::Truth truth_{};
  msgs::PlantStatus status_{};
  ByteBuffer operator_bytes_;
  ByteBuffer encoder_bytes_;
  ByteBuffer output_bytes_;
};

}  // namespace

WallClockReport run_wall_clock(const LockstepSettings& settings, double speed, DrivenPlant& plant, msgs::Bus& bus,
                               const LogSink& log, LoopClock& clock, const WallClockHooks& hooks) {
  return WallClock(settings, speed, plant, bus, log, clock, hooks).run();
}

}  // namespace slewlab::sim
