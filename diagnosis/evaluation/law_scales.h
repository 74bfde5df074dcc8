// What the withheld laws' sizes are multiples of: scales of the nominal machine (sim/machine/scales.h), of its modes, boom
// and load, and of the ramp that it is driven with. A size drawn for one machine then stands to its torques, speeds and
// times as the same draw does for any other, so that machines of any size are drawn with effects of like visibility.
//
//   masses and forces times f: every force, torque, stiffness and mass below times f, the wind's speed times sqrt(f)
//   lengths times lambda, times with sqrt(lambda): times by sqrt(lambda), the rest by their dimensions
//
// Assumption: the wind's areas follow from boom and load alone.
#pragma once

#include "controller/controller.h"
#include "sim/machine/scales.h"

namespace slewlab::diagnosis::withheld {

struct LawScales {
  sim::Scales machine;
  double period = 0.0;             // [s] of the first structural mode; the acceleration time where nothing bends
  double ramp_time = 0.0;          // [s] the controller's, from rest to top speed
  double stretch = 1.0;            // [-] of all times of the manoeuvres, and of what happens in them
  double top_shaft_speed = 0.0;    // [rad/s] of the motors
  double gear_stiffness = 0.0;     // [Nm/rad] of all gearboxes, on the slew axis
  double group_share = 1.0;        // [-] one over the number of motor groups
  double gearbox_stiffness = 0.0;  // [Nm/rad] of one, on its outgoing shaft
  double wind_up = 0.0;            // [rad] of the gears under the rated torque, on the slew axis
  double drive_pedestal = 0.0;     // [N/m] the gears' stiffness at the reach
  double tip_force = 0.0;          // [N] that the rated torque is at the reach
  double tip_speed = 0.0;          // [m/s] at top speed
  double inertia_factor = 0.0;     // [-] axis_inertia of the house's own
  double buckling_force = 0.0;     // [N] thesis (2.16), from the boom's mean section
  double guy = 0.0;                // [N/m^3] cubic stiffness that balances tip_force at the deflection it gives the boom
  double boom_length = 0.0;        // [m]
  double boom_area = 0.0;          // [m^2] that drags in the wind
  double load_area = 0.0;          // [m^2]
  double wind_speed = 0.0;         // [m/s] at which the wind on the boom is tip_force
  double drag_area = 0.0;          // [m^2] on which a wind of sqrt(g reach) makes tip_force
  double wave_time = 0.0;          // [s] sqrt(reach / g): how waves' periods go with the size of what they move
  double sideways_stiffness = 0.0; // [N/m] axis_inertia at the reach over acceleration_time squared
  double load_weight = 0.0;        // [N]
  double rope_length = 0.0;        // [m]
  double rope_stiffness = 0.0;     // [N/m] sideways, weight / length, as the small-angle rope has it
  double swing_time = 0.0;         // [s] sqrt(rope length / g)
};

// Throws std::invalid_argument where the machine has no scales.
LawScales law_scales(const sim::CraneParameters& nominal, const controller::ControllerSettings& controller);

inline constexpr double kAirDensity = 1.225;  // [kg/m^3] sea level, 15 degrees C, standard atmosphere

// Ramp for which the times of manoeuvres are written (draw.cpp): `stretch` is 1 there. Chosen.
inline constexpr double kWrittenForRamp = 4.4;  // [s]

}  // namespace slewlab::diagnosis::withheld
