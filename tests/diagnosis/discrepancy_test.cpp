// What a residual follows, where the law behind it is known: a torque that acts on the machine and not in its record, made by taking it off
// the record, and laws of the catalogue, which parameters alone do not know.
#include "diagnosis/discrepancy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "diagnosis/evidence.h"
#include "tests/diagnosis/missing_torque.h"

namespace slewlab::diagnosis {
namespace {

// A missing torque, with what is said of the residual.
struct Missing : MissingTorque {
  using MissingTorque::MissingTorque;
  std::vector<Discrepancy> found = discrepancies(problem, fit, SmoothTorques(problem, fit), EvidenceSettings{}.law_share);
};

TEST(Discrepancies, OfTheNominalMachineAreNone) {
  const Missing none({}, no_torque);
  EXPECT_TRUE(none.found.empty()) << none.fit.mean_square;
  EXPECT_TRUE(followed_variables(none.found).empty());
}

// Where the records visited it well, the curve is the torque that was taken off, but for its mean, which a constant and the inertias may stand for.
// Forward, the place of the second test is hardly passed.
void expect_curves(const Missing& missing, const std::string& variable, const std::string& part, const std::function<double(double v, double direction)>& law) {
  ASSERT_EQ(followed_variables(missing.found), std::vector<std::string>{variable});
  EXPECT_GT(missing.found.front().share, 0.8);
  for (const DiscrepancyCurve& curve : missing.found.front().curves) {
    if (curve.part.find(part) == std::string::npos) continue;
    const double direction = curve.part.starts_with("forward") ? 1.0 : -1.0;
    const double least = *std::min_element(curve.deviation.begin(), curve.deviation.end());
    std::vector<double> found, expected;
    for (std::size_t i = 0; i < curve.at.size(); ++i) {
      if (curve.deviation[i] > 2.0 * least) continue;
      found.push_back(curve.torque[i]);
      expected.push_back(law(curve.at[i], direction));
    }
    const auto mean = [](const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()); };
    const double found_mean = mean(found), expected_mean = mean(expected);
    double square = 0.0, wrong = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      square += std::pow(expected[i] - expected_mean, 2);
      wrong += std::pow(found[i] - found_mean - (expected[i] - expected_mean), 2);
    }
    EXPECT_LT(wrong, 0.09 * square) << variable << " " << curve.part;  // three tenths of it
  }
}

TEST(Discrepancies, OfATorqueAgainstTheSpeedFollowIt) {
  const auto law = [](double speed, double) { return -400.0 * speed; };  // [Nm]
  expect_curves(Missing({}, [&](const MotorState& s) { return law(s.speed, 0); }), "speed", "ward", law);
}

TEST(Discrepancies, OfATorqueAtAPlaceFollowTheAngle) {
  const auto law = [](double angle, double) { return 20.0 * std::exp(-std::pow((angle + 0.1) / 0.08, 2)); };  // [Nm]
  expect_curves(Missing({}, [&](const MotorState& s) { return law(s.angle, 0); }), "angle", "backward", law);
}

TEST(Discrepancies, OfATorqueThatComesAndGoesFollowTheTime) {
  const auto law = [](double time) { return 20.0 * std::sin(2.0 * std::numbers::pi * time / 9.0); };  // [Nm]
  EXPECT_EQ(followed_variables(Missing({}, [&](const MotorState& s) { return law(s.time); }).found), std::vector<std::string>{"time"});
}

TEST(Discrepancies, OfALossOfTorqueFollowTheTorque) {
  const auto law = [](double torque, double direction) { return -0.1 * torque * direction; };  // [Nm]
  expect_curves(Missing({}, [&](const MotorState& s) { return law(s.torque, std::tanh(s.speed / 0.001)); }), "torque", "ward", law);
}

// Motors that deliver less the faster they turn: the torque that is missing is none of the speed alone.
TEST(Discrepancies, OfALossThatGrowsWithTheSpeedFollowTheSpeed) {
  const double fast = bench().machine.scales.top_speed;
  const auto law = [fast](const MotorState& s) { return -0.3 * s.own_torque * std::pow(s.speed / fast, 2); };
  EXPECT_EQ(followed_variables(Missing({}, law).found), std::vector<std::string>{"speed"});
}

// Play compensation winds the groups up against each other: what a motor lacks follows its own torque, not the mean.
TEST(Discrepancies, OfMotorsThatPullHarderToOneSideFollowTheTorque) {
  const auto law = [](const MotorState& s) { return 0.05 * std::fabs(s.own_torque); };
  EXPECT_EQ(followed_variables(Missing({}, law).found), std::vector<std::string>{"torque"});
}

