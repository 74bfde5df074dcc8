// A run in the loop (loop.h) as time series of what machine and controller do, truth included.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "diagnosis/loop/loop.h"

namespace slewlab::diagnosis {

using PerGroupSeries = std::array<std::vector<double>, sim::kMaximumGroupCount>;

// One value per plant step, the first after one step.
struct ClosedLoopSeries {
  double step = 0.0;  // [s] between values
  int group_count = 0;
  std::vector<double> time;                // [s]
  std::vector<double> ramped_speed;        // [rad/s] slew axis
  std::vector<double> slew_angle;          // [rad] house
  std::vector<double> house_speed;         // [rad/s]
  std::vector<double> house_acceleration;  // [rad/s^2]
  std::vector<double> middle_acceleration; // [m/s^2]
  std::vector<double> tip_velocity;        // [m/s]
  std::vector<double> tip_acceleration;    // [m/s^2]
  std::vector<double> rope_angle;          // [rad] sidelead, positive when the load leads the tip
  std::vector<double> rod_angle;           // [rad]
  std::vector<double> average_torque;      // [Nm] per motor, fast axis, before the play compensation
  PerGroupSeries shaft_speed;              // [rad/s] fast axis
  PerGroupSeries motor_torque;             // [Nm] per motor, fast axis, as the drives deliver it
  PerGroupSeries gear_torque;              // [Nm] on the house, slew axis
  PerGroupSeries deflection;               // [rad] motor minus house, slew axis
  PerGroupSeries crossing_times;           // [s] at which the play was crossed from flank to flank
  std::vector<std::vector<double>> shear;  // [N] per element, where asked for
  std::int64_t mode_steps = 0;             // modes advanced, splits left out: the plant's work
  std::int64_t contact_changes = 0;
};

// Throws std::invalid_argument when the machine cannot be built, the groups or ratios of machine and controller
// do not agree, or the periods do not fit.
ClosedLoopSeries run_closed_loop(const LoopSettings& settings, bool record_shear = false);

// Index of the first value at or after `time` [s].
std::size_t index_at(const ClosedLoopSeries& series, double time);

// Total crossings of the play by a group between two times [s].
int crossings_between(const ClosedLoopSeries& series, int group, double from, double to);

// Times [s] at which a gear's torque changes sign (the zeros of free flight are skipped).
std::vector<double> sign_changes(const ClosedLoopSeries& series, int group, double from, double to);

}  // namespace slewlab::diagnosis
