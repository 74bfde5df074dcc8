#include "diagnosis/controller_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "controller/effects/catalogue.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kIterations = 12;
constexpr double kStep = 0.02;  // [standard deviations of the prior] difference quotient
// Share of the difference that the right effect may leave where the real law differs from the catalogue's.
constexpr double kUsualShareLeft = 1e-3;
constexpr double kIndependent = 60.0;  // independent differences that the replay is worth

Eigen::VectorXd torque_differences(std::span<const Record> records, const controller::ControllerSettings& settings) {
  std::vector<double> all;
  for (const Record& record : records) {
    const std::vector<double> difference = replay_controller(record, settings).difference;
    all.insert(all.end(), difference.begin(), difference.end());
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
    cause.effect = common::typical_instance(about);
    Eigen::VectorXd x = coordinates(about, cause.effect);
    // Start where the effect is small: typical sizes may lie on the wrong side.
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      if (about.parameters[p].absent && std::isfinite(*about.parameters[p].absent) &&
          about.parameters[p].scale == common::ParameterScale::linear) {
        x(static_cast<Eigen::Index>(p)) *= 0.1;
      }
    }
    double damping = 1e-3;
    cause.effect = at(about, x);
    Eigen::VectorXd difference = torque_differences(records, with(nominal, cause.effect));
    Eigen::MatrixXd gram = Eigen::MatrixXd::Identity(x.size(), x.size());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Eigen::MatrixXd columns(difference.size(), x.size());
      for (Eigen::Index p = 0; p < x.size(); ++p) {
        Eigen::VectorXd moved = x;
        moved(p) += kStep;
        columns.col(p) = (torque_differences(records, with(nominal, at(about, moved))) - difference) / kStep;
      }
      gram = columns.transpose() * columns;
      const double scale = std::max(1e-12, gram.diagonal().maxCoeff());
      Eigen::MatrixXd system = gram;
      system.diagonal() += damping * (gram.diagonal().array() + 1e-9 * scale).matrix();
      const Eigen::VectorXd trial = coordinates(about, at(about, x - system.ldlt().solve(columns.transpose() * difference)));
      const Eigen::VectorXd trial_difference = torque_differences(records, with(nominal, at(about, trial)));
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
    cause.effect = at(about, x);
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