// A drive that lags while its torque rises, and follows at once while it falls.
TEST(Discrepancies, OfADriveThatLagsTheOneWayFollowTheTorquesRate) {
  struct Followed {
    double torque = 0.0, time = 0.0;
  };
  std::vector<Followed> followed(sim::kMaximumGroupCount);
  const auto law = [&followed](const MotorState& s) {
    constexpr double kOver = 0.1, kLag = 0.06;  // [s]
    Followed& own = followed[s.group];
    if (s.time < own.time) own = {};  // another record
    own.torque += (s.own_torque - own.torque) * (1.0 - std::exp((own.time - s.time) / kOver));
    own.time = s.time;
    return -kLag * std::max(0.0, s.own_torque - own.torque) / kOver;
  };
  EXPECT_EQ(followed_variables(Missing({}, law).found), std::vector<std::string>{"torque's rate"});
}

// Eighty segments in a turn, which the axis passes at its largest speed in about a characteristic time each.
TEST(Discrepancies, OfATorqueThatComesManyTimesInATurnFollowTheAngle) {
  const auto law = [](const MotorState& s) { return 10.0 * std::sin(80.0 * s.angle + 1.0); };
  EXPECT_EQ(followed_variables(Missing({}, law).found), std::vector<std::string>{"angle"});
}

// Knocks without a mean, far faster than the structure: nothing in the residual is slow and could follow anything.
TEST(Discrepancies, OfKnocksAreNone) {
  const auto law = [](const MotorState& s) {
    const double turn = 12.0 * s.angle, within = (turn - std::floor(turn)) / 0.05;
    return within < 1.0 ? 60.0 * std::sin(2.0 * std::numbers::pi * within) * std::sin(std::numbers::pi * within) : 0.0;
  };
  const Missing knocks({}, law);
  EXPECT_GT(knocks.fit.mean_square, 10.0);
  EXPECT_TRUE(followed_variables(knocks.found).empty());
}

// Found by the machine of parameters alone, they also describe the residuals of other machines. The residual of a law's own fit has nothing of that law.
// The residual of a fit that has nothing to do with it has most of it.
TEST(SmoothTorques, OfADragAreLeftByWhatIsNoDrag) {
  Missing drag({{"air_drag", {600.0}}}, no_torque);  // [m^2]
  const double law_share = EvidenceSettings{}.law_share;
  ASSERT_TRUE(has_slow_gap(drag.problem, drag.fit));
  const SmoothTorques smooth(drag.problem, drag.fit);
  const auto left_with = [&](const common::EffectInstance& effect) {
    Point start = drag.fit.point;
    start.effects = {effect};
    const std::vector<Discrepancy> left = smooth.of_residual(drag.problem, fit(drag.problem, drag.fit.columns, start), law_share);
    return left.empty() ? 0.0 : left.front().evidence;
  };
  const double of_nothing = smooth.of_residual(drag.problem, drag.fit, law_share).front().evidence;
  EXPECT_GT(of_nothing, 2.0 * kFollowsAsWell);
  EXPECT_LT(left_with({"air_drag", {300.0}}), kFollowsAsWell);
  EXPECT_GT(left_with({"boom_stiffness", {0.9}}), 0.5 * of_nothing);
}

// A torque that is always there shows where what is slow is less than the noise that it is given, and the machine without it has none.
TEST(SmoothTorques, ShowBelowTheNoise) {
  const double law_share = EvidenceSettings{}.law_share;
  const auto evidence_of = [&](Missing& missing) {
    EXPECT_FALSE(has_slow_gap(missing.problem, missing.fit));
    const std::vector<Discrepancy> left = SmoothTorques(missing.problem, missing.fit).of_residual(missing.problem, missing.fit, law_share);
    return left.empty() ? 0.0 : left.front().evidence;
  };
  Missing sound({}, no_torque);
  EXPECT_LT(evidence_of(sound), 1.0);
  Missing offset({}, [](const MotorState&) { return 1.0; });  // [Nm]
  EXPECT_GT(evidence_of(offset), kFollowsAsWell);
}

// Friction, with all that it does at standstill.
TEST(Discrepancies, OfFrictionFollowTheSpeedAndOfGearsTheTorque) {
  EXPECT_EQ(followed_variables(Missing({{"bearing_coulomb", {2e5, 0.0, 3e-5}}}, no_torque).found), std::vector<std::string>{"speed"});
  EXPECT_EQ(followed_variables(Missing({{"gear_friction", {0.05, 3e-4}}}, no_torque).found), std::vector<std::string>{"torque"});
}

}  // namespace
}  // namespace slewlab::diagnosis
