// What the controller makes of the encoders' noise n. It answers the readings y with torques u, which turn the machine:
//
//   y = P u + n,    u = r - C y
//
// The residual of a hypothesis' machine P is y - P u = (I + P C) y - P r. The density of the readings is that of the noise times how far the
// readings' volume is stretched, in every bin |det (I + P C)|^2:
//
//   -2 ln p(y) = sum over bins of z* V^-1 z - 2 ln |det (I + P C)|^2
//
// z* V^-1 z as own_noise.h has it, less the same of the nominal machine. P follows the torques at least one reading later, so the mean of
// ln |det (I + P C)| over all frequencies is that of every machine (Bode's integral): a comparison over all frequencies need not know it. In the
// judged band the mean differs from machine to machine: the residual of readings that are taken d later is n (1 - T (1 - exp(-j w d))),
// T = P C / (1 + P C), smaller than the noise up to where the loop ends, and larger beyond.
//
// C is what the record shows in the upper half of the judged band, where the readings hold the encoders' noise alone: a delayed and filtered
// proportion of the speed, (K + K' s + K'' s^2) s with real matrices, by least squares over the spectra of commands and readings, each frequency
// counting alike. It is taken to go on so below. P = - A^-1 B of the machine at rest with its teeth together and nothing acting that is not linear.
// A and B are what an observer's missing torque (shadow.h) answers to one reading that is off, and to a torque over one step of the grid: it holds a
// machine that would not stay where it is.
// Assumption: the commands are a controller's answers to these readings, and what else it is asked is smooth. In bins where mesh and step make more
// of the residual than noise does, only the noise's share counts.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "diagnosis/problem.h"
#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "diagnosis/whitening.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

using GroupMatrix = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, sim::kMaximumGroupCount, sim::kMaximumGroupCount>;

// C [Nm of each motor per rad of each shaft], with s in `unit`.
struct ControllerResponse {
  double unit = 0.0;  // [Hz]
  std::vector<GroupMatrix> rate;  // K, K', K''; none: nothing is read

  GroupMatrix at(double frequency) const;
};

// Of what lies between two frequencies [Hz], by transforms over `length` points.
ControllerResponse controller_response(const Record& record, std::size_t length, double from, double to);

// P at the frequencies of a transform over `length` points of the record's grid, from 0 to its half.
struct MachineResponse {
  std::size_t length = 0;
  double bin_width = 0.0;  // [Hz]
  std::vector<GroupMatrix> at;
};

// P [rad of each shaft per Nm of each motor, held over one step of the grid], encoders that read `encoder_latency` [s] late; nothing but what is linear acts. Throws std::invalid_argument where the machine cannot be built.
MachineResponse machine_response(const sim::MachineSettings& machine, const Record& record, const ShadowGains& gains, double encoder_latency, std::size_t length, const ForceSteps& force_steps);

// Of each bin that is judged: 2 ln |det (I + P C)|^2.
Eigen::VectorXd stretch_of_readings(const MachineResponse& machine, const ControllerResponse& controller, const Whitening& whitening);

// A problem's records and what its nominal machine makes of them.
struct ControllerLoop {
  std::vector<ControllerResponse> controller;  // per record
  std::vector<Eigen::VectorXd> of_nominal;   // per record: of each bin, the nominal machine's stretch
};
ControllerLoop controller_loop(const Problem& problem);

// What it adds to z* V^-1 z that the machine at a point stretches the readings otherwise than the nominal one.
double loss_by_loop(const Problem& problem, const ControllerLoop& loop, const Point& point);

}  // namespace slewlab::diagnosis
