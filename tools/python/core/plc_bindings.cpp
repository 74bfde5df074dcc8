#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "tools/plc/plc_map.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

// The controller of a file, a step per call: what a soft PLC computes in its cycle.
class SteppedController {
 public:
  SteppedController(const std::filesystem::path& file, double period)
      : compute_(controller::computed_answer(settings_of(file, period))) {}

  // {signal of plc_map.h: value, or a list with one per motor group}
  nb::dict step(const msgs::Encoder& encoder, const msgs::Operator& operator_move) {
    controller::begin_answer(encoder, answers_++, torque_, state_);
    compute_(encoder, operator_move, torque_, state_);
    nb::dict said;
    said["motor_torque"] = torque_.motor_torque;
    said["enable"] = torque_.enable != 0;
    said["brake"] = torque_.brake != 0;
    said["acknowledge"] = torque_.acknowledge != 0;
    said["mode"] = static_cast<int>(state_.mode);
    said["ramped_speed"] = state_.ramped_speed;
    said["average_torque"] = state_.average_torque;
    said["offset_torque"] = state_.offset_torque;
    said["proportional_torque"] = state_.proportional_torque;
    said["integral_torque"] = state_.integral_torque;
    return said;
  }

 private:
  static controller::ControllerSettings settings_of(const std::filesystem::path& file, double period) {
    controller::ControllerSettings settings = controller::load_controller_file(file).settings;
    settings.period = period;
    return settings;
  }

  controller::Compute compute_;
  std::int64_t answers_ = 0;
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
};

nb::dict step(SteppedController& controller, std::int64_t sequence, double simulated_time, const std::vector<double>& shaft_speed,
              const std::vector<double>& shaft_position, double speed_request, bool emergency_stop, bool acknowledge) {
  constexpr double kNanosecondsPerSecond = 1e9;
  if (shaft_position.size() != shaft_speed.size()) throw nb::value_error("as many shaft positions as speeds are wanted");
  msgs::Encoder encoder{};
  encoder.sequence = sequence;
  encoder.simulated_time = std::llround(simulated_time * kNanosecondsPerSecond);
  encoder.group_count = static_cast<std::int32_t>(shaft_speed.size());
  encoder.shaft_speed = shaft_speed;
  encoder.shaft_position = shaft_position;
  msgs::Operator operator_move{};
  operator_move.speed_request = speed_request;
  operator_move.emergency_stop = emergency_stop;
  operator_move.acknowledge = acknowledge;
  return controller.step(encoder, operator_move);
}

nb::dict signal_of(const PlcSignal& signal) {
  nb::dict told;
  told["name"] = signal.name;
  told["group"] = signal.group;
  told["to_plc"] = signal.to_plc;
  told["at"] = signal.at;
  told["type"] = signal.type;
  told["scale"] = signal.scale;
  told["inverted"] = signal.inverted;
  told["area"] = std::string(name_of(signal.area));
  told["number"] = signal.number;
  told["bit"] = signal.bit;
  return told;
}

nb::dict map_of(const std::filesystem::path& file) {
  const PlcMap map = load_plc_map(file);
  nb::dict told;
  told["protocol"] = std::string(name_of(map.protocol));
  told["address"] = map.address;
  told["modbus_unit"] = map.modbus_unit;
  told["high_word_first"] = map.high_word_first;
  told["ams_net_id"] = map.ams_net_id;
  told["ams_port"] = map.ams_port;
  told["ticked"] = map.ticked;
  told["timeout"] = map.timeout;
  told["on_link_loss"] = std::string(name_of(map.on_link_loss));
  told["group_count"] = map.group_count;
  nb::list signals;
  for (const PlcSignal& signal : map.signals) signals.append(signal_of(signal));
  told["signals"] = signals;
  return told;
}

}  // namespace

void bind_plc(nb::module_& m) {
  m.def("load_plc_map", &map_of, nb::arg("path"), "The map of a file as a dictionary; InputError with every problem found.");
  nb::class_<SteppedController>(m, "SteppedController", "The controller of a file, a step per call.")
      .def(nb::init<const std::filesystem::path&, double>(), nb::arg("path"), nb::arg("period"))
      .def("step", &step, nb::arg("sequence"), nb::arg("simulated_time"), nb::arg("shaft_speed"), nb::arg("shaft_position"),
           nb::arg("speed_request"), nb::arg("emergency_stop"), nb::arg("acknowledge"), "{signal: value or values}");
}

}  // namespace slewlab::tools
