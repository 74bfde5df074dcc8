#include "diagnosis/discriminate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "common/unit.h"
#include "diagnosis/prediction.h"
#include "sim/machine/description.h"

namespace slewlab::diagnosis {

// Chosen: at full speed the machine turns for as long as it accelerates, and swings as long before it turns back.
const std::vector<Manoeuvre>& usual_manoeuvres() {
  static const std::vector<Manoeuvre> kManoeuvres{
      {"a slew there and back at half speed", {{0.23, 0.5}, {2.5, 0.0}, {3.64, -0.5}, {5.45, 0.0}}},
      {"a slew there and back at full speed", {{0.23, 1.0}, {2.5, 0.0}, {3.64, -1.0}, {5.45, 0.0}}},
      {"inching", {{0.23, 0.5}, {0.68, 0.0}, {1.14, -0.5}, {1.59, 0.0}, {2.05, 0.5}, {2.5, 0.0}, {2.95, -0.3}, {3.41, 0.0}, {3.86, 0.3}, {4.32, 0.0}}},
      {"a reversal at full speed without a stop", {{0.23, 1.0}, {2.5, -1.0}, {5.0, 0.0}}}};
  return kManoeuvres;
}

Record blank_record(const Manoeuvre& manoeuvre, const controller::ControllerSettings& controller, double machine_step) {
  const double ramp = controller.ramp.acceleration_time;
  Record record;
  record.name = manoeuvre.name;
  record.step = controller.period / std::max(1.0, std::round(controller.period / machine_step));
  record.encoder_period = controller.period;
  record.group_count = controller.group_count;
  const auto size = static_cast<std::size_t>(std::lround(kManoeuvreDuration * ramp / record.step));
  for (int g = 0; g < record.group_count; ++g) {
    record.motor_torque[static_cast<std::size_t>(g)].assign(size, 0.0);
    record.shaft_speed[static_cast<std::size_t>(g)].assign(size, 0.0);
  }
  for (const SpeedRequest& request : manoeuvre.requests) {
    record.operator_moves.push_back({std::llround(request.time * ramp * 1e9), request.speed, false, false});
  }
  return record;
}

std::map<std::string, double, std::less<>> noise_floors(const sim::MachineDescription& machine, const controller::ControllerSettings& controller) {
  std::map<std::string, double, std::less<>> floors;
  for (const sim::Sensor& sensor : machine.sensors) {
    double& floor = floors[std::string(common::name_of(sensor.unit))];
    floor = std::max(floor, sensor.noise_floor);
  }
  floors["Nm"] = controller.speed_control.proportional_gain * floors["rad/s"];
  return floors;
}

std::vector<Separation> separations(const sim::MachineSettings& one, const sim::MachineSettings& other,
                                    const controller::ControllerSettings& controller) {
  const auto floors = noise_floors(sim::describe(one.crane), controller);
  std::vector<Separation> all;
  for (const Manoeuvre& manoeuvre : usual_manoeuvres()) {
    const Record blank = blank_record(manoeuvre, controller, one.step);
    const Record a = predict(one, controller, blank).series;
    const Record b = predict(other, controller, blank).series;
    std::vector<SignalGap> gaps = signal_gaps(a, b);
    gaps.push_back(gap_between("slew angle", "rad", a.slew_angle, b.slew_angle));
    for (const SignalGap& gap : gaps) all.push_back({manoeuvre.name, gap.signal, gap.unit, gap.gap, gap.gap / floors.at(gap.unit)});
  }
  std::stable_sort(all.begin(), all.end(), [](const Separation& a, const Separation& b) { return a.noise_floors > b.noise_floors; });
  return all;
}

}  // namespace slewlab::diagnosis
