// What goes into a plant step and what can be measured after it, apart from the step itself so that effects
// and controllers' tests need not know the model.
#pragma once

#include <array>
#include <slewlab_msgs/signals.hpp>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

using GroupArray = std::array<double, kMaximumGroupCount>;

// Forces that effects add, held over the step. All zero costs nothing and changes no bits.
struct PortForces {
  GroupArray motor_torque{};    // [Nm] on each group, slew axis
  double house_torque = 0.0;    // [Nm] on the house
  double tip_force = 0.0;       // [N] lateral, on the tip
  double uniform_force = 0.0;   // [N/m] lateral, evenly along the boom
  double load_force = 0.0;      // [N] lateral, on the lower end of the rope
  double rod_moment = 0.0;      // [Nm] on the rod
  double luffing = 0.0;         // [1/s^2] -2 (rate of the boom angle) (slewing speed): turns a luffing boom's masses back (crane_motion.h)
};

// Torques that oppose motion up to a level and hold at rest, found implicitly within the step.
struct FrictionLevels {
  GroupArray motor{};         // [Nm] of each group, slew axis
  double house_positive = 0;  // [Nm] of the slew bearing against positive speed
  double house_negative = 0;  // [Nm] against negative speed
};

struct PlantInput {
  GroupArray motor_torque{};  // [Nm] per motor of each group, on the fast axis, held over the step
  FrictionLevels friction;    // all zero: no friction is solved for
  PortForces ports;
};

// What pushes during a step or a part of it, on the slew axis.
struct Push {
  GroupArray motor;  // motors and ports, held
  double house;      // ports on the house, held
  double tip;        // ports on the tip, held
  double uniform;    // ports along the boom, held
  double luffing;    // port of a boom that luffs, held
  double load;
  double rod;
  FrictionLevels friction;
  bool has_friction;
};

// What can be measured at the end of a step; accelerations with the forces of that step. What is not at a motor is what
// SENSORS says of a machine (msgs/sensors_t.lcm).
struct PlantReadings : msgs::SensorReadings {
  GroupArray shaft_speed{};     // [rad/s] motor, fast axis
  GroupArray shaft_position{};  // [rad]
};

}  // namespace slewlab::sim
