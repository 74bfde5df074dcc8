#include "diagnosis/controller_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "controller/effects/catalogue.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kIterations = 12;
constexpr double kStep = 0.02;  // [standard deviations of the prior] difference quotient
constexpr double kChangeTime = 0.25;  // [s] short against ramps and integral times, long enough to see a ramp that is late
constexpr std::array<double, 4> kStartShares{0.03, 0.1, 0.4, 1.5};  // of the typical size
// Share of the difference that the right effect may leave where the real law differs from the catalogue's.
constexpr double kUsualShareLeft = 1e-3;
constexpr double kIndependent = 60.0;  // independent differences that the replay is worth

// Of the changes over `change_time` [s]; of the torques themselves where that is 0.
Eigen::VectorXd torque_differences(std::span<const Record> records, const controller::ControllerSettings& settings,
                                   double change_time = 0.0) {
  std::vector<double> all;
  for (const Record& record : records) {
    const std::vector<double> difference = replay_controller(record, settings).difference;
    // The groups' values stand in turns.
    const std::size_t lag =
        static_cast<std::size_t>(record.group_count) * static_cast<std::size_t>(std::lround(change_time / record.encoder_period));
    for (std::size_t n = lag; n < difference.size(); ++n) all.push_back(difference[n] - (lag > 0 ? difference[n - lag] : 0.0));
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

controller::ControllerSettings with(const controller::ControllerSettings& nominal, const common::EffectInstance& effect) {
  return controller::with_effects(nominal, {effect});
}

common::EffectInstance at(const common::EffectAbout& about, const Eigen::VectorXd& x) {
  common::EffectInstance effect{std::string(about.name), {}};
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    effect.values.push_back(std::clamp(from_coordinate(parameter, x(static_cast<Eigen::Index>(p))), parameter.lower, parameter.upper));
  }
  return effect;
}

Eigen::VectorXd coordinates(const common::EffectAbout& about, const common::EffectInstance& effect) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(effect.values.size()));
  for (std::size_t p = 0; p < effect.values.size(); ++p) {
    x(static_cast<Eigen::Index>(p)) = to_coordinate(about.parameters[p], effect.values[p]);
  }
  return x;
}

// Shares of the typical size, and the other way round where the effect has one.
std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about) {
  const common::EffectInstance typical = common::typical_instance(about);
  std::vector<common::EffectInstance> starts{typical};
  const common::EffectParameter& size = about.parameters.front();
  if (!size.absent || !std::isfinite(*size.absent)) return starts;
  for (const double share : kStartShares) {
    for (const double direction : {1.0, -1.0}) {
      common::EffectInstance start = typical;
      start.values[0] = std::clamp(*size.absent + direction * share * (typical.values[0] - *size.absent), size.lower, size.upper);
      starts.push_back(start);
    }
  }
  return starts;
}

// Levenberg-Marquardt from `effect`, by the torques' changes over `change_time`. Gives the differences there and the curvature.
Eigen::VectorXd descend(std::span<const Record> records, const controller::ControllerSettings& nominal,
                        const common::EffectAbout& about, double change_time, common::EffectInstance& effect,
                        Eigen::MatrixXd& gram) {
  Eigen::VectorXd x = coordinates(about, effect);
  double damping = 1e-3;
  Eigen::VectorXd difference = torque_differences(records, with(nominal, effect), change_time);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::MatrixXd columns(difference.size(), x.size());
    for (Eigen::Index p = 0; p < x.size(); ++p) {
      Eigen::VectorXd moved = x;
      moved(p) += kStep;
      columns.col(p) = (torque_differences(records, with(nominal, at(about, moved)), change_time) - difference) / kStep;
    }
    gram = columns.transpose() * columns;
    const double scale = std::max(1e-12, gram.diagonal().maxCoeff());
    Eigen::MatrixXd system = gram;
    system.diagonal() += damping * (gram.diagonal().array() + 1e-9 * scale).matrix();
    const Eigen::VectorXd trial = coordinates(about, at(about, x - system.ldlt().solve(columns.transpose() * difference)));
    const Eigen::VectorXd trial_difference = torque_differences(records, with(nominal, at(about, trial)), change_time);
    if (trial_difference.squaredNorm() < difference.squaredNorm()) {
      const bool settled = trial_difference.squaredNorm() > 0.999 * difference.squaredNorm();
      x = trial;
      difference = trial_difference;
      damping *= 0.2;
      if (settled) break;
    } else {
      damping *= 20.0;
      if (damping > 1e6) break;
    }
  }
  effect = at(about, x);
  return difference;
}

}  // namespace

std::vector<ControllerCause> fit_controller(std::span<const Record> records,
                                            const controller::ControllerSettings& nominal,
                                            std::span<const std::string> without) {
  const double gap = torque_differences(records, nominal).squaredNorm();
  std::vector<ControllerCause> causes;
  for (const controller::ControllerEffect* description : controller::effect_catalogue()) {
    const common::EffectAbout& about = description->about;
    if (std::find(without.begin(), without.end(), about.name) != without.end()) continue;
    ControllerCause cause;
    // A replayed integral runs away as long as the speed it wants is not quite the recorded one, and its torque leads a descent
    // nowhere until everything is nearly right. So first the changes, from the best of some sizes, then the torques.
    double least = std::numeric_limits<double>::infinity();
    for (const common::EffectInstance& start : starts_of(about)) {
      const double square = torque_differences(records, with(nominal, start), kChangeTime).squaredNorm();
      if (square >= least) continue;
      least = square;
      cause.effect = start;
    }
    Eigen::MatrixXd gram;
    descend(records, nominal, about, kChangeTime, cause.effect, gram);
    const Eigen::VectorXd difference = descend(records, nominal, about, 0.0, cause.effect, gram);
    cause.share_left = gap > 0.0 ? difference.squaredNorm() / gap : 1.0;
    // What is left is not noise but law; it is worth kIndependent differences.
    const double variance = std::max(difference.squaredNorm(), kUsualShareLeft * gap) / kIndependent;
    Eigen::MatrixXd regular = gram;
    regular.diagonal().array() += 1e-12 * std::max(1e-300, gram.diagonal().maxCoeff());
    const Eigen::MatrixXd inverse = regular.inverse();
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const double per_deviation = value_per_deviation(about.parameters[p], cause.effect.values[p]);
      const auto i = static_cast<Eigen::Index>(p);
      cause.deviation.push_back(std::fabs(per_deviation) * std::sqrt(std::min(1.0, variance * inverse(i, i))));
    }
    causes.push_back(cause);
  }
  double sum = 0.0;
  for (ControllerCause& cause : causes) {
    cause.probability = std::pow(kUsualShareLeft + cause.share_left, -0.5 * kIndependent);
    sum += cause.probability;
  }
  for (ControllerCause& cause : causes) cause.probability /= sum;
  std::sort(causes.begin(), causes.end(), [](const ControllerCause& a, const ControllerCause& b) { return a.probability > b.probability; });
  return causes;
}

}  // namespace slewlab::diagnosis
