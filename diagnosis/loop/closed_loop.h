// Crane and controller as libraries in one process, in lockstep on a virtual clock: the same as the two
// processes with LCM in between, without the wire. Operator schedule in, time series out.
//
// At each controller period the controller sees the encoders of that instant; its torques are held until the
// next one. Same inputs, same bits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controller/controller.h"
#include "sim/integrate/plant.h"

namespace slewlab::diagnosis {

// What the operator does from `time` on, until the next event.
struct OperatorEvent {
  double time = 0.0;           // [s]
  double speed_request = 0.0;  // [-] -1 ... 1
  bool emergency_stop = false;
  bool acknowledge = false;
};

struct ClosedLoopRun {
  sim::CraneParameters crane;
  controller::ControllerSettings controller;  // its period must be a whole multiple of plant_step
  double plant_step = 1e-3;                   // [s]
  double duration = 0.0;                      // [s]
  std::vector<OperatorEvent> schedule;        // rising times
  bool record_shear = false;
};

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
  PerGroupSeries motor_torque;             // [Nm] per motor, fast axis
  PerGroupSeries gear_torque;              // [Nm] on the house, slew axis
  PerGroupSeries deflection;               // [rad] motor minus house, slew axis
  PerGroupSeries crossing_times;           // [s] at which the play was crossed from flank to flank
  std::vector<std::vector<double>> shear;  // [N] per element, where asked for
  std::int64_t mode_steps = 0;             // modes advanced, splits left out: the plant's work
  std::int64_t contact_changes = 0;
};

// Throws std::invalid_argument when the crane cannot be built, the groups or ratios of crane and controller
// do not agree, or the periods do not fit.
ClosedLoopSeries run_closed_loop(const ClosedLoopRun& run);

// Index of the first value at or after `time` [s].
std::size_t index_at(const ClosedLoopSeries& series, double time);

// Total crossings of the play by a group between two times [s].
int crossings_between(const ClosedLoopSeries& series, int group, double from, double to);

// Times [s] at which a gear's torque changes sign (the zeros of free flight are skipped).
std::vector<double> sign_changes(const ClosedLoopSeries& series, int group, double from, double to);

}  // namespace slewlab::diagnosis
