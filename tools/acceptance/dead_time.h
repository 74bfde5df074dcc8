// How late a controller's torque follows the reading that it answers, told by noise on the encoders.
//
// The mean torque of the answer to ENCODER k is taken as a sum over the mean speeds of the readings before, sum_d h_d w_(k-d), in least squares
// of the second differences, which leave ramps and slow integrals out. In a closed loop without noise speed and torque follow from each other,
// and no such sum is the controller's; noise that the controller cannot foresee makes it so. Source: textbook (Ljung, System Identification:
// impulse response by least squares, identifiability in closed loop).
#pragma once

#include <array>

#include "msgs/run_log.h"

namespace slewlab::tools {

inline constexpr int kAnswerLags = 16;  // readings back; a controller's answer that begins later is not looked for

struct AnswerToNoise {
  int lag = -1;                             // [controller cycles] from the reading to the first torque that it moves; negative where noise moves none
  std::array<double, kAnswerLags> answer{};  // [N m s/rad] h_d
  std::array<double, kAnswerLags> error{};   // [N m s/rad] standard deviation of each
  int count = 0;                            // of answers with all their readings
};
// Of the answers to readings from `from` until `until` [s], of a controller that gives torque; pairs by the sequence that TORQUE says.
AnswerToNoise answer_to_noise(const msgs::RunLog& run, double from, double until);

}  // namespace slewlab::tools
