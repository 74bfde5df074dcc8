#include "diagnosis/controller_loop.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/noise_response.h"

namespace slewlab::diagnosis {

namespace {

using GroupVector = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::ColMajor, sim::kMaximumGroupCount, 1>;
using Spectrum = std::vector<std::complex<double>>;

constexpr double kLeastCondition = 1e-10;  // [-] of the normal equations: below, the readings of the groups are one
constexpr double kLeastPower = 1e-3;       // [-] of the mean: what counts of readings that stand still is rounding
constexpr int kTerms = 3;                  // of C in s: chosen, a delay of a sixth of a period within a twentieth

// Under a smooth window and twice differenced: what is slow, and large, must not leak into what is fast.
Spectrum spectrum_of_stretch(const std::vector<double>& values, std::size_t begin, std::size_t length) {
  std::vector<double> stretch(length);
  for (std::size_t n = 0; n < length; ++n) {
    const double window = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length)));
    const std::size_t at = begin + n;
    stretch[n] = window * (values[at] - 2.0 * values[at - 1] + values[at - 2]);
  }
  return spectrum_of(stretch);
}

// [points] of a transform in which the machine's answer to an impulse dies away, within the record.
std::size_t response_length(const Problem& problem, const Record& record) {
  constexpr double kTimes = 16.0;  // characteristic times T; chosen: a mode of period T that is damped by a hundredth falls to a third
  const auto points = static_cast<std::size_t>(kTimes * problem.thresholds.time / record.step);
  return std::min(transform_length(points), (record.size() - 2) / 2 * 2);
}

// Of each bin: what of the torque channels' variance is noise and not what mesh and step make wrong, in the one that has least.
Eigen::VectorXd noise_share(const Whitening& whitening) {
  Eigen::VectorXd share = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(whitening.bin_count));
  for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
    if (whitening.channels[c].is_torque) share = share.cwiseMin((1.0 - whitening.missed[c].array()).max(0.0).matrix());
  }
  return share;
}

}  // namespace

GroupMatrix ControllerResponse::at(double frequency) const {
  const std::complex<double> s(0.0, frequency / unit);
  GroupMatrix answer = GroupMatrix::Zero(rate.front().rows(), rate.front().cols());
  std::complex<double> power = s;
  for (const GroupMatrix& term : rate) {
    answer += power * term;
    power *= s;
  }
  return answer;
}

ControllerResponse controller_response(const Record& record, std::size_t length, double from, double to) {
  const auto groups = static_cast<Eigen::Index>(record.group_count);
  const double bin_width = 1.0 / (static_cast<double>(length) * record.step);
  const auto first = static_cast<std::size_t>(std::ceil(from / bin_width)), end = std::min(static_cast<std::size_t>(to / bin_width), length / 2) + 1;
  // All groups' torques and positions at one frequency of one stretch.
  struct Answered {
    std::complex<double> s;  // in `to`
    GroupVector torque, position;
  };
  std::vector<Answered> answered;
  double power = 0.0;
  for (std::size_t begin = 2; begin + length <= record.size(); begin += length / 2) {
    std::vector<Spectrum> torque, position;
    for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) {
      torque.push_back(spectrum_of_stretch(record.motor_torque[g], begin, length));
      position.push_back(spectrum_of_stretch(record.shaft_position[g], begin, length));
    }
    for (std::size_t k = first; k < end; ++k) {
      answered.push_back({{0.0, static_cast<double>(k) * bin_width / to}, GroupVector(groups), GroupVector(groups)});
      for (Eigen::Index g = 0; g < groups; ++g) {
        answered.back().torque(g) = torque[static_cast<std::size_t>(g)][k];
        answered.back().position(g) = position[static_cast<std::size_t>(g)][k];
      }
      power += answered.back().position.squaredNorm();
    }
  }
  ControllerResponse response{to, {}};
  if (power <= 0.0) return response;
  const double least = kLeastPower * power / static_cast<double>(answered.size());
  // Normal equations of all torques, a column each; the unknowns are the groups' readings within each power of s.
  Eigen::MatrixXd of_readings = Eigen::MatrixXd::Zero(groups * kTerms, groups * kTerms), with_torques = Eigen::MatrixXd::Zero(groups * kTerms, groups);
  for (const Answered& one : answered) {
    Eigen::VectorXcd readings(groups * kTerms);
    std::complex<double> power_of_s = one.s;
    for (Eigen::Index term = 0; term < kTerms; ++term, power_of_s *= one.s) readings.segment(term * groups, groups) = power_of_s * one.position;
    const double weight = 1.0 / std::max(least, one.position.squaredNorm());
    of_readings += weight * (readings.conjugate() * readings.transpose()).real();
    with_torques -= weight * (readings.conjugate() * one.torque.transpose()).real();
  }
  const Eigen::LDLT<Eigen::MatrixXd> solved(of_readings);
  if (solved.info() != Eigen::Success || !solved.isPositive() || solved.rcond() < kLeastCondition) return response;
  const Eigen::MatrixXd rates = solved.solve(with_torques);
  for (Eigen::Index term = 0; term < kTerms; ++term) response.rate.emplace_back(rates.middleRows(term * groups, groups).transpose().cast<std::complex<double>>());
  return response;
}

