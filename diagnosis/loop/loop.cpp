#include "diagnosis/loop/loop.h"

#include <cmath>
#include <stdexcept>

#include "controller/process/computed_answer.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kPeriodTolerance = 1e-9;  // [-] share by which the periods may miss each other: rounding

class Loop {
 public:
  Loop(const LoopCourse& course, sim::DrivenPlant& plant, const Answer& answer, const LoopHooks& hooks)
      : course_(course), plant_(plant), answer_(answer), hooks_(hooks) {}

  std::int64_t run() {
    for (; step_ < course_.steps; ++step_) {
      if (step_ % course_.steps_per_period == 0) {
        if (hooks_.stop && hooks_.stop()) return step_;
        talk();
      }
      tell(hooks_.instant);
      plant_.step({});
      if (hooks_.stepped) hooks_.stepped(moment(step_ + 1));
    }
    if (course_.ends_with_answer && step_ % course_.steps_per_period == 0) talk();
    tell(hooks_.instant);
    return step_;
  }

 private:
  LoopMoment moment(std::int64_t step) const { return {step, time_at(course_, step), encoder_, operator_}; }

  void tell(const std::function<void(const LoopMoment&)>& hook) const {
    if (hook) hook(moment(step_));
  }

  // What plant and controller say to each other at the start of a period.
  void talk() {
    const std::int64_t time = time_at(course_, step_);
    move_operator(time);
    encoder_.sequence = step_ / course_.steps_per_period;
    encoder_.simulated_time = time;
    encoder_.configuration_hash = course_.configuration_hash;
    encoder_.run_identity = course_.run_identity;
    encoder_.operator_sequence = operator_.sequence;
    plant_.read_encoder(encoder_);
    plant_.begin_cycle(encoder_.sequence);
    answer_(encoder_, operator_, plant_);
    tell(hooks_.answered);
  }

  // The moves that are due; at the first time in any case where the joystick stands.
  void move_operator(std::int64_t time) {
    const std::vector<sim::OperatorMove>& moves = course_.operator_moves;
    while (next_move_ < moves.size() && moves[next_move_].time <= time) say(moves[next_move_++], time);
    if (operator_.sequence < 0) say({}, time);
  }

  void say(const sim::OperatorMove& move, std::int64_t time) {
    ++operator_.sequence;
    operator_.simulated_time = time;
    operator_.configuration_hash = course_.configuration_hash;
    operator_.run_identity = course_.run_identity;
    operator_.speed_request = move.speed_request;
    operator_.emergency_stop = move.emergency_stop;
    operator_.acknowledge = move.acknowledge;
    if (hooks_.operator_moved) hooks_.operator_moved(operator_);
  }

  static msgs::Operator no_operator() {
    msgs::Operator none{};
    none.sequence = -1;
    return none;
  }

  const LoopCourse& course_;
  sim::DrivenPlant& plant_;
  const Answer& answer_;
  const LoopHooks& hooks_;
  std::int64_t step_ = 0;
  std::size_t next_move_ = 0;
  msgs::Operator operator_ = no_operator();
  msgs::Encoder encoder_{};
};

}  // namespace

std::int64_t time_at(const LoopCourse& course, std::int64_t step) {
  return std::llround(static_cast<double>(step) * course.plant_step * kNanosecondsPerSecond);
}

sim::DriveRun drive_run(const LoopCourse& course, int group_count) {
  return {group_count, course.configuration_hash, time_at(course, course.steps_per_period), course.run_identity};
}

std::int64_t run_loop(const LoopCourse& course, sim::DrivenPlant& plant, const Answer& answer, const LoopHooks& hooks) {
  return Loop(course, plant, answer, hooks).run();
}

ControllerAnswer::ControllerAnswer(const controller::ControllerSettings& settings)
    : compute_(controller::computed_answer(settings)) {}

void ControllerAnswer::operator()(const msgs::Encoder& encoder, const msgs::Operator& operator_move,
                                  sim::DrivenPlant& plant) {
  controller::begin_answer(encoder, answers_, torque_, state_);
  compute_(encoder, operator_move, torque_, state_);
  ++answers_;
  plant.receive(msgs::DecodeStatus::ok, torque_);
}

LoopCourse course_of(const LoopSettings& settings) {
  const double share = settings.controller.period / settings.machine.step;
  const double whole = std::round(share);
  if (!(whole >= 1.0) || std::fabs(share - whole) > kPeriodTolerance * whole) {
    throw std::invalid_argument("the controller's period must be a whole multiple of the plant's step");
  }
  LoopCourse course;
  course.plant_step = settings.machine.step;
  course.steps_per_period = static_cast<std::int64_t>(whole);
  course.steps = std::llround(settings.duration / settings.machine.step);
  course.operator_moves = settings.operator_moves;
  return course;
}

MachineLoop::MachineLoop(const LoopSettings& settings)
    : course(course_of(settings)),
      plant(settings.machine, drive_run(course, settings.machine.crane.drive.group_count)),
      controller(settings.controller) {}

std::int64_t MachineLoop::run(const LoopHooks& hooks) { return run_loop(course, plant, std::ref(controller), hooks); }

}  // namespace slewlab::diagnosis
