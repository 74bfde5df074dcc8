// One measured (or simulated) manoeuvre on an even grid of time, as the diagnosis wants it, and the checks that
// admit it: what is missing, frozen, clipped, torn, in the wrong sign or unit is said and not guessed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/rounding.h"
#include "msgs/run_log.h"
#include "slewlab_msgs/signals.hpp"
#include "sim/machine/description.h"

namespace slewlab::diagnosis {

// The accelerometers: those readings of SENSORS that are accelerations, in the message's order.
constexpr bool is_acceleration(std::string_view unit) { return unit == "m/s^2"; }
inline constexpr int kAccelerometerCount = static_cast<int>(std::count_if(
    msgs::kSensorFields<msgs::Sensors>.begin(), msgs::kSensorFields<msgs::Sensors>.end(), [](const auto& field) { return is_acceleration(field.unit); }));
template <class Readings>
inline constexpr std::array<msgs::SensorField<Readings>, kAccelerometerCount> kAccelerometers = [] {
  std::array<msgs::SensorField<Readings>, kAccelerometerCount> fields{};
  std::copy_if(msgs::kSensorFields<Readings>.begin(), msgs::kSensorFields<Readings>.end(), fields.begin(), [](const auto& field) { return is_acceleration(field.unit); });
  return fields;
}();
// The accelerometer at a place, as msgs/sensors_t.lcm names it; -1: none.
constexpr int accelerometer_at(std::string_view place) {
  for (int a = 0; a < kAccelerometerCount; ++a) {
    if (kAccelerometers<msgs::Sensors>[static_cast<std::size_t>(a)].place == place) return a;
  }
  return -1;
}
inline constexpr int kTip = accelerometer_at("tip");  // by which the observer damps its boom
static_assert(kTip >= 0);
std::string accelerometer_name(int accelerometer);    // its place

// A moment at which the operator's wish changes.
struct OperatorMove {
  std::int64_t simulated_time = 0;  // [ns]
  double speed_request = 0.0;       // [-]
  bool emergency_stop = false;
  bool acknowledge = false;
};

// Variances of white noise.
struct SensorNoise {
  std::array<double, sim::kMaximumGroupCount> encoder{};     // [rad^2] of a motor's position, per reading
  std::array<double, kAccelerometerCount> accelerometer{};  // [(m/s^2)^2] per grid point
  double torque = 0.0;                                      // [Nm^2] of each motor's torque as it was written down, per grid point
};

struct Record {
  std::string name;             // file and run, for messages
  double step = 1e-3;           // [s] grid of all series below
  double encoder_period = 0.0;  // [s] of the controller's cycle
  int group_count = 0;
  double start_time = 0.0;      // [s] of the first grid point
  double effects_from = 0.0;    // [s] the same clock's where effects begin to count their time (a roll's phase, a clock's drift)
  // Series of equal length. Torque [Nm per motor] is the command that holds from this grid point to the next.
  std::array<std::vector<double>, sim::kMaximumGroupCount> motor_torque;
  std::array<std::vector<double>, sim::kMaximumGroupCount> shaft_speed;     // [rad/s]
  std::array<std::vector<double>, sim::kMaximumGroupCount> shaft_position;  // [rad]
  // [rad/s] Rate of the positions, without delay: what a drive reports as its speed comes out of a filter that lags.
  std::array<std::vector<double>, sim::kMaximumGroupCount> position_rate;
  std::array<std::vector<double>, kAccelerometerCount> acceleration;        // [m/s^2]; empty: not measured
  // Where the sensors are not sampled on the grid: when [ns] and what they said. The series above are lines between these.
  std::vector<std::int64_t> sampled_at;
  std::array<std::vector<double>, kAccelerometerCount> sampled_acceleration;
  double sensor_period = 0.0;                                               // [s]; 0 without sensors
  // Where the grid is coarser than the recording (judged_grid.h): how often between two grid points it was recorded, the commands as often
  // [Nm per motor], of which `motor_torque` has the means, and the sensors' noise, which no longer shows on the grid.
  std::size_t recorded_per_point = 1;
  std::array<std::vector<double>, sim::kMaximumGroupCount> recorded_torque;
  std::optional<SensorNoise> noise;
  std::vector<double> slew_angle;                                           // [rad]; empty: not measured
  std::vector<OperatorMove> operator_moves;
  std::vector<msgs::Encoder> encoder;  // the messages themselves, for the controller's replay
  std::vector<msgs::Torque> torque;
  std::vector<msgs::PlantStatus> plant_status;
  bool begins_in_motion = false;  // the crane turns when the record begins
  // The three below the nominal machine tells (admit.h).
  bool begins_bent = false;       // in motion, or where the drives have just pressed the gears: boom and load may swing
  bool load_may_swing = false;    // at rest, and load and boom may swing on from moves before
  bool begins_on_flanks = false;  // of the gears, to which the torques push; else in the middle of their play
  std::vector<bool> impacts_of_cause;  // grid points at which a machine that explains the record has its teeth apart, and the nominal one need not; empty: none
  double encoder_quantum = 0.0;        // [rad] smallest step that the encoder positions keep to; 0: none found
  Rounding torque_rounding;            // [Nm]
  bool has_measured_torque = false;    // so that what lies between command and torque does not show
  double torque_noise = 0.0;           // [Nm^2] white, of each motor's torque as it was measured (torque_noise.h) or written down, per command
  std::array<Rounding, kAccelerometerCount> acceleration_rounding{};  // [m/s^2]
  std::vector<std::string> remarks;    // what was mended or left out, one line each

