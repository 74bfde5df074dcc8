#include "controller/structured_text/st_answer.h"

#include <dlfcn.h>

#include <algorithm>
#include <stdexcept>

namespace slewlab::controller {
namespace {

template <typename Function>
Function function_in(void* handle, const char* name, const std::string& library) {
  void* const found = ::dlsym(handle, name);
  if (found == nullptr) {
    throw std::runtime_error(library + ": no function '" + name + "' in it, which controller/structured_text/st_program.h asks for");
  }
  return reinterpret_cast<Function>(found);
}

}  // namespace

// A path without a slash would be looked for where the system's own libraries are.
StProgram::StProgram(const std::filesystem::path& library)
    : handle_(::dlopen(std::filesystem::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL)), name_(library.string()) {
  if (handle_ == nullptr) throw std::runtime_error(::dlerror());
  try {
    start_ = function_in<decltype(start_)>(handle_, "slewlab_st_start", name_);
    cycle_ = function_in<decltype(cycle_)>(handle_, "slewlab_st_cycle", name_);
  } catch (...) {
    ::dlclose(handle_);
    throw;
  }
}

StProgram::~StProgram() { ::dlclose(handle_); }

void StProgram::start(std::int64_t period) const {
  if (const char* const problem = start_(period)) throw std::runtime_error(name_ + ": " + problem);
}

Compute st_answer(std::shared_ptr<const StProgram> program, std::int64_t period) {
  return [program = std::move(program), period, started = false, inputs = slewlab_st_inputs{}, outputs = slewlab_st_outputs{}](
             const msgs::Encoder& encoder, const msgs::Operator& operator_move, msgs::Torque& torque,
             msgs::ControllerState& report) mutable {
    if (!started) program->start(period);
    started = true;
    // What the wire's arrays hold beyond the program's is told by their number alone.
    const int groups = std::min<std::int32_t>(encoder.group_count, SLEWLAB_ST_GROUPS);
    inputs.simulated_time = encoder.simulated_time;
    inputs.reading_count = encoder.sequence;
    inputs.group_count = encoder.group_count;
    std::copy_n(encoder.shaft_speed.begin(), groups, inputs.shaft_speed);
    std::copy_n(encoder.shaft_position.begin(), groups, inputs.shaft_position);
    inputs.speed_request = operator_move.speed_request;
    inputs.emergency_stop = operator_move.emergency_stop != 0;
    inputs.acknowledge = operator_move.acknowledge != 0;
    program->cycle(inputs, outputs);
    torque.enable = outputs.enable != 0;
    torque.brake = outputs.brake != 0;
    torque.acknowledge = outputs.acknowledge != 0;
    torque.group_count = report.group_count = groups;
    torque.motor_torque.assign(outputs.motor_torque, outputs.motor_torque + groups);
    report.mode = static_cast<std::int8_t>(outputs.mode);
    report.ramped_speed = outputs.ramped_speed;
    report.average_torque = outputs.average_torque;
    report.offset_torque = outputs.offset_torque;
    report.proportional_torque.assign(outputs.proportional_torque, outputs.proportional_torque + groups);
    report.integral_torque.assign(outputs.integral_torque, outputs.integral_torque + groups);
  };
}

}  // namespace slewlab::controller
