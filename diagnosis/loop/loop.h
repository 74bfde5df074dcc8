// Machine, drive and controller in one process on a virtual clock: what plant and controller say to each other in
// lockstep (sim/drive/lockstep_loop.h), message for message and bit for bit, without bytes on a bus. What simulates a
// machine under a controller runs it with this.
//
// At every controller period, in this order: the operator's moves that are due, ENCODER, what arrives on TORQUE, then
// the plant's steps to the next period. Between TORQUE and the machine stands the drive with its protection, on the
// plant's side of DrivenPlant: its limits, its brakes, what it makes of sequence numbers, the alive counter and silence.
//
// The plant is whatever steps under torque: CranePlant (the fixed step) or any other. What answers may be the
// controller, a recorded log, a torque of time alone. Same inputs, same bits. After the first period nothing is
// allocated but by plant, answer and hooks themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "controller/controller.h"
#include "controller/process/answer_loop.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/operator_move.h"

namespace slewlab::diagnosis {

// When things happen.
struct LoopCourse {
  double plant_step = 1e-3;           // [s]
  std::int64_t steps_per_period = 1;  // plant steps from one ENCODER to the next
  std::int64_t steps = 0;             // plant steps of the run
  // Whether a period that begins where the run ends has its ENCODER and answer. The lockstep's has not.
  bool ends_with_answer = false;
  // By rising time. A move takes effect at the first controller period that begins at its time or later.
  std::vector<sim::OperatorMove> operator_moves;
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;  // every message carries it (msgs/run_identity.h)
};

// [ns] Simulated time after so many plant steps.
std::int64_t time_at(const LoopCourse& course, std::int64_t step);

// What the drive knows of the run.
sim::DriveRun drive_run(const LoopCourse& course, int group_count);

struct LoopMoment {
  std::int64_t step;  // plant steps done
  std::int64_t time;  // [ns] simulated
  const msgs::Encoder& encoder;         // the newest
  const msgs::Operator& operator_move;  // the newest
};

// Where the loop stands, for whoever samples, shows progress, or wants it to end. Each may be empty.
struct LoopHooks {
  std::function<void(const msgs::Operator&)> operator_moved;
  std::function<void(const LoopMoment&)> answered;  // ENCODER is out, and the drive has what came on TORQUE
  std::function<void(const LoopMoment&)> instant;   // before every step, behind `answered`, and at the end of the run
  std::function<void(const LoopMoment&)> stepped;   // behind every step, before the next ENCODER
  std::function<bool()> stop;                       // asked once a period
};

// Hands the drive what arrives on TORQUE after this ENCODER: nothing, one message, or several.
using Answer = std::function<void(const msgs::Encoder&, const msgs::Operator&, sim::DrivenPlant&)>;

// Answers with the plant steps done: fewer than asked for where `stop` said so.
std::int64_t run_loop(const LoopCourse& course, sim::DrivenPlant& plant, const Answer& answer, const LoopHooks& hooks);

// The controller as its process answers.
class ControllerAnswer {
 public:
  explicit ControllerAnswer(controller::Compute compute) : compute_(std::move(compute)) {}
  explicit ControllerAnswer(const controller::ControllerSettings& settings);

  void operator()(const msgs::Encoder& encoder, const msgs::Operator& operator_move, sim::DrivenPlant& plant);

  const msgs::Torque& torque() const { return torque_; }          // the newest
  const msgs::ControllerState& state() const { return state_; }  // the newest

 private:
  controller::Compute compute_;
  std::int64_t answers_ = 0;
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
};

// A whole machine under its controller.
struct LoopSettings {
  sim::MachineSettings machine;               // with its effects, its drive's protection, the plant's step and the seed
  controller::ControllerSettings controller;  // with_effects() lays a controller's effects over it
  std::vector<sim::OperatorMove> operator_moves;
  double duration = 0.0;  // [s] rounded to whole plant steps
};

// Throws std::invalid_argument where the controller's period is no whole multiple of the plant's step.
LoopCourse course_of(const LoopSettings& settings);

struct MachineLoop {
  // Throws std::invalid_argument where the machine cannot be built or the periods do not fit.
  explicit MachineLoop(const LoopSettings& settings);

  std::int64_t run(const LoopHooks& hooks);

  LoopCourse course;
  sim::CranePlant plant;
  ControllerAnswer controller;
};

}  // namespace slewlab::diagnosis
