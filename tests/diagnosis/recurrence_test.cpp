// Expected lengths: those of the law that the machine has and its model has not.
#include "diagnosis/recurrence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diagnosis/fit.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kTorque = 1e5;  // [Nm] friction on the axis, mean over all places

// The lengths found where the nominal machine follows one that has this friction, variation over the place 0.6, second harmonic 0.3.
std::vector<double> lengths_of(double wavelength, const std::vector<Move>& moves, std::size_t most = 2) {
  BenchProblem problem;
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {common::typical_instance(problem.catalogue.at("bearing_uneven"))};
  const common::EffectAbout& about = problem.catalogue.at("bearing_uneven");
  const auto set = [&](const char* parameter, double value) { truth.effects[0].values[index_of(about, parameter)] = value; };
  set("torque", kTorque);
  set("variation", 0.6);
  set("wavelength", wavelength);
  set("phase", 1.0);
  set("second_sine", 0.3);
  problem.add(make_record(simulated_log(truth, bench().controller, moves, kDuration, 7), "a", bench().admission));
  return recurring_lengths(problem, nominal_fit(problem).point, most);
}

class Lengths : public testing::TestWithParam<double> {};

// Lengths that are passed three times at least, to what the angle that is passed tells apart: half an order of it.
TEST_P(Lengths, OfAnUnevenBearingAreFound) {
  const std::vector<double> found = lengths_of(GetParam(), kThereAndBack);
  ASSERT_EQ(found.size(), 2u);
  const double travel = 0.35;  // [rad] at least
  EXPECT_LT(std::fabs(1.0 / found[0] - 1.0 / GetParam()) * travel, 0.5) << found[0] << ", " << found[1];
}
INSTANTIATE_TEST_SUITE_P(Recurrence, Lengths, testing::Values(0.045, 0.07, 0.134));

TEST(Recurrence, OfAnAxisThatStandsIsNone) { EXPECT_TRUE(lengths_of(0.134, {}).empty()); }

TEST(Recurrence, LengthsLieApart) {
  const std::vector<double> found = lengths_of(0.134, kThereAndBack, 5);
  ASSERT_EQ(found.size(), 5u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT(std::fabs(1.0 / found[i] - 1.0 / found[j]), 1.0) << found[i] << ' ' << found[j];
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
