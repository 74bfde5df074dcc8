// What the plant says besides its question to the controller, in lockstep and against the wall clock alike: OPERATOR where the
// joystick moves, SENSORS, TRUTH (with MOTION, where the crane does more than slew) and PLANT_STATUS where their periods end. All of it goes into the log, stamped with the simulated
// time; onto the bus go OPERATOR at once and the other three every `live_period`.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "msgs/bus.h"
#include "msgs/codec.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/lockstep_loop.h"

namespace slewlab::sim {

// What the drive looks at of a message on TORQUE, and the log holds of it: the TORQUE of the largest crane is half as
// long, and what floods the bus must not fill the disk.
inline constexpr std::size_t kLargestAnswer = 256;  // [bytes]

class PlantOutput {
 public:
  // Keeps references to all of them.
  PlantOutput(const LockstepSettings& settings, DrivenPlant& plant, msgs::Bus& bus, const LogSink& log)
      : settings_(settings), plant_(plant), bus_(bus), log_(log) {}

  template <class Message>
  void set_head(Message& message, std::int64_t sequence, std::int64_t simulated_time) const {
    message.sequence = sequence;
    message.simulated_time = simulated_time;
    message.configuration_hash = settings_.configuration_hash;
    message.run_identity = settings_.run_identity;
  }

  void log(const char* channel, std::int64_t simulated_time, msgs::Bytes bytes) { log_(channel, simulated_time / 1000, bytes); }

  // OPERATOR for every move that is due at `simulated_time` [ns] and was not sent; the first call says in any case where the joystick
  // stands.
  void send_operator_moves(std::int64_t simulated_time);
  // OPERATOR for a move that nobody knew of before.
  void send_operator(const OperatorMove& move, std::int64_t simulated_time);
  // The newest OPERATOR once more, on the bus alone.
  void repeat_operator() { bus_.publish(msgs::kOperatorChannel, operator_bytes_); }
  std::int64_t operator_sequence() const { return operator_sequence_; }

  // SENSORS, TRUTH and PLANT_STATUS whose periods end at `simulated_time` [ns]. `complete`, where there is one, adds what the plant does
  // not know of itself.
  void send_series(std::int64_t simulated_time, const std::function<void(msgs::PlantStatus&)>& complete = {});

  // Throws PlantDiverged where the plant is no machine any more.
  void check_plant(std::int64_t simulated_time) const;

 private:
  template <class Message>
  void send(const char* channel, std::int64_t simulated_time, const Message& message);

  const LockstepSettings& settings_;
  DrivenPlant& plant_;
  msgs::Bus& bus_;
  const LogSink& log_;

  std::size_t next_move_ = 0;
  std::int64_t operator_sequence_ = -1;
  std::int64_t sensors_sequence_ = 0, truth_sequence_ = 0, motion_sequence_ = 0, status_sequence_ = 0;
  msgs::Operator operator_{};
  msgs::Sensors sensors_{};
  msgs::Truth truth_{};
  msgs::Motion motion_{};
  msgs::PlantStatus status_{};
  std::vector<std::uint8_t> operator_bytes_;  // of the newest
  std::vector<std::uint8_t> bytes_;
};

// What a steered period brings, at its beginning.
void take(const SteeredPeriod& period, std::int64_t simulated_time, PlantOutput& output, FaultInjector& faults);

}  // namespace slewlab::sim
