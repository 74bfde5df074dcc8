#include <algorithm>
#include <cmath>

#include "diagnosis/evaluation/law.h"

namespace slewlab::diagnosis::withheld {

namespace {

std::vector<TrueSize> droop(TruthMachine& machine, double size, Random&) {
  machine.controller.speed_control.droop = size;
  return {{"droop", size}};
}

std::vector<TrueSize> other_gains(TruthMachine& machine, double size, Random& random) {
  const double gain = std::exp(size * random.sign());
  const double time = random.uniform() < 0.5 ? 1.0 : std::exp(random.between(-size, size));
  machine.controller.speed_control.proportional_gain *= gain;
  machine.controller.speed_control.integral_time *= time;
  return {{"gain_factor", gain}, {"integral_time_factor", time}};
}

std::vector<TrueSize> other_ramp(TruthMachine& machine, double size, Random& random) {
  controller::RampSettings& ramp = machine.controller.ramp;
  const double time = std::exp(size * random.sign());
  const double before = ramp.curved_share;
  const double change = random.uniform() < 0.5 ? 0.0 : random.between(-0.15, 0.15);
  ramp.acceleration_time *= time;
  ramp.deceleration_time *= time;
  ramp.curved_share = std::clamp(before + change, 0.0, 0.5);
  return {{"time_factor", time}, {"curved_share_change", ramp.curved_share - before}};
}

std::vector<TrueSize> other_play_compensation(TruthMachine& machine, double size, Random& random) {
  controller::PlayCompensationSettings& map = machine.controller.play_compensation;
  const double factor = 1.0 + size * random.sign();
  for (int k = 0; k < map.point_count; ++k) {
    controller::PlayMapPoint& point = map.points[static_cast<std::size_t>(k)];
    point.half_1 = point.average + factor * (point.half_1 - point.average);
    point.half_2 = point.average + factor * (point.half_2 - point.average);
  }
  return {{"offset_factor", factor}};
}

std::vector<TrueSize> speed_filter(TruthMachine& machine, double size, Random&) {
  machine.controller.speed_filter_time = size;
  return {{"time_constant", size}};
}

double of_top_shaft_speed(const LawScales& s) { return s.top_shaft_speed; }

}  // namespace

std::vector<Law> controller_laws() {
  constexpr const char* kSame = "the controller's own settings";
  return {
      {"droop_on", "droop", "controller", kSame, 7.31e-4, 0.0731, of_top_shaft_speed, droop},
      {"gains", "other_gains", "controller", kSame, 0.02, 0.8, pure_number, other_gains},
      {"ramp_times", "other_ramp", "controller", kSame, 0.01, 0.5, pure_number, other_ramp},
      {"play_map", "other_play_compensation", "controller", kSame, 0.03, 0.9, pure_number, other_play_compensation, {},
       Needs::play_compensation},
      {"filter_on", "speed_filter", "controller", kSame, 0.00262, 0.105, of_period, speed_filter},
  };
}

}  // namespace slewlab::diagnosis::withheld
