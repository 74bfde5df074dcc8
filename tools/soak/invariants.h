#pragma once

// What must hold in every run, whatever is slewed: checked on the plant's state after every step and on every message
// of the log. docs/soak.md lists the equations, the bounds and where they come from, and what a fault on purpose
// changes. Each check is a function of plain records, so that a doctored record shows that it would notice.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "msgs/codec.h"
#include "sim/drive/drive_protection.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/fault.h"
#include "sim/integrate/plant_ports.h"
#include "sim/model/gear.h"
#include "tools/soak/settings.h"

namespace slewlab::tools {

enum class Invariant {
  finite,          // every number of the state and of the messages
  energy_balance,  // E(t) = E(0) + W(t) - D(t)
  torque_limit,    // what the motors get is what the drive allows
  torque_rate,     // and changes no faster than the drive allows
  speed_limit,
  angle_limit,
  contact_law,     // teeth push and never pull; no torque inside the play
  friction_law,    // brakes oppose motion
  sequence,        // numbers rise by one
  clock,           // simulated time = number * period
  drive_state,     // only the arrows of docs/drive.md
  untroubled,      // without a fault on purpose the drive sees none
  answered,        // the controller answers
  finished,        // the run comes to its end
  memory,          // does not grow
};
inline constexpr std::array kInvariantNames{
    "finite",       "energy_balance", "torque_limit", "torque_rate", "speed_limit", "angle_limit", "contact_law",
    "friction_law", "sequence",       "clock",        "drive_state", "untroubled",  "answered",    "finished",
    "memory"};
inline constexpr int kInvariantCount = static_cast<int>(kInvariantNames.size());

inline const char* name_of(Invariant invariant) { return kInvariantNames[static_cast<std::size_t>(invariant)]; }

struct Violation {
  Invariant invariant = Invariant::finite;
  std::int64_t time = 0;    // [ns] simulated, of the first
  std::int64_t count = 0;   // how often it was seen
  std::string what;         // the first, with values and units
};

// The first violation of each invariant, in the order in which they came.
class Findings {
 public:
  void add(Invariant invariant, std::int64_t time, std::string_view what);
  const std::vector<Violation>& violations() const { return violations_; }
  bool empty() const { return violations_.empty(); }

 private:
  std::vector<Violation> violations_;
};

// What the checks know of the run beforehand.
struct SoakFacts {
  int group_count = 0;
  int motors_per_group = 0;
  double ratio = 1.0;  // motor turns per turn of the crane
  double step = 0.0;   // [s]
  std::array<sim::GearContact, sim::kMaximumGroupCount> gear{};
  double axis_energy = 0.0;  // [J] of all that turns with the axis, at top speed
  double top_speed = 0.0;    // [rad/s] of the axis
  sim::DriveProtectionSettings protection;
  bool bare_actuators = true;   // no effect of the crane's file stands between drive and motors
  bool bare_brakes = true;      // no effect adds friction to the motors

  std::int64_t configuration_hash = 0;
  std::int64_t controller_period = 0, sensors_period = 0, truth_period = 0, status_period = 0;  // [ns]
  std::int64_t plant_step = 0;                                                                  // [ns]

  // What faults on purpose are scheduled, and so which checks stay silent.
  bool faults = false;              // any: `untroubled` is off
  bool torque_altered = false;      // TORQUE lost, late, twice, corrupted or from a controller that comes and goes
  bool encoder_unusable = false;    // ENCODER says NaN on purpose
  bool encoder_untrue = false;      // ENCODER says what is not so: the controller may drive the crane as far as the drive lets it
  struct Untrue {
    std::int64_t from = 0, until = 0;  // [ns]
  };
  std::vector<Untrue> untrue_encoders{};  // when it does
  bool encoder_corrupted = false;   // ENCODER's bytes are changed
  bool controller_restarts = false;
};

// What the faults change.
void take_faults(const std::vector<sim::Fault>& faults, SoakFacts& facts);

// The plant at the end of a step. Angles, speeds and torques of the groups on the slew axis unless they say otherwise.
struct StepRecord {
  std::int64_t time = 0;  // [ns]
  double state_sum = 0.0;  // sum over all modal coordinates and rates: not finite where one of them is not
  sim::GroupArray motor_angle{}, motor_speed{}, gear_torque{}, motor_friction{};
  std::array<int, sim::kMaximumGroupCount> contact{};
  std::array<std::int64_t, sim::kMaximumGroupCount> play_crossings{};
  std::int64_t contact_changes = 0;
  std::int64_t unsplit_steps = 0;
  std::int64_t unsolved_frictions = 0;
  double house_angle = 0.0, house_speed = 0.0;
  double rope_angle = 0.0, rod_angle = 0.0;
  double mechanical_energy = 0.0, supplied_work = 0.0;  // [J]
  double dissipated_power = 0.0;                        // [W] in gears and rope at this instant
  double dissipated_by_modes = 0.0;                     // [J] in boom and house since the start

