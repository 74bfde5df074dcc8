// A machine: the crane's plant with what the thesis left out, one step at a time. What the plant process,
// the checks and the diagnosis run.
//
// One step: message path (delay, jitter, loss) -> actuator path (dead time, lag, limit, ripple) -> forces and
// frictions of effects at the middle of the step -> plant step -> sensor path. Effects act in the order of
// the settings within each part. Without effects a step is the plant's step, bit for bit, and nothing else
// is evaluated. step() allocates nothing and throws nothing.
//
// A copy of a machine runs on as the original would. `state` may be set by hand between steps (refresh() of
// plant.h afterwards, then forget_past()); effects keep their memory, but for what begin_effects() tells them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/effects/effect.h"
#include "sim/integrate/crane_motion.h"
#include "sim/integrate/plant.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::sim {

using MachineReadings = PlantReadings;

// Owns a running effect; copying clones it.
class EffectHandle {
 public:
  explicit EffectHandle(std::unique_ptr<RunningEffect> effect) : effect_(std::move(effect)) {}
  EffectHandle(const EffectHandle& other) : effect_(other.effect_->clone()) {}
  EffectHandle& operator=(const EffectHandle& other) {
    if (this != &other) effect_ = other.effect_->clone();
    return *this;
  }
  EffectHandle(EffectHandle&&) noexcept = default;
  EffectHandle& operator=(EffectHandle&&) noexcept = default;
  ~EffectHandle() = default;

  RunningEffect* operator->() const { return effect_.get(); }

 private:
  std::unique_ptr<RunningEffect> effect_;
};

struct Machine {
  PlantModel model;
  PlantState state;
  PlantWorkspace workspace;

  std::vector<EffectHandle> effects;
  // Which of them use each port, in the order of the settings.
  std::vector<std::size_t> message, actuator, force, friction, sensor;
  // By effect: whether it acts, and its name where that can be switched while the machine runs (it changes no parameter).
  std::vector<char> is_on;
  std::vector<std::string> switchable;
  struct Switch {
    std::int64_t step;  // from which on
    std::size_t effect;
    bool on;
  };
  std::vector<Switch> switches;  // by rising step
  std::size_t next_switch = 0;
  bool needs_moment = false;            // any of actuator, force, friction
  // What effects are told: of the last two steps' ends, the newest one and the other, and of the middle of the step. Kept where `needs_moment`,
  // true where `has_past`: since the first step, or the first one after forget_past().
  bool has_past = false;
  std::size_t newest = 0;
  std::array<EffectMoment, 2> ends;
  EffectMoment middle;
  DriveCommand arrived;                 // at the drives in the last step, kept where there is a message path
  PlantInput input;                     // of the last step, where step() made it
  bool has_acceleration = false;        // `acceleration` is that of the last step's end
  Accelerations acceleration;
  MachineReadings sensed;               // kept only where a sensor effect is on or the crane moves otherwise than slewing
  GroupArray applied_torque{};          // [Nm] per motor of the last step, behind the actuator path
  CraneMotion motion;                   // hoisting, luffing, travelling
  int steps_per_boom_angle = 10;
  PortForces steady;                    // what the effects' forces are on a machine that stands, at the beginning
  PortForces outside;                   // from outside the model, held over each step: how an observer is led; zero otherwise
  double started_at = 0.0;              // [s] as the settings have it
  std::int64_t hooks_per_step = 0;
  std::int64_t effect_evaluations = 0;  // hooks called since the start
};

// At rest, gears in the middle of their play, the load where steady forces of effects (heel, wind) hold it.
// Throws std::invalid_argument: unknown effect, value out of bounds, an effect twice, a crane that cannot be
// built.
Machine make_machine(const MachineSettings& settings);

// What the effects make of the crane, before assembly.
MachineParameters machine_parameters(const MachineSettings& settings);

void step(Machine& machine, const DriveCommand& command);

// The same in parts, for who steps many plants at once (machine_batch.h): what goes into the plant's step, all of it written anew; and after
// the step, with the state and the accelerations of its end, the sensors.
void begin_step(Machine& machine, const DriveCommand& command, PlantInput& input);
void end_step(Machine& machine);

// From the next step on; an effect that is off keeps its memory. False where the machine has none of that name that can be switched.
bool switch_effect(Machine& machine, std::string_view name, bool on);

// What the wire says at the end of the last step.
MachineReadings read(const Machine& machine);

// [rad] beta_1 at the rope's length of the moment.
double rope_angle(const Machine& machine);

// [s] on the clock of effects and motions
double time_of(const Machine& machine);

// A machine that has not begun yet, its load hanging where the steady forces of its effects (heel, wind) hold it where its house stands: make_machine() has done so at 0.
void rest_under_steady_forces(Machine& machine);

// Tells its effects that it begins in the motion that its state has; of the load outwards as OutwardSwing says (effects/effect.h) [rad], [rad/s].
void begin_effects(Machine& machine, double outwards, double outward_rate);

// Tells the machine that its state was set by hand: the next step extrapolates from it alone.
void forget_past(Machine& machine);

}  // namespace slewlab::sim
