// The balance on axes whose law is known: sizes against the ones that were put in, no law where there is none, an unknown that is
// no law of the catalogue, and the same answer at any size of machine.
#include "diagnosis/balance/balance_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/diagnosis/balance/simulated_axis.h"

namespace slewlab::diagnosis {
namespace {

double moves(double time) { return 6.0 * std::sin(1.1 * time) + 4.0 * std::sin(2.7 * time + 1.0); }
double other_moves(double time) { return 5.0 * std::sin(1.6 * time + 0.4) + 4.0 * std::sin(0.9 * time); }

struct Answered {
  BalanceAnswer answer;
  std::vector<BalanceLaw> laws;
  double resolved = 0.0;
};

Answered answer_of(SimulatedAxis axis, double factor = 1.0) {
  std::vector<BalanceRecord> records;
  double resolved = 0.0, top = 0.0, low = 1e300, high = -1e300;
  for (const auto& effort : {moves, other_moves}) {
    axis.effort = effort;
    AxisRecord record = record_of(axis);
    ++axis.seed;
    for (double& value : record.effort) value *= factor;
    records.push_back(make_balance_record(record, balance_half_window(record, axis.inertia * factor, 0.25)));
    for (const double speed : records.back().speed) top = std::max(top, std::fabs(speed));
    for (const double position : records.back().position) {
      low = std::min(low, position);
      high = std::max(high, position);
    }
    resolved = std::max(resolved, 3.0 * records.back().speed_noise);
  }
  resolved = std::max(resolved, 2e-3 * top);
  Answered answered;
  answered.resolved = resolved;
  answered.laws = balance_laws({top, resolved, axis.duration, 0.5 * (low + high), 0.5 * (high - low), true, {}});
  answered.answer = fit_balance(records, answered.laws, axis.inertia * factor, resolved);
  return answered;
}

const BalanceTerm* term_of(const BalanceModel& model, const std::string& law) {
  const auto found = std::find_if(model.terms.begin(), model.terms.end(), [&](const BalanceTerm& term) { return term.law == law; });
  return found == model.terms.end() ? nullptr : &*found;
}

SimulatedAxis quiet_axis() {
  SimulatedAxis axis;
  axis.noise = 2e-6;
  return axis;
}

TEST(BalanceFit, NothingIsFoundWhereNothingIs) {
  const BalanceAnswer answer = answer_of(quiet_axis()).answer;
  EXPECT_TRUE(answer.best.terms.empty()) << answer.best.words();
  EXPECT_NEAR(answer.best.inertia, 2.0, 0.01);
}

TEST(BalanceFit, AnInertiaThatIsOffIsAnInertia) {
  SimulatedAxis axis = quiet_axis();
  axis.inertia = 2.6;
  const BalanceAnswer answer = answer_of(axis).answer;
  EXPECT_TRUE(answer.best.terms.empty()) << answer.best.words();
  EXPECT_NEAR(answer.best.inertia, 2.6, 0.02);
}

TEST(BalanceFit, FrictionAndAConstantTorqueBesideAnInertiaThatIsOff) {
  SimulatedAxis axis = quiet_axis();
  axis.inertia = 2.6;
  axis.resistance = [](double, double, double speed) { return 1.2 * std::tanh(speed / 1e-3) + 0.8 * speed + 0.5; };
  const BalanceAnswer answer = answer_of(axis).answer;
  ASSERT_NE(term_of(answer.best, "dry"), nullptr) << answer.best.words();
  ASSERT_NE(term_of(answer.best, "viscous"), nullptr) << answer.best.words();
  ASSERT_NE(term_of(answer.best, "offset"), nullptr) << answer.best.words();
  EXPECT_EQ(answer.best.terms.size(), 3u) << answer.best.words();
  EXPECT_NEAR(answer.best.inertia, 2.6, 0.03);
  EXPECT_NEAR(term_of(answer.best, "dry")->size[0], 1.2, 0.05);
  EXPECT_NEAR(term_of(answer.best, "viscous")->size[0], 0.8, 0.04);
  EXPECT_NEAR(term_of(answer.best, "offset")->size[0], 0.5, 0.03);
  EXPECT_GT(answer.explained, 0.99);
  EXPECT_LT(answer.probability_unknown, 0.02);
}

TEST(BalanceFit, AStribeckCurveBendsDryFriction) {
  SimulatedAxis axis = quiet_axis();
  axis.resistance = [](double, double, double speed) { return (1.0 + 1.0 * std::exp(-std::pow(speed / 0.3, 2))) * std::tanh(speed / 1e-3) + 0.5 * speed; };
  const BalanceAnswer answer = answer_of(axis).answer;
  ASSERT_NE(term_of(answer.best, "stribeck"), nullptr) << answer.best.words();
  EXPECT_NEAR(term_of(answer.best, "stribeck")->size[0], 1.0, 0.4);  // its speed stands on a grid of half a decade
}

TEST(BalanceFit, GravityOnATiltedAxis) {
  SimulatedAxis axis = quiet_axis();
  axis.resistance = [](double, double position, double speed) { return 1.5 * std::sin(position) + 0.6 * speed; };
  const BalanceAnswer answer = answer_of(axis).answer;
  ASSERT_NE(term_of(answer.best, "gravity"), nullptr) << answer.best.words();
  EXPECT_NEAR(term_of(answer.best, "gravity")->size[0], 1.5, 0.08);
  EXPECT_NEAR(term_of(answer.best, "gravity")->size[1], 0.0, 0.08);
  EXPECT_EQ(term_of(answer.best, "dry"), nullptr) << answer.best.words();
}

TEST(BalanceFit, FrictionThatPushesIsNoAnswer) {
  SimulatedAxis axis = quiet_axis();
  axis.resistance = [](double, double, double speed) { return -0.1 * speed; };
  const BalanceAnswer answer = answer_of(axis).answer;
  for (const BalanceTerm& term : answer.best.terms) {
    if (term.family == LawFamily::friction && term.law != "position_friction") {
      EXPECT_GE(term.size[0], 0.0) << term.words;
    }
  }
}

TEST(BalanceFit, WhatNoLawKnowsIsSaidWithItsVariable) {
  SimulatedAxis axis = quiet_axis();
  // A tight spot of the ring: friction there alone. The viscous part holds the axis within a few radians.
  axis.resistance = [](double, double position, double speed) {
    return 0.8 * speed + 3.0 * std::exp(-std::pow((position - 1.5) / 0.5, 2)) * std::tanh(speed / 1e-3);
  };
  const BalanceAnswer answer = answer_of(axis).answer;
  EXPECT_EQ(answer.remainder.variable, "position and direction");
}

// Of a law that is doubted, a family of it alone is no surer than it is; beside a law that is not doubted the family is as sure as that. By hand: 0.6 + 0.1 +
// 0.2 of 0.3; and 0.2 of 0.9.
TEST(BalanceFit, AFamilyIsAsSureAsItsMembersAllow) {
  const auto model = [](double probability, const std::vector<std::string>& laws) {
    BalanceModel made;
    made.probability = probability;
    for (const std::string& law : laws) made.terms.push_back({law, law, law == "lag" ? LawFamily::drive : LawFamily::friction, 0.0, true, {1.0}, {0.1}, 0.0});
    return made;
  };
  BalanceAnswer answer;
  answer.models = {model(0.6, {"dry", "rising"}), model(0.3, {"rising"}), model(0.1, {"dry"})};
  answer.laws = {{"dry", "dry", LawFamily::friction, 0.7}, {"rising", "rising", LawFamily::friction, 0.2 * 0.9, 0.2}};
  EXPECT_NEAR(family_probabilities(answer).front().probability, 0.76, 1e-12);
  // What is told of the models does not contradict what is told of the law: 0.2 of 0.6 and of 0.3 have it.
  EXPECT_NEAR(believed_probability(answer, answer.models[0]), 0.12, 1e-12);
  EXPECT_NEAR(believed_probability(answer, answer.models[1]), 0.06, 1e-12);
  EXPECT_NEAR(believed_probability(answer, answer.models[2]), 0.1, 1e-12);
  answer.models = {model(0.9, {"lag"})};
  answer.laws = {{"lag", "lag", LawFamily::drive, 0.2 * 0.9, 0.2}};
  EXPECT_NEAR(family_probabilities(answer).back().probability, law_probabilities(answer).front().probability, 1e-12);
}

TEST(BalanceFit, MassesAndForcesOfAnySizeGiveTheSameAnswer) {
  SimulatedAxis axis = quiet_axis();
  axis.resistance = [](double, double, double speed) { return 1.2 * std::tanh(speed / 1e-3) + 0.8 * speed; };
  const BalanceAnswer one = answer_of(axis).answer;
  for (const double factor : {1e-6, 1e-3, 1e3}) {
    const BalanceAnswer scaled = answer_of(axis, factor).answer;
    EXPECT_EQ(scaled.best.words(), one.best.words());
    EXPECT_NEAR(scaled.best.probability, one.best.probability, 1e-6);
    EXPECT_NEAR(scaled.best.inertia / factor, one.best.inertia, 1e-6);
    for (std::size_t k = 0; k < one.best.terms.size(); ++k) {
      EXPECT_NEAR(scaled.best.terms[k].size[0] / factor / one.best.terms[k].size[0], 1.0, 1e-6);
    }
  }
}

TEST(BalanceFit, ARecordThatStandsIsRefused) {
  const AxisRecord record{"standing", 0.01, std::vector<double>(2000, 1.0), std::vector<double>(2000, 0.5)};
  const std::vector<BalanceRecord> records{make_balance_record(record, 5)};
  EXPECT_THROW(fit_balance(records, balance_laws({1.0, 1e-3, 20.0, 0.0, 0.0, true, {}}), 1.0, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
