#include "diagnosis/discriminate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/prediction.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kDuration = 30.0;            // [s] of every manoeuvre
constexpr double kStep = 1e-3;                // [s]
constexpr double kTorqueNoise = 1.0;          // [Nm per motor] what the encoders' noise makes in a commanded torque
constexpr double kSpeedNoise = 0.02;          // [rad/s] of a drive's speed from 14 bits a turn
constexpr double kAccelerationNoise = 0.005;  // [m/s^2] of an ordinary accelerometer
constexpr double kAngleNoise = 2.4e-5;        // [rad] 18 bits on the slew ring

struct Request {
  double time;   // [s]
  double speed;  // [-]
};

struct Manoeuvre {
  const char* name;
  std::vector<Request> requests;
};

const std::vector<Manoeuvre>& manoeuvres() {
  static const std::vector<Manoeuvre> kManoeuvres{
      {"a slew there and back at half speed", {{1.0, 0.5}, {11.0, 0.0}, {16.0, -0.5}, {24.0, 0.0}}},
      {"a slew there and back at full speed", {{1.0, 1.0}, {11.0, 0.0}, {16.0, -1.0}, {24.0, 0.0}}},
      {"inching", {{1.0, 0.5}, {3.0, 0.0}, {5.0, -0.5}, {7.0, 0.0}, {9.0, 0.5}, {11.0, 0.0}, {13.0, -0.3}, {15.0, 0.0}, {17.0, 0.3}, {19.0, 0.0}}},
      {"a reversal at full speed without a stop", {{1.0, 1.0}, {11.0, -1.0}, {22.0, 0.0}}}};
  return kManoeuvres;
}

Record blank_record(const Manoeuvre& manoeuvre, const controller::ControllerSettings& controller) {
  Record record;
  record.name = manoeuvre.name;
  record.step = kStep;
  record.encoder_period = controller.period;
  record.group_count = controller.group_count;
  const auto size = static_cast<std::size_t>(std::lround(kDuration / kStep));
  for (int g = 0; g < record.group_count; ++g) {
    record.motor_torque[static_cast<std::size_t>(g)].assign(size, 0.0);
    record.shaft_speed[static_cast<std::size_t>(g)].assign(size, 0.0);
  }
  for (const Request& request : manoeuvre.requests) {
    record.operator_moves.push_back({std::llround(request.time * 1e9), request.speed, false, false});
  }
  return record;
}

double noise_of(const std::string& unit) {
  if (unit == "Nm") return kTorqueNoise;
  if (unit == "rad/s") return kSpeedNoise;
  return unit == "rad" ? kAngleNoise : kAccelerationNoise;
}

}  // namespace

std::vector<Separation> separations(const sim::MachineSettings& one, const sim::MachineSettings& other,
                                    const controller::ControllerSettings& controller) {
  std::vector<Separation> all;
  for (const Manoeuvre& manoeuvre : manoeuvres()) {
    const Record blank = blank_record(manoeuvre, controller);
    const Record a = predict(one, controller, blank).series;
    const Record b = predict(other, controller, blank).series;
    std::vector<SignalGap> gaps = signal_gaps(a, b);
    gaps.push_back(gap_between("slew angle", "rad", a.slew_angle, b.slew_angle));
    for (const SignalGap& gap : gaps) all.push_back({manoeuvre.name, gap.signal, gap.unit, gap.gap, gap.gap / noise_of(gap.unit)});
  }
  std::stable_sort(all.begin(), all.end(), [](const Separation& a, const Separation& b) { return a.noise_floors > b.noise_floors; });
  return all;
}

}  // namespace slewlab::diagnosis
