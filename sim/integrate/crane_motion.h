// Hoisting, luffing and travelling while the crane slews: prescribed motions (sim/model/motion.h) and what they do to what slews.
//
// Hoisting: the rope is moving_rope() of sim/model/load.h.
// Travelling by the acceleration a along the track: in the frame of the pedestal every mass across the boom feels
//   -m a sin(direction of the track - slew angle);
// the house's centre of mass lies on the axis. Accelerometers read what moves in space: they get the base's part back.
// Luffing by the rate a' of the boom angle: a mass at x along the boom goes inwards with x sin(a) a', so that it takes the force
//   -2 (dr/dt) (slewing speed) across the boom (Coriolis), which on the whole rigid boom is the -dI/dt (slewing speed) of angular momentum;
// the load feels the same with the sheave's radius, and its rope the vertical acceleration of the sheave. The modes of the boom on its free
// house follow the angle step by step (luff()).
// Left out: what acts along the boom (offlead), the inertia of winch, luffing and travelling gear, and what they take from the drives.
#pragma once

#include <string_view>
#include <vector>

#include "sim/integrate/body_force.h"
#include "sim/integrate/plant.h"
#include "sim/model/luffing.h"
#include "sim/model/motion.h"

namespace slewlab::sim {

struct CraneMotion {
  bool moves = false;  // anything, ever; all else is only read where it does
  MotionProfile hoisting, luffing, travelling;
  CraneParameters crane;  // at the start
  BodyMasses masses;
  LuffingBoom boom;       // where it luffs
  LuffedBasis basis, next;  // of the state's modal coordinates, and room for the next
  Eigen::VectorXd deflection, deflection_rate;  // room
};

// Throws std::invalid_argument where the crane has no such motion, CannotBeBuilt where its boom cannot luff.
CraneMotion crane_motion(const CraneParameters& crane, const MotionRequests& requests);

// [m] from the sheave to the top of the load, [rad] of the boom, [m] of the pedestal along its track.
double rope_length(const CraneMotion& motion, double time);
double boom_angle(const CraneMotion& motion, double time);

// The crane as far as the motions' forces depend on it.
struct MotionMoment {
  double time = 0.0;             // [s]
  double house_angle = 0.0;      // [rad]
  double house_speed = 0.0;      // [rad/s]
  double rope_difference = 0.0;  // [m] lower end of the rope minus its top, across the boom
  double rod_angle = 0.0;        // [rad]
};
// All but a luffing boom's own (PortForces::luffing), which a plant step and the reference take in their own ways.
void add_motion_forces(const CraneMotion& motion, const MotionMoment& moment, PortForces& ports);
// [1/s^2] PortForces::luffing
double luffing_force(const CraneMotion& motion, double time, double house_speed);

// [m/s^2] What an accelerometer across the boom reads of the motions beside what moves in the pedestal's and the boom's frame. `place` as in
// msgs/sensors_t.lcm.
double motion_acceleration(const CraneMotion& motion, double time, double house_angle, double house_speed, std::string_view place);

// Gives the model the modes that luff() goes on with; before the first step.
void prepare_luffing(CraneMotion& motion, PlantModel& model);

// Takes model and state to another boom angle. Slew angle, deflection of the boom and swing of the load stay as they are, and so do their
// rates; the modal coordinates are those of the new modes. The kinetic energy that the changed inertia has at the same speed is the
// luffing gear's work. Allocates nothing.
void luff(CraneMotion& motion, double angle, PlantModel& model, PlantState& state);

}  // namespace slewlab::sim
