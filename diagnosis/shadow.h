// A machine that shadows a record: it gets what its drive makes of the recorded torques (recorded_drive.h) and is led along by forces from outside, at each
// motor the torque that keeps its encoder on the recorded one, at the tip a force that damps what the tip's
// accelerometer still differs by. The torque is what the model misses at the motors, in Nm; the accelerometers'
// differences are what it misses behind them. Feedback that hides a gap in the speed shows it here as an
// effort; no controller needs to be known; and what an impact got wrong is forgotten within the machine's characteristic time.
//
//   u(n) = K_p (e(n) - e(n - m)) / (m step) + K_i e(n),    e = position_measured - position_shadow     per motor
//   F = D e,  e' = a_measured - a_shadow - o - e / tau                                       at the tip
//
// Both speeds are thus taken over the same m steps, from readings that have been: of an encoder's noise u(n) holds none that is yet to come,
// so that no delay of the model can make it smaller (the torque that the noise moves comes after it). o is the tip sensor's offset: the difference's mean over `first_offset`, later forgotten within `offset_time`.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/record.h"
#include "diagnosis/recorded_drive.h"
#include "sim/integrate/machine.h"
#include "sim/integrate/machine_settings.h"
#include "sim/machine/scales.h"

namespace slewlab::diagnosis {

// As rates, by thresholds_of() (thresholds.h); T is the machine's characteristic time.
struct ShadowSettings {
  // Chosen: a motor follows its encoder with 26 / T and critical damping, faster than the lowest modes, slow enough for the encoder's
  // noise to stay small as a torque.
  double speed_rate = 0.0;        // [1/s] K_p per motor inertia
  double position_rate = 0.0;     // [1/s^2] K_i per motor inertia
  // Chosen: as long as leaves little of the encoder's noise in a speed, short against the observer's own time and the fastest motion judged.
  double speed_window = 0.0;      // [s] m steps, one at least
  // Chosen: about a fifth of critical damping for errors of a first bending mode at 1 / T.
  double tip_damping_rate = 0.0;  // [1/s] D per boom mass
  double leak_time = 0.0;         // [s] tau: an accelerometer's offset must not become a speed
  double first_offset = 0.0;      // [s] over which the tip sensor's offset is first taken; until then it leads nothing
  double first_slope = 0.0;       // [s] over which the acceleration is taken with which a record in motion begins
  double offset_time = 0.0;       // [s] in which it may drift: slower than any pendulum of a load
};

// Of one diagnosis: taken from the nominal crane and the same for every hypothesis, so that none makes its differences
// small by making the gains small.
struct ShadowGains {
  double speed = 0.0;        // [Nms/rad] K_p
  double position = 0.0;     // [Nm/rad] K_i
  double speed_window = 0.0;  // [s] m steps
  double tip_damping = 0.0;  // [Ns/m] D
  double leak_time = 0.0;    // [s] tau
  double first_offset = 0.0, offset_time = 0.0, first_slope = 0.0;  // [s] as in the settings
};
ShadowGains shadow_gains(const sim::Scales& nominal, const ShadowSettings& settings);

// The settings for records whose encoders are read every `period` [s]: an observer cannot be faster than its readings.
ShadowSettings not_faster_than(ShadowSettings settings, double period);

// Series on the record's grid.
struct Shadow {
  std::array<std::vector<double>, sim::kMaximumGroupCount> missing_torque;       // [Nm] per motor
  std::array<std::vector<double>, kAccelerometerCount> acceleration_difference;  // [m/s^2] measured - shadow
  std::vector<bool> contact_lost;  // some group of the shadow has its teeth apart
  std::vector<bool> house_let_go;  // all of them have
  std::vector<double> holding_torque;  // [Nm per motor] with which the teeth of that group are pressed that are pressed least; infinite without play
};

using GroupAngles = std::array<double, sim::kMaximumGroupCount>;  // [rad]
inline constexpr std::size_t kBeginningBends = 2;

// What only a record's beginning is like, beside what its first readings and torques say: the load hangs behind or before the tip as a
// constant acceleration has it, the boom is bent by it.
struct Beginning {
  double swing = 0.0, swing_rate = 0.0;  // [rad], [rad/s] of the load: rope and rod in one line
  double rod = 0.0, rod_rate = 0.0;      // [rad], [rad/s] of the rod alone, about the rope's end
  double outwards = 0.0, outward_rate = 0.0;  // [rad], [rad/s] of the load along the boom: sim::OutwardSwing
  GroupAngles motor_offset{};            // [rad] slew axis: how far each motor stands from where the machine has it
  // [-] of the lowest modes of boom and house, in what the rated torque would bend them by; rates in that times their angular frequency.
  std::array<double, kBeginningBends> bend{}, bend_rate{};
};

// `encoder_latency` [s] is how late (early, where negative) the encoders read. It, and a pure delay of the machine's encoders, are taken
// out of the record instead of put into the shadow, whose feedback they would shake.
// Throws std::invalid_argument where the machine cannot be built.
Shadow shadow(const sim::MachineSettings& machine, const Record& record, const ShadowGains& gains,
              double encoder_latency = 0.0, const Beginning& beginning = {});

// By the name of an effect that is a force or a friction: steps of the machine per step of the grid, at most. One that has no entry gets those of the
// settings.
using ForceSteps = std::map<std::string, int, std::less<>>;

// The grid of a record.
struct Grid {
  double step = 0.0;            // [s]
  std::size_t per_point = 1;    // commands per grid point
  bool takes_each = false;      // several, between encoders that are read at each point: what they bring the machine to there no mean of them does
  friend bool operator==(const Grid&, const Grid&) = default;
};
Grid grid_of(const Record& record);

// A machine that is to follow records on one grid: made once for all of them. Where an effect acts between two readings - on commands, on what
// the drives make of them, as a force or a friction - the machine takes steps of its own below the grid's, down to those of its settings; what acts on
// commands gets each of them, and so does every machine where several come between two readings.
struct Follower {
  sim::Machine machine;
  double encoder_delay = 0.0;  // [steps] of its own encoders; the machine itself has none
  int steps = 1;               // of the machine per step of the grid
  double to_slew_axis = 0.0;   // torque of a group there per torque of one motor
};
// `force_steps` as model_step.h has them. Throws as shadow().
Follower follower_of(const sim::MachineSettings& machine, const Grid& grid, const ForceSteps& force_steps = {});
// As many steps as the settings' go into one of the grid, at least 1.
int steps_of_the_settings(const sim::MachineSettings& machine, double step);
// Whether an effect is a force or a friction.
bool acts_by_force(std::string_view effect);

// [rad/s^2] slew axis, of all as one body under the torques of a grid point.
double rigid_acceleration(const sim::PlantModel& model, const Record& record, std::size_t point);

// [rad] slew axis: how far each motor stands before the house where its gear lies on the flank to which the torque of its group pushes at a grid
// point, wound up by what goes through it while the axis accelerates so, with `more_torque` [Nm] of each group, slew axis, that no command tells.
GroupAngles places_on_flanks(const sim::PlantModel& model, const Record& record, std::size_t point, double acceleration, const sim::GroupArray& more_torque = {});

// Where the shafts are at a record's first point and how fast they turn: of encoders that read late this is what they say later.
struct FirstReading {
  GroupAngles position{}, rate{};  // [rad], [rad/s] of the shafts
};
// Of encoders that are not late.
FirstReading first_reading(const Record& record);

// [Nm per motor] of each group at each grid point, where it acts until the next: at the motors, behind what drives and effects make of the commands, or all
// together on the house, where they wind no gear up.
struct MoreTorques {
  std::array<std::vector<double>, sim::kMaximumGroupCount> of_group;
  bool is_on_house = false;
};

// The follower on its way, a grid point after the other.
class Observer {
 public:
  // Begins as the record does, at its first point.
  Observer(Follower follower, const Record& record, const ShadowGains& gains, const Beginning& beginning = {});
  Observer(Follower follower, const Record& record, const FirstReading& first, const ShadowGains& gains, const Beginning& beginning);

