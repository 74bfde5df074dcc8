// The noise of torques that were measured. A command is what the controller made of the encoder readings, so what moves fast in it is a linear
// combination of what moves fast in them,
//
//   d^3 T_g(k) = sum over groups h and readings j of a_ghj d^3 position_h(k - j) + b_ghj d^3 speed_h(k - j) + r_g(k),
//
// d^3 the third difference, which takes away all that is slow. In r_g a measured torque has besides what no reading tells: its noise. Where that is
// white, r_g has 20 times its variance. A controller that hears of more than the encoders has such a part as well, and nothing in the record tells it
// from noise: whether torques were measured is said by who recorded them.
//
// Kinks of a ramp and switched torques show in few differences, which count less (Huber's weights); a torque that mostly keeps its value is a command that is held.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "msgs/messages.h"

namespace slewlab::diagnosis {

// d^3 of a series, four values at least, and what it makes of the variance of white noise: 1 + 9 + 9 + 1.
Eigen::VectorXd third_difference(const Eigen::VectorXd& values);
inline constexpr double kThirdDifferenceGain = 20.0;

// [Nm^2] per message, of the group that has most; 0 where the torques are held, or the record is too short to tell.
double torque_noise(const std::vector<msgs::Encoder>& encoder, const std::vector<msgs::Torque>& torque);

}  // namespace slewlab::diagnosis
