// Play compensation (thesis 3.5, Table 3.4, appendix B as the notes give it): the two halves of the motor
// groups work against each other so that the gears stay under tension.
//
// A map gives the torque of each half for an average torque >= 0, all in shares of the rated torque T100, linear
// between its points, with slope 1 beyond the last. For a negative average it is mirrored:
//   T1(-a) = -T2(a),  T2(-a) = -T1(a).
// The map's first point is at average 0 with T1 = -T2, so that the mirrored map joins without a jump.
//
// An operator may switch it while the crane turns: at the times of `switches`, from the first controller step at or after each.
// The groups' torques then go from the one law to the other as fast as the torque's rate limit lets them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace slewlab::controller {

inline constexpr int kMaximumMapPoints = 16;

struct PlayMapPoint {
  double average = 0.0;  // [-] of rated torque
  double half_1 = 0.0;   // [-] of rated torque
  double half_2 = 0.0;   // [-] of rated torque
};

struct PlaySwitch {
  std::int64_t time = 0;  // [ns] simulated, from which on it holds
  bool enabled = false;
};

struct PlayCompensationSettings {
  bool enabled = false;                // until the first switch
  std::vector<PlaySwitch> switches{};  // rising times
  int point_count = 0;
  std::array<PlayMapPoint, kMaximumMapPoints> points{};  // rising averages, the first at 0
};

struct HalfTorques {
  double half_1 = 0.0;  // [-] of rated torque
  double half_2 = 0.0;  // [-] of rated torque
};

// Whether it acts at this time [ns].
bool is_enabled(const PlayCompensationSettings& settings, std::int64_t simulated_time);

// Adds a switch in its place; behind those of the same time.
void add_switch(PlayCompensationSettings& settings, const PlaySwitch& change);

// What the map gives for an average torque [-] of rated torque.
HalfTorques evaluate_play_map(const PlayCompensationSettings& settings, double average);

// The half that a group belongs to: 1 for the first half of the groups, 2 for the last; 0 for the middle
// one of an odd number, which gets no offset, and so for a single group.
int half_of_group(int group, int group_count);

}  // namespace slewlab::controller
