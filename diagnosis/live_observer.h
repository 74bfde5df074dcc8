// The observer (shadow.h) beside a machine that runs: it takes the messages as they come and says from time to time what the motors
// and the accelerometers have beyond the nominal machine. It goes on from where it was, so that a look costs what is new, and keeps
// no more of the past than the rate of a position needs. Behind a gap in the messages it begins again, in motion. Where PLANT_STATUS
// says that the drive is tripped it stops, for no message tells where the teeth stand when the brakes let go, and begins again once the
// drive has run for a while; what is newer than the newest PLANT_STATUS waits for the next, for some characteristic times.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/record.h"
#include "diagnosis/recorded_drive.h"
#include "diagnosis/shadow.h"
#include "diagnosis/thresholds.h"
#include "msgs/bus.h"
#include "msgs/run_log.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

// Series of equal length.
struct LiveGap {
  std::vector<double> time;  // [s]
  std::array<std::vector<double>, sim::kMaximumGroupCount> missing_torque;       // [Nm] per motor; empty: no such group
  std::array<std::vector<double>, kAccelerometerCount> acceleration_difference;  // [m/s^2] measured - observer; NaN: not measured
  std::string begins_again;  // why, where it had to; the series are empty then
};

class LiveObserver {
 public:
  // Throws std::invalid_argument where the machine cannot be assembled.
  explicit LiveObserver(const sim::MachineSettings& nominal);
  LiveObserver(const LiveObserver&) = delete;
  LiveObserver& operator=(const LiveObserver&) = delete;

  // A message as it was on the wire; what is none, or of another run than the first, is left alone.
  void take(const std::string& channel, msgs::Bytes bytes);

  // What is new, if enough time has passed since it was asked last.
  std::optional<LiveGap> look();

  double time() const { return thresholds_.time; }  // [s] characteristic time of the machine

 private:
  template <class Message>
  void keep(msgs::Bytes bytes, std::vector<Message>& into);
  LiveGap begin_again(std::string why);
  bool is_tripped() const;
  std::optional<LiveGap> wait_behind_trip();
  void begin();
  void advance(std::size_t point, LiveGap& gap);
  void forget_until(std::int64_t time);

  sim::MachineSettings nominal_;
  sim::Scales scales_;
  Thresholds thresholds_;
  msgs::RunLog run_;  // the newest stretch
  bool has_run_ = false;
  std::optional<msgs::PlantStatus> status_;  // the newest
  // Behind a trip the drive runs for a while before anything is compared: until then the torques have pressed the teeth.
  enum class Drive { runs, is_tripped, presses_teeth } drive_does_ = Drive::runs;
  std::int64_t next_look_ = 0;  // [ns]
  Record record_;               // of that stretch
  std::optional<RecordedDrive> drive_;
  std::optional<Observer> observer_;
  std::int64_t began_ = 0;      // [ns]
  std::int64_t told_ = 0;       // [ns] of the newest point that was told
};

}  // namespace slewlab::diagnosis
