#include "diagnosis/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace slewlab::diagnosis {

std::string_view name_of(Ending ending) {
  static constexpr std::array<std::string_view, 5> kNames{"settled", "no step lowers the cost", "the bounds leave no step", "no finite step",
                                                          "most iterations"};
  return kNames.at(static_cast<std::size_t>(ending));
}

namespace {

constexpr double kLeastDamping = 1e-6, kMostDamping = 1e6;
constexpr double kMostFirst = 0.1;   // with new slopes: what held back where the last ones were worn out, or had a kink, says nothing of these
constexpr double kFastestFall = 0.1;  // of the damping, behind a step that kept its promise
constexpr double kKept = 0.75;        // share of what was promised, beyond which the damping falls and small steps become larger ones

}  // namespace

Descent descend(const Descending& problem, double cost, const AdaptingSettings& settings, double& damping) {
  Descent descent{cost, 0, Ending::no_descent, 0.0};
  double tried = std::min(damping, kMostFirst), growth = 2.0;
  int failures = 0, idle = 0;
  const auto ended = [&](Ending ending) {
    descent.ending = ending;
    return descent;
  };
  for (; descent.iterations < settings.attempts; ++descent.iterations) {
    const LocalModel model = problem.model();
    if (model.slope.dot(model.curvature.ldlt().solve(model.slope)) < settings.enough) return ended(Ending::settled);  // what the undamped step promises
    Eigen::MatrixXd damped = model.curvature;
    damped.diagonal() *= 1.0 + tried;
    const Eigen::VectorXd step = damped.ldlt().solve(-model.slope);
    if (!step.allFinite()) return ended(Ending::no_direction);
    const double promised = -2.0 * model.slope.dot(step) - step.dot(model.curvature * step);
    const std::optional<double> trial = problem.attempt(step);
    if (!trial) return ended(Ending::at_the_bounds);
    const double fall = descent.cost - *trial;
    if (fall > 0.0) {
      problem.accept();
      descent.cost = *trial;
      descent.ending = Ending::most_iterations;
      damping = tried;
      const double kept = fall / promised, beyond_half = 2.0 * kept - 1.0;
      tried = std::clamp(tried * std::max(kFastestFall, 1.0 - beyond_half * beyond_half * beyond_half), kLeastDamping, kMostDamping);
      growth = 2.0;
      failures = 0;
      idle = fall < settings.enough && kept < kKept ? idle + 1 : 0;
      if (idle >= settings.failures) return ended(Ending::settled);
    } else {
      ++failures;
      const bool has_led_on = descent.ending == Ending::most_iterations;
      // Steps so small that nothing is left to be promised do not fall where slopes have a kink.
      if (promised < settings.enough || (has_led_on && failures >= settings.failures)) return descent;
      tried *= growth;
      growth *= 2.0;
    }
  }
  return descent;
}

Descent descend(const Descending& problem, double cost, const DescentSettings& settings) {
  Descent descent{cost, 0, Ending::most_iterations, 0.0};
  const auto ended = [&](Ending ending) {
    descent.ending = ending;
    return descent;
  };
  for (; descent.iterations < settings.iterations; ++descent.iterations) {
    bool fell = false;
    for (const double damping : settings.dampings) {
      LocalModel model = problem.model();
      model.curvature.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd step = model.curvature.ldlt().solve(-model.slope);
      if (damping == settings.dampings.front()) descent.promised = -model.slope.dot(step);
      if (!step.allFinite()) return ended(Ending::no_direction);
      const std::optional<double> trial = problem.attempt(step);
      if (!trial) return ended(Ending::at_the_bounds);
      if (!(*trial < descent.cost)) continue;
      const double least = descent.cost - settings.enough - settings.enough_share * std::max(0.0, descent.cost);
      fell = true;
      problem.accept();
      descent.cost = *trial;
      if (!(*trial < least)) {
        ++descent.iterations;
        return ended(Ending::settled);
      }
      break;
    }
    if (!fell) return ended(Ending::no_descent);
  }
  return descent;
}

}  // namespace slewlab::diagnosis
