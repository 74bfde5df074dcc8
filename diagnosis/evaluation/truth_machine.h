// The machine that withheld cases are measured on, and its run: controller, wire, drives, crane, sensors.
//
// The crane is integrated by SUNDIALS (sim/integrate/reference.h) on a finer mesh than the plant's; what it has
// besides the nominal crane comes as laws (law.h), which share no code with sim/effects. Drives, wire and sensors
// are computed apart from the integrator, every base step (1 ms); torques hold in between.
//
// Sensors: the motor encoders count (16384 a turn) and the drive makes a speed of the counts by a tracking loop of
// second order, 100 Hz, critically damped; controller and log see the same numbers. Accelerometers carry white and
// 1/f noise. The slew angle comes in counts.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/evaluation/law_scales.h"
#include "diagnosis/evaluation/structure.h"
#include "diagnosis/record.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/operator_move.h"
#include "sim/integrate/reference.h"

namespace slewlab::diagnosis::withheld {

inline constexpr double kBaseStep = 1e-3;     // [s]
inline constexpr std::int64_t kBaseStepNs = 1'000'000;  // the same [ns]
inline constexpr int kTruthElementCount = 16;  // boom elements; the nominal cranes of config/cranes have 6

using sim::GroupArray;

// What a law on the crane sees.
struct Scene {
  const sim::ReferenceMotion& motion;
  const sim::CraneParameters& crane;
  int group_count;
  double tip_radius;      // [m]
  double rope_stiffness;  // [N/m] M g / L of the small-angle rope that the reference holds; 0 without a load
};

struct ForceLaw {
  std::vector<double> start, scale;  // of its states, as in sim::ReferenceExtra
  std::function<void(const Scene&, const double* states, sim::ReferenceForces&, double* rates)> act;
};
using GearLaw = std::function<void(const Scene&, sim::ReferenceGears&)>;

// Torque per motor over the base step that begins at `time`; `shaft_angle` [rad] at its start.
using TorqueLaw = std::function<void(double time, const GroupArray& shaft_angle, const GroupArray& shaft_speed,
                                     GroupArray& torque)>;
// What is on its way to the drives: called every base step with the controller's newest command.
using WireLaw = std::function<void(double time, std::int64_t sequence, GroupArray& torque)>;
// Shaft positions [rad] before they are counted.
using EncoderLaw = std::function<void(double time, GroupArray& shaft_position)>;

using SensorValues = msgs::SensorReadings;
// `truth` lets a sensor law feel more than the motion: tilt, for one.
using SensorLaw = std::function<void(double time, const SensorValues& truth, SensorValues& seen)>;

struct EncoderCounting {
  double resolution = 3.8349519697141029e-4;  // [rad] of the motor, 2 pi / 16384: 14 bit, usual on crane drives
  double window = 0.0;                        // [s] 0: tracking loop; else counts of a window make the speed
};

struct NoiseSettings {
  double accelerometer = 0.005;     // [m/s^2] RMS of white and 1/f together, 0 ... 500 Hz; ordinary MEMS
  double flicker_share = 0.5;       // [-] of that variance in 1/f noise
  double slew_resolution = 2.4e-5;  // [rad] 18-bit encoder on the slew ring
};

struct TruthMachine {
  sim::CraneParameters crane;
  sim::DriveProtectionSettings drive_protection;  // of the drive between controller and wire; brakes are not modelled
  LawScales scales;  // of the nominal machine
  StructureChange structure;
  GroupArray inertia_share{}, stiffness_share{}, damping_share{};  // 1: as the crane says
  GroupArray added_half_play{};                                    // [rad] slew axis
  controller::ControllerSettings controller;
  std::vector<ForceLaw> forces;
  std::vector<GearLaw> gears;
  std::vector<WireLaw> wire;
  std::vector<TorqueLaw> torque;
  std::vector<EncoderLaw> encoder;
  std::vector<SensorLaw> sensors;
  EncoderCounting counting;
  NoiseSettings noise;
};

// With the scales of `crane` itself. Throws std::invalid_argument where it has none.
TruthMachine make_truth_machine(const sim::CraneParameters& crane, const controller::ControllerSettings& controller);

struct Request {
  double time = 0.0;           // [s]
  double speed_request = 0.0;  // [-]
};
struct Manoeuvre {
  std::vector<Request> requests;
  double duration = 0.0;  // [s]
};

struct RunOptions {
  std::uint64_t noise_seed = 0;
  sim::ReferenceOptions reference{.method = sim::ReferenceMethod::kDirk, .tolerance = 1e-6};
};

// One value per base step, the first at time 0. Encoder and torque: what the wire carries at each controller cycle.
struct TruthRun {
  int group_count = 0;
  std::int64_t cycle_steps = 1;  // base steps per controller cycle
  std::array<std::vector<double>, sim::kMaximumGroupCount> shaft_speed, shaft_position, motor_torque;  // per cycle
  std::array<std::vector<double>, sim::kMaximumGroupCount> true_speed;                                 // per cycle
  std::vector<bool> enable, brake;                                                                     // per cycle
  std::vector<SensorValues> sensors;                                                                   // per step
  std::vector<double> contact_change_times;  // [s] teeth that meet or part, to the base step
  Manoeuvre manoeuvre;
  sim::ReferenceCounts counts;
};

// The drive stops the machine, or the controller lets go of it: its loop does not hold.
struct DriveStopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What a withheld machine shows of itself: its sensors, and no truth.
class MeasuredPlant : public sim::DrivenPlant {
 public:
  void read_sensors(msgs::Sensors& message) override;
  void read_truth(msgs::Truth&) override {}
  void read_status(msgs::PlantStatus&) override {}
  const SensorValues& sensors() const { return seen_; }

 protected:
  SensorValues seen_;  // at the end of the step
};

// For whoever else runs a machine as a withheld one is run: the manoeuvre as the operator moves the lever, and what a cycle leaves in the run.
std::vector<sim::OperatorMove> moves_of(const Manoeuvre& manoeuvre);
void keep_cycle(const msgs::Encoder& encoder, const msgs::Torque& torque, const GroupArray& true_speed, TruthRun& run);

// The machine is copied: its laws start anew in each run. Throws DriveStopped, std::invalid_argument, std::runtime_error.
TruthRun run_truth(TruthMachine machine, const Manoeuvre& manoeuvre, const RunOptions& options);

}  // namespace slewlab::diagnosis::withheld