MachineResponse machine_response(const sim::MachineSettings& machine, const Record& record, const ShadowGains& gains, double encoder_latency, std::size_t length, const ForceSteps& force_steps) {
  const auto groups = static_cast<std::size_t>(record.group_count);
  const Follower follower = linear_follower(machine, grid_of(record), force_steps);
  const Record still = standing(record, 1);
  // The missing torque of each motor, at each point of the grid, after a first one at which something is otherwise.
  const auto missing_after = [&](const GroupAngles& reading, const sim::DriveCommand& push) {
    Observer observer(follower, still, gains);
    std::vector<std::vector<double>> missing(groups, std::vector<double>(length, 0.0));
    for (std::size_t n = 0; n < length; ++n) {
      const Observer::Moment moment = observer.advance(n == 0 ? push : sim::DriveCommand{}, {n == 0 ? reading : GroupAngles{}, nullptr});
      for (std::size_t g = 0; g < groups; ++g) missing[g][n] = moment.missing_torque[g];
    }
    return missing;
  };
  const std::vector<std::vector<double>> left_alone = missing_after({}, {});
  const auto spectra_of = [&](std::vector<std::vector<double>> missing) {
    std::vector<Spectrum> spectra;
    for (std::size_t g = 0; g < groups; ++g) {
      for (std::size_t n = 0; n < length; ++n) missing[g][n] -= left_alone[g][n];
      spectra.push_back(spectrum_of(missing[g]));
    }
    return spectra;
  };
  constexpr double kSmall = 1e-6;  // [rad], and as a share of the rated torque: teeth that a load presses together stay so
  const double small_torque = kSmall * follower.machine.model.parameters.drive.rated_torque;  // [Nm]
  std::vector<std::vector<Spectrum>> of_reading, of_torque;  // per group that is off, per motor
  for (std::size_t g = 0; g < groups; ++g) {
    GroupAngles reading{};
    reading[g] = kSmall;
    sim::DriveCommand push;
    push.motor_torque[g] = small_torque;
    of_reading.push_back(spectra_of(missing_after(reading, {})));
    of_torque.push_back(spectra_of(missing_after({}, push)));
  }
  const double late = encoder_latency / record.step + follower.encoder_delay;  // [steps]
  MachineResponse response{length, 1.0 / (static_cast<double>(length) * record.step), {}};
  const auto size = static_cast<Eigen::Index>(groups);
  for (std::size_t k = 0; k <= length / 2; ++k) {
    GroupMatrix by_reading(size, size), by_torque(size, size);
    for (Eigen::Index g = 0; g < size; ++g) {
      for (Eigen::Index h = 0; h < size; ++h) {
        by_reading(h, g) = of_reading[static_cast<std::size_t>(g)][static_cast<std::size_t>(h)][k];
        by_torque(h, g) = of_torque[static_cast<std::size_t>(g)][static_cast<std::size_t>(h)][k];
      }
    }
    response.at.emplace_back(-kSmall / small_torque * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length) * late) * by_reading.inverse() * by_torque);
  }
  return response;
}

Eigen::VectorXd stretch_of_readings(const MachineResponse& machine, const ControllerResponse& controller, const Whitening& whitening) {
  Eigen::VectorXd stretch = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(whitening.bin_count));
  if (controller.rate.empty()) return stretch;
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    const double place = static_cast<double>((whitening.first_bin + b) * machine.length) / static_cast<double>(whitening.transform_length);
    const auto k = static_cast<std::size_t>(std::lround(place));
    const GroupMatrix loop = machine.at[k] * controller.at(static_cast<double>(k) * machine.bin_width);
    const GroupMatrix returned = GroupMatrix::Identity(loop.rows(), loop.cols()) + loop;
    stretch(static_cast<Eigen::Index>(b)) = 2.0 * std::log(std::norm(returned.determinant()));
  }
  return stretch;
}

ControllerLoop controller_loop(const Problem& problem) {
  ControllerLoop loop;
  const WhiteningSettings& band = problem.thresholds.whitening;
  const sim::MachineSettings nominal = machine_at(problem.nominal, problem.nuisances, {});
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Record& record = problem.records[r];
    const Whitening& whitening = problem.whitening[r];
    const std::size_t length = response_length(problem, record);
    const double to = static_cast<double>(whitening.first_bin + whitening.bin_count) * whitening.bin_width;
    loop.controller.push_back(controller_response(record, length, to * band.encoder_noise_from / band.highest_frequency, to));
    loop.of_nominal.push_back(stretch_of_readings(machine_response(nominal, record, problem.gains, 0.0, length, problem.force_steps), loop.controller.back(), whitening));
  }
  return loop;
}

double loss_by_loop(const Problem& problem, const ControllerLoop& loop, const Point& point) {
  const sim::MachineSettings machine = machine_at(problem.nominal, problem.nuisances, point);
  double loss = 0.0;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    if (loop.controller[r].rate.empty()) continue;
    const Record& record = problem.records[r];
    const Whitening& whitening = problem.whitening[r];
    const MachineResponse answer = machine_response(machine, record, problem.gains, encoder_latency(problem.nuisances, point.nuisance), response_length(problem, record), problem.force_steps);
    const Eigen::VectorXd stretch = stretch_of_readings(answer, loop.controller[r], whitening);
    loss += noise_share(whitening).dot(loop.of_nominal[r] - stretch);
  }
  return loss;
}

}  // namespace slewlab::diagnosis
