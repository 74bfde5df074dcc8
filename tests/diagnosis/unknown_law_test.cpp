// Laws that are in no catalogue, where they are known: a torque that acts on the machine and not in its record.
#include "diagnosis/unknown_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "diagnosis/own_noise.h"
#include "tests/diagnosis/missing_torque.h"

namespace slewlab::diagnosis {
namespace {

// A spring [Nm] over the angle that stiffens, which parameters alone know nothing of.
double stiffening_spring(const MotorState& state) { return -20.0 * (state.angle + std::pow(state.angle, 3)); }

struct Laws {
  explicit Laws(MissingTorque& missing) : residual_power(residual_power_of(missing)), misfit_cost(evidence, residual_power) {
    const SmoothTorques smooth(missing.problem, missing.fit);
    all = unknown_laws(missing.problem, missing.fit, residual_power, smooth, smooth.of_residual(missing.problem, missing.fit, evidence.law_share), evidence, misfit_cost, 0.0, missing.fit.cost).of_every_size;
  }
  // The residual power of parameters alone, as a cause of a record without a controller's answers is weighed by.
  double residual_power_of(const MissingTorque& missing) const {
    const double square = by_own_noise(missing.problem, missing.fit.point, missing.fit.difference, Eigen::MatrixXd(), evidence.discrepancy_count).square;
    return missing.problem.settings.independent_share * (square - static_cast<double>(missing.fit.difference.size()));
  }
  // The least residual power of a law of a variable.
  double left(const std::string& variable) const {
    double least = std::numeric_limits<double>::infinity();
    for (const UnknownLaw& law : all) {
      if (law.variable == variable) least = std::min(least, law.residual_power);
    }
    return least;
  }

  EvidenceSettings evidence;
  double residual_power;
  MisfitCost misfit_cost;
  std::vector<UnknownLaw> all;
};

// With a law of its own variable the residual is no more than noise, the residual of the machine on which no such torque acts. With a law of another
// variable it is larger.
TEST(UnknownLaw, OfTheVariableThatATorqueFollowsLeavesNoise) {
  MissingTorque missing({}, stiffening_spring), sound({}, no_torque);
  const Laws laws(missing), of_noise(sound);
  ASSERT_GT(laws.residual_power, of_noise.residual_power + 300.0);
  EXPECT_LT(laws.left("angle"), of_noise.residual_power + 30.0);
  for (const char* other : {"speed", "torque"}) EXPECT_GT(laws.left(other), of_noise.residual_power + 100.0) << other;
}

// Functions of no size change nothing; the larger they may be, the smaller is the residual, and the more the records say of them.
TEST(UnknownLaw, ExplainsNoMoreThanItMayBeLarge) {
  MissingTorque missing({}, stiffening_spring);
  const Laws laws(missing);
  std::vector<UnknownLaw> of_angle;
  std::copy_if(laws.all.begin(), laws.all.end(), std::back_inserter(of_angle), [](const UnknownLaw& law) { return law.variable == "angle"; });
  ASSERT_EQ(of_angle.size(), SmoothTorques::scales().size());
  EXPECT_NEAR(of_angle.front().residual_power, laws.residual_power, 0.1 * (laws.residual_power - of_angle.back().residual_power));
  for (std::size_t k = 1; k < of_angle.size(); ++k) {
    EXPECT_LE(of_angle[k].residual_power, of_angle[k - 1].residual_power + 1.0) << k;
    EXPECT_GT(of_angle[k].information.sum(), of_angle[k - 1].information.sum()) << k;
  }
}

// Of a machine of which nothing is missing no unknown law is asked for that noise alone would make.
TEST(UnknownLaw, IsNoneWhereNothingIsMissing) {
  MissingTorque sound({}, no_torque);
  const Laws laws(sound);
  for (const UnknownLaw& law : laws.all) EXPECT_GT(law.residual_power, laws.residual_power - 30.0) << law.variable;
}

}  // namespace
}  // namespace slewlab::diagnosis
