// Any text as a controller's file, beside those of config/: settings by which a controller answers, or problems that say where.

#include <cmath>
#include <stdexcept>

#include "common/input_error.h"
#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/msgs/example_messages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  static const fuzz::ConfigurationCopy configuration;
  static const std::filesystem::path path = configuration.path() / "controllers/fuzz.yaml";
  fuzz::write_file(path, data, size);
  try {
    const controller::ControllerFile file = controller::load_controller_file(path);
    const controller::Compute answer = controller::computed_answer(file.settings);
    const msgs::Encoder encoder = msgs::example::encoder();
    const msgs::Operator move = msgs::example::operator_move();
    msgs::Torque torque{};
    msgs::ControllerState state{};
    for (int i = 0; i < 20; ++i) answer(encoder, move, torque, state);
    fuzz::require(torque.motor_torque.size() == static_cast<std::size_t>(torque.group_count),
                  "TORQUE has as many torques as groups");
  } catch (const common::InputError&) {
  }
  return 0;
}