  sim::GroupArray applied_torque{};    // [Nm] per motor on the fast axis, during the step
  sim::GroupArray commanded_torque{};  // [Nm] the same, as the drive holds it
  std::int64_t answered_sequence = 0;  // of the command held
  double brake_torque = 0.0;           // [Nm] per motor on the fast axis
  sim::PlantConditions conditions;     // during the step
  sim::DriveState drive_state = sim::DriveState::ready;
  sim::DriveFault trip_cause = sim::DriveFault::none;
};

void check_finite(const SoakFacts& facts, const StepRecord& record, Findings& findings);
void check_torque_limit(const SoakFacts& facts, const StepRecord& record, Findings& findings);
void check_torque_rate(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings);
void check_speed(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& record, Findings& findings);
void check_angles(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& record, Findings& findings);
void check_contact(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings);
void check_friction(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings);
// Between two looks at the drive: one message (`by_message`) or one step apart.
void check_drive(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, bool by_message,
                 Findings& findings);

// E(t) - E(0) = W(t) - D(t), D by the trapezoidal rule over the steps' ends. The error is measured against the energy
// turned over so far: E(0) + sum |dW| + D. Where a contact is made or lost inside a step the steps' ends do not tell how
// long its damper acted: at most h c (motor speed - house speed)^2, summed up and granted to the error.
class EnergyBalance {
 public:
  // `first` is the state before the first step.
  EnergyBalance(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& first);
  void check(const StepRecord& record, Findings& findings);
  double largest_error() const { return largest_error_; }  // [-] of the energy turned over

 private:
  const SoakFacts& facts_;
  double limit_;
  double first_energy_;
  double first_work_;
  StepRecord before_;
  double dissipated_ = 0.0;  // [J]
  double unseen_ = 0.0;      // [J]
  double turned_over_;       // [J]
  double largest_error_ = 0.0;
};

// Every message in the order of the log, as bytes.
class MessageInvariants {
 public:
  explicit MessageInvariants(const SoakFacts& facts) : facts_(facts) {}
  void look(std::string_view channel, std::int64_t timestamp_us, msgs::Bytes bytes, Findings& findings);

 private:
  struct Row {
    std::int64_t next = 0;  // sequence number that is due
  };
  template <class Message>
  bool take_head(const Message& message, const char* channel, Row& row, Findings& findings);
  void look_at(const msgs::Torque& torque, msgs::DecodeStatus status, Findings& findings);
  void look_at(const msgs::ControllerState& state, Findings& findings);
  void look_at(const msgs::PlantStatus& status, Findings& findings);

  const SoakFacts& facts_;
  std::int64_t stamp_us_ = 0;
  Row encoder_row_, operator_row_, sensors_row_, truth_row_, status_row_, torque_row_, state_row_;
  std::int64_t alive_counter_ = -1;
  std::int64_t answered_by_state_ = -1;
  msgs::Encoder encoder_{};
  msgs::Operator operator_{};
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
  msgs::Sensors sensors_{};
  msgs::Truth truth_{};
  msgs::PlantStatus status_{};
  msgs::PlantStatus last_status_{};
};

// Memory in use by this process [kB]: what is allocated, and what the operating system has given. Zero under the
// address and thread sanitizers, which keep what is freed.
struct MemoryUse {
  std::int64_t heap = 0;
  std::int64_t resident = 0;
};
MemoryUse memory_use();

// `what` says since when, e.g. "since task 5 of this worker".
void check_memory(const SoakLimits& limits, const MemoryUse& before, const MemoryUse& now, std::string_view what,
                  std::int64_t time, Findings& findings);

}  // namespace slewlab::tools
