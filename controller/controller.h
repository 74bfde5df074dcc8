// The slewing controller of thesis 3.5 as a pure function of settings, state and input: ramp, PI per motor
// group, play compensation, droop, limits, emergency stop. It knows nothing of messages or of the crane.
// A step allocates nothing and throws nothing.
//
// Speeds are requested on the slew axis; the PI works on the fast axis: shaft speed = slewing speed *
// total_ratio. All torques are per motor of a group.
//
// Play compensation: T_i = PI_i + (map_i(a) - a), a the mean of the groups' PI torques; the groups then share
// one integral (see share_integral in controller.cpp).
//
// Emergency stop: while pressed, and from then on, the speed follows a linear ramp to zero. The stop is
// latched: it ends only when the speed stands at zero, the button is released, the speed request is back
// at zero and the operator acknowledges, in this order or together; a request that is still there never
// sets the crane moving by itself. The motors hold it at zero speed; the disk brakes serve at power loss
// only (thesis 2.5) and are asked for only where a measurement is unusable.
//
// A shaft speed that is no finite number, a wrong number of groups, or a reading that plausibility.h calls
// unusable, cannot be controlled by: torque goes to zero at once, drives are disabled, the brakes are asked
// for, and the mode is waiting_for_acknowledgement.
#pragma once

#include <array>
#include <cstdint>

#include "controller/groups.h"
#include "controller/limits.h"
#include "controller/plausibility.h"
#include "controller/play_compensation.h"
#include "controller/ramp.h"
#include "controller/speed_control.h"

namespace slewlab::controller {

struct ControllerSettings {
  double period = 0.01;      // [s] between two steps
  int group_count = 2;       // motor groups
  double total_ratio = 1.0;  // [-] turns of the motor per turn of the crane
  double rated_torque = 0.0; // [N m] per motor, T100
  RampSettings ramp;
  SpeedControlSettings speed_control;
  PlayCompensationSettings play_compensation;
  TorqueLimits limits;
  PlausibilitySettings plausibility;
  double speed_filter_time = 0.0;  // [s] time constant on the measured speed; 0 is off
};

enum class Mode : std::int8_t {
  stopped = 0,
  running = 1,
  emergency_stop = 2,
  waiting_for_acknowledgement = 3,
};

struct ControllerState {
  Mode mode = Mode::stopped;
  bool unusable_measurement = false;  // why the controller waits: drives stay disabled until acknowledged
  bool started = false;               // a first measurement was taken
  RampState ramp;
  std::array<SpeedControlState, kMaximumGroups> speed_control{};
  PerGroup filtered_speed{};   // [rad/s]
  PerGroup commanded_torque{}; // [N m] per motor, of the step before
};

struct ControllerInput {
  std::int64_t simulated_time = 0;  // [ns]
  int group_count = 0;
  PerGroup shaft_speed{};      // [rad/s] on the fast axis
  bool unusable_reading = false;  // not to be controlled by, whatever the speeds say
  double speed_request = 0.0;  // [-] -1 ... 1 of top speed
  bool emergency_stop = false;
  bool acknowledge = false;
};

struct ControllerOutput {
  int group_count = 0;
  PerGroup motor_torque{};  // [N m] per motor of each group
  bool enable = false;
  bool brake = false;
  // The operator's acknowledgement, passed on to the drive with the joystick at zero alone: behind a drive that is enabled again while a
  // speed is asked for, the speed controller has wound up against the brakes.
  bool acknowledge = false;
  Mode mode = Mode::stopped;
  double ramped_speed = 0.0;    // [rad/s] on the slew axis
  double average_torque = 0.0;  // [N m] mean of the groups before the play compensation
  double offset_torque = 0.0;   // [N m] half the difference that the play compensation asks for
  PerGroup proportional_torque{};  // [N m] per motor
  PerGroup integral_torque{};      // [N m] per motor
};

void step(const ControllerSettings& settings, ControllerState& state, const ControllerInput& input,
          ControllerOutput& output);

}  // namespace slewlab::controller
