#include "diagnosis/parameters_alone.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

// A friction is missing, so that parameters alone leave more than noise and are looked for on several ways. With where they have ended known, one way to it from the nominal machine is
// enough: the same cost, by fewer simulations than those on which it was found.
TEST(ParametersAlone, EndsWhereTwoWaysMeet) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"bearing_viscous", {3e6, 0.0}}};
  Admitted admitted({simulated_log(truth, bench().controller, kThereAndBack, kDuration, 2, 1e-2)});
  Problem& problem = admitted.problem;
  const FitResult nominal = nominal_fit(problem);
  const auto simulations_of = [&](const std::optional<Point>& known, FitResult& fitted) {
    const std::int64_t before = problem.simulations;
    fitted = fit_parameters_alone(problem, nominal, known);
    return problem.simulations - before;
  };
  FitResult found, again;
  const std::int64_t on_all_ways = simulations_of({}, found), with_its_end = simulations_of(found.point, again);
  EXPECT_GT(found.mean_square, kNoiseAlone);
  EXPECT_LT(with_its_end, on_all_ways);
  EXPECT_LE(again.cost, found.cost + problem.settings.settled);
}

}  // namespace
}  // namespace slewlab::diagnosis
