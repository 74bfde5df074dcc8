// How an effect acts on a machine: through a change of parameters before assembly, and through hooks that
// the machine calls in every step. A hook is only called where the description lists its port.
//
// State-dependent forces and frictions are evaluated at the MIDDLE of the step: the machine estimates the
// crane's state there from this step's start and the one before (angles x + h v / 2, all else
// 3/2 now - 1/2 before). Held over the step, such a force is right to second order in the step, whatever its
// law, as long as it is smooth. Where a law jumps (contact) the order is one over that step.
//
// Hooks allocate nothing and throw nothing. An effect with no hook costs nothing in a step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/effect.h"
#include "sim/integrate/plant_ports.h"
#include "sim/integrate/machine_settings.h"
#include "sim/model/crane_parameters.h"
#include "sim/model/gear.h"

namespace slewlab::sim {

struct PlantModel;

enum class EffectPort { parameters, message, actuator, force, friction, sensor };

// What the machine is assembled from. Gears and inertias per group, on the slew axis; the gears' damping is
// the nominal crane's: material keeps its damping when something else changes.
struct MachineParameters {
  CraneParameters crane;
  GroupArray group_inertia{};  // [kg m^2]
  std::array<GearContact, kMaximumGroupCount> gear{};
};

// The crane in the middle of the step; slew axis, lateral quantities as in PlantState.
struct EffectMoment {
  double time = 0.0;                // [s]
  double step = 0.0;                // [s]
  GroupArray motor_angle{};         // [rad]
  GroupArray motor_speed{};         // [rad/s]
  GroupArray gear_torque{};         // [Nm] on the house
  double house_angle = 0.0;         // [rad]
  double house_speed = 0.0;         // [rad/s]
  double house_acceleration = 0.0;  // [rad/s^2]
  double tip_displacement = 0.0;    // [m]
  double tip_velocity = 0.0;        // [m/s]
  double boom_acceleration = 0.0;   // [m^2/s^2] integral of the lateral acceleration along the boom
  double load_displacement = 0.0;   // [m] of the rope's lower end
  double load_velocity = 0.0;       // [m/s]
  double rope_angle = 0.0;          // [rad]
  double rod_angle = 0.0;           // [rad]
  double rod_rate = 0.0;            // [rad/s]
  double rope_force = 0.0;          // [N] on the tip
};

// The crane at the end of the step, before any sensor.
struct SensorMoment {
  double time = 0.0;         // [s]
  double house_angle = 0.0;  // [rad]
  double house_speed = 0.0;  // [rad/s]
  PlantReadings truth;
};

// How the load swings outwards where a machine begins in motion, rope and rod in one line: about where it hangs on a house that turns evenly.
struct OutwardSwing {
  double house_speed = 0.0;       // [rad/s]
  double angle = 0.0, rate = 0.0;  // [rad], [rad/s]
};

// An effect at work in one machine. Copies of a machine copy it.
class RunningEffect {
 public:
  virtual ~RunningEffect() = default;
  virtual std::unique_ptr<RunningEffect> clone() const = 0;

  virtual void begin(const OutwardSwing&) {}

  // `time` [s] of the step's start; `command` is replaced by what arrives at the drives.
  virtual void message(double /*time*/, DriveCommand& /*command*/) {}
  // Torque per motor on the fast axis, mean over the step.
  virtual void actuator(const EffectMoment&, GroupArray& /*motor_torque*/) {}
  virtual void force(const EffectMoment&, PortForces&) {}
  virtual void friction(const EffectMoment&, FrictionLevels&) {}
  virtual void sensor(const SensorMoment&, PlantReadings&) {}
};

// Gives an effect its clone().
template <class Effect>
class Running : public RunningEffect {
 public:
  std::unique_ptr<RunningEffect> clone() const override {
    return std::make_unique<Effect>(static_cast<const Effect&>(*this));
  }

 private:
  Running() = default;
  friend Effect;  // and no other class, whose clone() would be of the wrong one
};

// What an effect may know when it starts.
struct EffectStart {
  common::EffectValues values;
  const PlantModel& model;
  const common::EffectScales& scales;  // of the nominal machine
  std::uint64_t seed;                  // its own

  double value(std::string_view parameter) const { return values[parameter]; }
};

struct EffectDescription {
  common::EffectAbout about;  // numbers as multiples of a machine's scales (common/effect.h)
  std::vector<EffectPort> ports;
  // Throws CannotBeBuilt where the values do not fit the crane.
  void (*change)(const common::EffectValues&, MachineParameters&) = nullptr;
  std::unique_ptr<RunningEffect> (*start)(const EffectStart&) = nullptr;
};

// +1 for the first half of the groups, -1 for the last, 0 for the middle one: the pattern of uneven drives.
double group_side(int group, int group_count);

}  // namespace slewlab::sim
