// What a torque balance needs of a record: position and effort of the axis on an even grid, smoothed alike.
//
//   J q'' + friction(q', q, t) + load(q) = F
//
// The acceleration is that of a cubic fitted over a sliding window (Savitzky, Golay 1964, Analytical Chemistry 36, p. 1627).
// Summed by parts it is a mean of second differences under a bump, (1 - x^2)^2 across the window; effort and every law that is
// evaluated on the measured motion pass that same mean. So the balance is exact also where a torque is switched or a friction
// changes its sign inside a window. The window is as long as the noise of the positions asks for, and no longer:
//
//   J sigma_a <= kNoiseShare * rms(F),   sigma_a^2 = 720 sigma_q^2 / (h^4 N (N^2 - 1) (N^2 - 4))   of N samples h apart
//
// Units: those of the axis; [rad, Nm, kg m^2] of a rotary, [m, N, kg] of a linear one.
#pragma once

#include <string>
#include <vector>

namespace slewlab::diagnosis {

struct AxisRecord {
  std::string name;
  double step = 0.0;              // [s]
  std::vector<double> position;   // on the axis
  std::vector<double> effort;     // torque or force of the motors on the axis, held from this sample to the next
  double start_time = 0.0;        // [s] of the first sample since the machine was cold
  std::vector<double> load{};     // of the effort, what is not the motors': loads, forces and frictions of the axis's file; empty: nothing
};

// How an effort comes late: as a first-order lag has it, or all of it a fixed time after its command.
struct Lateness {
  double time = 0.0;  // [s] the lag's time constant, or the delay
  bool is_delay = false;
};

// What laws are evaluated on: the motion under a window half as long as the balance's, so that a reversal stays sharp.
struct BalanceMotion {
  std::vector<double> time;  // [s] since the record's beginning
  std::vector<double> position, speed;
  std::vector<double> effort_rate;  // of the commanded effort, per second
  // For each lateness that is tried: what it withholds of the effort, per second of its time; sample by sample.
  std::size_t late_count = 0;
  std::vector<double> late;
};

// Acceleration, effort and speed under the balance's window, of equal length; `motion` is longer by the window: a law
// evaluated on it and passed through balance_smoothed() has this length.
struct BalanceRecord {
  std::string name;
  double step = 0.0;
  std::size_t half_window = 0;  // [samples]
  BalanceMotion motion;
  std::vector<double> time, position, speed, acceleration, effort;
  double speed_noise = 0.0;     // standard deviation, of the motion's speed
  // What white noise of the efforts makes under the filter: products per sample of the effort (first) and of what each lateness withholds of it, row by row.
  std::vector<double> noise_products;
};

// [unit of position] standard deviation of white noise in the positions: of counts, q / sqrt(12); of a smooth signal,
// from the median of its third differences.
double position_noise(const std::vector<double>& position);

// [unit of position per s^2] standard deviation of the acceleration under a window of so many samples to either side.
double acceleration_noise(const AxisRecord& record, std::size_t half_window);

// [unit of effort] standard deviation of white noise in the recorded efforts: of torques that were rounded when they were written down, their
// step / sqrt(12); else from the median of their third differences, which knows nothing of a torque that is switched now and then.
double effort_noise(const std::vector<double>& effort);

// [unit of effort] what that becomes under the balance's window; and what it is that nobody recorded when, between two samples, a torque was switched:
// at any instant, so that of a step D a sample is wrong by D / sqrt(12).
double smoothed_effort_noise(const AxisRecord& record, std::size_t half_window);

inline constexpr std::size_t kFewestHalf = 3;  // [samples]: a cubic over seven

// Half of the window that the noise asks for, at least kFewestHalf samples, at most `longest` [s].
std::size_t balance_half_window(const AxisRecord& record, double inertia, double longest);

// `lateness`: what laws ask for. Throws std::invalid_argument where the record is shorter than four windows.
BalanceRecord make_balance_record(const AxisRecord& record, std::size_t half_window, const std::vector<Lateness>& lateness = {});

// BalanceRecord::noise_products for white noise of 1 in the efforts, `step` [s] apart: by the answer to a single sample of 1.
std::vector<double> effort_noise_products(double step, std::size_t half_window, const std::vector<Lateness>& lateness);

// The filter of the balance on a series along the motion.
std::vector<double> balance_smoothed(const std::vector<double>& values, std::size_t half_window);

// Indices of the samples that move faster than this.
std::vector<std::size_t> moving_samples(const BalanceRecord& record, double resolved_speed);

}  // namespace slewlab::diagnosis
