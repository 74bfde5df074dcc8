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
