#include "controller/play_compensation.h"

#include <algorithm>
#include <cmath>

namespace slewlab::controller {

bool is_enabled(const PlayCompensationSettings& settings, std::int64_t simulated_time) {
  bool enabled = settings.enabled;
  for (const PlaySwitch& change : settings.switches) {
    if (change.time > simulated_time) break;
    enabled = change.enabled;
  }
  return enabled;
}

void add_switch(PlayCompensationSettings& settings, const PlaySwitch& change) {
  const auto later = std::find_if(settings.switches.begin(), settings.switches.end(),
                                  [&](const PlaySwitch& each) { return each.time > change.time; });
  settings.switches.insert(later, change);
}

HalfTorques evaluate_play_map(const PlayCompensationSettings& settings, double average) {
  const double size = std::abs(average);
  const PlayMapPoint* const points = settings.points.data();
  const int last = settings.point_count - 1;
  // Beyond the map the groups stay as far apart as at its end.
  const double beyond = std::max(0.0, size - points[last].average);
  HalfTorques torques{points[last].half_1 + beyond, points[last].half_2 + beyond};
  for (int i = 0; i < last; ++i) {
    if (size >= points[i + 1].average) continue;
    const double share = (size - points[i].average) / (points[i + 1].average - points[i].average);
    torques.half_1 = points[i].half_1 + share * (points[i + 1].half_1 - points[i].half_1);
    torques.half_2 = points[i].half_2 + share * (points[i + 1].half_2 - points[i].half_2);
    break;
  }
  if (average < 0.0) return {-torques.half_2, -torques.half_1};
  return torques;
}

int half_of_group(int group, int group_count) {
  const int half = group_count / 2;
  if (group < half) return 1;
  return group >= group_count - half ? 2 : 0;
}

}  // namespace slewlab::controller
