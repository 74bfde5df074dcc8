#include "diagnosis/loop/loop_log.h"

namespace slewlab::diagnosis {
namespace {

// A new message of the channel, with its head.
template <class Message>
Message& next(std::vector<Message>& channel, std::int64_t time, const LoopCourse& course) {
  Message message{};
  message.sequence = static_cast<std::int64_t>(channel.size());
  message.simulated_time = time;
  message.configuration_hash = course.configuration_hash;
  message.run_identity = course.run_identity;
  return channel.emplace_back(message);
}

}  // namespace

LoopLog::LoopLog(const LoopCourse& course, sim::DrivenPlant& plant, const LogPeriods& periods, const ControllerAnswer* controller)
    : course_(course), plant_(plant), periods_(periods), controller_(controller) {
  log.configuration_hash = course.configuration_hash;
  log.run_identity = course.run_identity;
}

LoopHooks LoopLog::hooks() {
  add_series(0);
  LoopHooks hooks;
  hooks.operator_moved = [this](const msgs::Operator& move) { log.operator_moves.push_back(move); };
  hooks.answered = [this](const LoopMoment& moment) {
    log.encoder.push_back(moment.encoder);
    if (controller_ == nullptr) return;
    log.torque.push_back(controller_->torque());
    log.controller_state.push_back(controller_->state());
  };
  hooks.stepped = [this](const LoopMoment& moment) { add_series(moment.time); };
  return hooks;
}

void LoopLog::add_series(std::int64_t time) {
  if (time % periods_.sensors == 0) plant_.read_sensors(next(log.sensors, time, course_));
  if (time % periods_.truth == 0) plant_.read_truth(next(log.truth, time, course_));
  if (time % periods_.status == 0) plant_.read_status(next(log.plant_status, time, course_));
}

msgs::RunLog logged_run(const LoopSettings& settings, const LogPeriods& periods) {
  MachineLoop loop(settings);
  LoopLog recorder(loop.course, loop.plant, periods, &loop.controller);
  loop.run(recorder.hooks());
  return std::move(recorder.log);
}

}  // namespace slewlab::diagnosis