  struct Measured {
    GroupAngles position{};  // [rad] of the shafts
    const double* tip_acceleration = nullptr;  // [m/s^2]; none: not measured
  };
  struct Moment {
    GroupAngles missing_torque{};                          // [Nm] per motor
    std::array<double, kAccelerometerCount> acceleration{};  // [m/s^2] of the observer itself
    bool contact_lost = false, house_let_go = true;
    double holding_torque = std::numeric_limits<double>::infinity();  // [Nm per motor]
  };
  // To the next grid point, under what the drives make of the commands.
  Moment advance(const sim::DriveCommand& command, const Measured& measured);

  // The same in parts, for who leads many machines at once: how it stands to what is measured, which says how the machine is led over the
  // next step; the step is the caller's.
  Moment compare(const Measured& measured);
  // Over the next step the machine gets that torque as well.
  void push(const MoreTorques& torques, std::size_t point);
  sim::Machine& machine() { return machine_; }
  int steps() const { return steps_; }  // of the machine per step of the grid

 private:
  sim::Machine machine_;
  int steps_;
  double to_slew_axis_, step_;
  ShadowGains gains_;
  std::size_t groups_;
  GroupAngles origin_{};  // [rad] of the shafts' positions
  std::vector<GroupAngles> past_error_;  // [rad] of the last m points, in turn
  double speed_window_ = 0.0;            // [s] m steps
  std::size_t oldest_ = 0;
  double leak_, forget_;
  // The tip's sensor may have an offset, which must not lead the shadow: at first what differs at rest, or turning evenly.
  std::size_t point_ = 0, first_;
  double tip_error_ = 0.0;   // [m/s]
  double tip_offset_ = 0.0;  // [m/s^2]
};

// What follows a record: the same into a result whose room is used again, with what the drives make of the record, which is the same for all
// machines.
struct Shadowing {
  Follower follower;
  double encoder_latency = 0.0;  // [s]
  Beginning beginning;
  Shadow* result = nullptr;
  std::vector<const MoreTorques*> more_torques = {};  // from the beginning on: where the gears are pressed then, they are under them
};
// Many side by side (machine_batch.h), each to the bit as alone.
void shadow(std::vector<Shadowing> shadowings, const Record& record, const DriveCourse& drives, const ShadowGains& gains);

}  // namespace slewlab::diagnosis
