// What a manoeuvre is worth, where that is known: from information theory at its limits, and from a limit of torque that shows at full speed alone.
#include "diagnosis/next_manoeuvre.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "controller/controller_file.h"
#include "diagnosis/fit.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {
namespace {

// Limits: nothing is learned where all say the same, all that is open where they are far apart, and what two alike leave open where a third is not.
TEST(ExpectedGain, HasItsLimits) {
  const double far = 1e6;
  EXPECT_DOUBLE_EQ(entropy({0.5, 0.5}), 1.0);
  EXPECT_NEAR(expected_gain({0.5, 0.5}, {{0.0, 0.0}, {0.0, 0.0}}), 0.0, 1e-12);
  EXPECT_NEAR(expected_gain({0.5, 0.5}, {{0.0, far}, {far, 0.0}}), 1.0, 1e-12);
  EXPECT_NEAR(expected_gain({3.0, 1.0}, {{0.0, far}, {far, 0.0}}), entropy({0.75, 0.25}), 1e-12);
  EXPECT_NEAR(expected_gain({0.25, 0.25, 0.5}, {{0.0, 0.0, far}, {0.0, 0.0, far}, {far, far, 0.0}}), 1.0, 1e-12);
  EXPECT_EQ(entropy({1.0, 0.0}), 0.0);
}

TEST(CandidateManoeuvres, StayWithinTheControllersRangeAndEndAtRest) {
  const std::vector<Manoeuvre> all = candidate_manoeuvres(50, 7);
  ASSERT_EQ(all.size(), usual_manoeuvres().size() + 50);
  for (const Manoeuvre& manoeuvre : all) {
    ASSERT_FALSE(manoeuvre.requests.empty());
    EXPECT_EQ(manoeuvre.requests.back().speed, 0.0) << manoeuvre.name;
    EXPECT_LT(manoeuvre.requests.back().time, kManoeuvreDuration - 1.0) << manoeuvre.name;  // a ramp's time to come to rest
    EXPECT_TRUE(std::is_sorted(manoeuvre.requests.begin(), manoeuvre.requests.end(), [](const auto& a, const auto& b) { return a.time < b.time; }));
    for (const SpeedRequest& request : manoeuvre.requests) EXPECT_LE(std::fabs(request.speed), 1.0);
  }
  const std::vector<Manoeuvre> again = candidate_manoeuvres(50, 7);
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k].requests.size(), again[k].requests.size());
}

class NextManoeuvreTest : public testing::Test {
 protected:
  Hypothesis hypothesis(const std::string& name, double probability, const std::vector<common::EffectInstance>& effects) const {
    Hypothesis one{name, probability, {}, controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings};
    one.machine.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml").parameters;
    one.machine.effects = effects;
    return one;
  }
  Record without_accelerometers;
};

// A limit above what half speed needs and below what full speed needs.
TEST_F(NextManoeuvreTest, OfATorqueLimitGoesToFullSpeed) {
  const std::vector<Hypothesis> both{hypothesis("nothing", 0.6, {}), hypothesis("torque_limit", 0.4, {{"torque_limit", {170.0, 0.1}}})};
  const NextManoeuvre next = next_manoeuvre(both, usual_manoeuvres(), without_accelerometers);
  EXPECT_NE(next.manoeuvre.name.find("full speed"), std::string::npos) << next.manoeuvre.name;
  EXPECT_NEAR(next.open, entropy({0.6, 0.4}), 1e-12);
  EXPECT_GT(next.gain, 0.9 * next.open);
  EXPECT_GT(next.separation.noise_floors, kSeparated);
}

// Indistinguishable effects stay so, whatever is run.
TEST_F(NextManoeuvreTest, OfOneMotionWithTwoNamesPromisesNothing) {
  const std::vector<Hypothesis> both{hypothesis("dead_time", 0.5, {{"dead_time", {0.02}}}), hypothesis("command_delay", 0.5, {{"command_delay", {0.02}}})};
  EXPECT_LT(next_manoeuvre(both, candidate_manoeuvres(2, 3), without_accelerometers).gain, 0.01);
  EXPECT_THROW(next_manoeuvre({both[0]}, usual_manoeuvres(), without_accelerometers), std::invalid_argument);
  EXPECT_THROW(next_manoeuvre(both, usual_manoeuvres(), without_accelerometers, [] { return true; }), Interrupted);
}

}  // namespace
}  // namespace slewlab::diagnosis