  std::size_t size() const { return motor_torque[0].size(); }
  double time(std::size_t n) const { return start_time + step * static_cast<double>(n); }
  double effects_begin() const { return start_time - effects_from; }  // [s] of their time, at the first grid point
};

// [Nm per motor] over the groups, at a grid point: what of their torques turns the axis.
double mean_torque(const Record& record, std::size_t n);

// Whether the commands change from nearly every message to the next: then nobody knows whether the recorder wrote all of them, and the controller's cycle does not show.
bool changes_with_every_message(const Record& record);

// [grid points] from one reading of the encoders to the next, at least one.
std::size_t reading_stride(const Record& record);

// [Nm per motor] the commands as they were recorded, and the time from one to the next [s].
const std::vector<double>& commands(const Record& record, std::size_t group);
double command_step(const Record& record);

// Whether encoders and commands hold what is in the band of a grid that is coarser than the readings (judged_grid.h), and no single readings.
bool is_filtered(const Record& record);

// [rad] Just above 2 pi / 4096: drives count 12 bits at least, 14 as a rule.
inline constexpr double kCoarseCount = 1.6e-3;

// A log that must not be judged; what() says why and what would help.
class NotAdmitted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Takes the first so many grid points off all series; what was said on the wire before stays known.
void leave_out_beginning(Record& record, std::size_t points);

// The accelerometer that a sensor of the description is; -1: none of them.
int accelerometer_at(const sim::Sensor& sensor);

// Of a nominal machine, by thresholds_of() (thresholds.h).
struct AdmissionSettings {
  double rated_torque = 0.0;     // [Nm] per motor, to recognise wrong units
  double total_ratio = 1.0;      // motor turns per turn of the axis, to recognise wrong axes
  std::array<double, kAccelerometerCount> radius{};  // [m] of each accelerometer from the axis; 0: none
  double time = 0.0;             // [s] characteristic time of the machine
  double turn = 0.0;             // [rad] of a motor at top speed in that time
  double shortest_record = 0.0;  // [s] below which no mode of the machine shows twice
  double frozen_time = 0.0;      // [s] of exactly equal values on a moving machine
  double rate_half_width = 0.0;  // [s] of the cubic through positions whose slope is their rate: 0.3 % low at the highest frequency judged
  double speed_window = 0.0;     // [s] half width over which speeds and rates of positions are compared
  double slow = 0.0;             // [s] half width of what is slower than the structure
  bool is_torque_measured = false;  // TORQUE holds no commands, but what was measured
};

// [rad/s] of a motor, up to which it may be that of a load that swings on a machine at rest.
double creeping_speed(const AdmissionSettings& settings);

// Slope of the cubic that fits 2 `half_width` + 1 values best, at its middle (Savitzky, Golay 1964, Analytical Chemistry
// 36, p. 1627); near the ends with fewer values, two at least. `half_width` >= 2.
std::vector<double> cubic_slope(const std::vector<double>& values, std::size_t half_width, double step);

// What was sampled at rising `times` [ns], two at least, on the grid of the record: straight in between, standing still before the first
// and after the last.
std::vector<double> resample(const std::vector<std::int64_t>& times, const std::vector<double>& values, const Record& record, std::size_t count);

// A log on the record's grid, its clocks checked and nothing else: what make_record() begins with. Throws NotAdmitted.
Record unchecked_record(const msgs::RunLog& run, const std::string& name, const AdmissionSettings& settings);

// Throws NotAdmitted. Small gaps (up to 3 missing messages in a row) are bridged and remarked.
Record make_record(const msgs::RunLog& run, const std::string& name, const AdmissionSettings& settings);

// [s] Where effects begin to count their time: at zero of the clock that records have in common, by which they know one roll; of records that all begin later than they are long at the first
// beginning, or phases would go with the period so steeply that no fit finds them. One that begins far from the others goes by another clock, and counts from its own beginning.
double effects_from(std::span<const Record> records, const Record& record);

}  // namespace slewlab::diagnosis
