#include "diagnosis/doubt.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace slewlab::diagnosis {
namespace {

constexpr double kUpper = 10.0;  // end of a size's range

common::EffectCatalogue catalogue() {
  common::EffectCatalogue catalogue;
  for (const char* name : {"a", "b"}) {
    common::EffectAbout& about = catalogue.effects.emplace_back();
    about.name = name;
    about.parameters = {{.name = "size", .unit = common::Unit::newton_metre, .per = common::ScaleOf::one, .meaning = "", .lower = 0.0, .upper = kUpper, .typical = 1.0, .prior_scale = 1.0,
                         .scale = common::ParameterScale::linear, .absent = 0.0}};
  }
  return catalogue;
}

// Of effects of one size each.
Cause cause_of(const std::vector<std::string>& effects, double probability, double size = 1.0) {
  Cause cause;
  cause.effects = effects;
  cause.probability = probability;
  cause.mean_square = 1.0;
  for (const std::string& effect : effects) {
    cause.point.effects.push_back({effect, {size}});
    cause.sizes.push_back({effect + ".size", "N m", size, 0.1, size - 0.1, size + 0.1});
  }
  return cause;
}

double sum_of(const Ranking& ranking) {
  double sum = ranking.unknown;
  for (const Cause& cause : ranking.causes) sum += cause.probability;
  return sum;
}

// Every doubt moves probability, and loses none.
class Doubt : public testing::Test {
 protected:
  void TearDown() override { EXPECT_NEAR(sum_of(ranking), 1.0, 1e-12); }
  double of(std::size_t k) const { return ranking.causes[k].probability; }
  void doubt(bool is_nominal_enough, bool is_nothing_left) { doubt_what_no_machine_has(catalogue(), nuisances, is_nominal_enough, is_nothing_left, ranking, remarks); }

  Ranking ranking;
  Nuisances nuisances;
  std::vector<std::string> remarks;
};

TEST_F(Doubt, WhatParametersDoAsWellIsNotSure) {
  common::EffectCatalogue effects = catalogue();
  effects.effects[1].stands_for = {"load mass"};
  nuisances.parameters = {{"drive inertia", 0.03, {}}, {"load mass", 0.03, {}}, {"boom angle", 0.03, {}}};
  const std::vector<FarParameter> far = far_parameters(nuisances, {1.0, -2.0, 5.0});
  EXPECT_EQ(in_words(far), "boom angle +15 %, load mass -6 %");
  ranking = {{cause_of({"a"}, 0.6), cause_of({"b"}, 0.3), cause_of({}, 0.05)}, 0.05};
  doubt_what_parameters_do_as_well(effects, far, ranking, remarks);
  EXPECT_DOUBLE_EQ(of(0), 0.36);
  EXPECT_EQ(of(1), 0.3);  // which says of the machine what a parameter stands for
  EXPECT_EQ(of(2), 0.05);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("boom angle +15 %"), std::string::npos) << remarks[0];
  doubt_what_parameters_do_as_well(effects, {}, ranking, remarks);
  EXPECT_DOUBLE_EQ(of(0), 0.36);
}

TEST_F(Doubt, WhereTheNominalMachineIsEnoughNothingIsMissing) {
  ranking = {{cause_of({"a"}, 0.7), cause_of({}, 0.1)}, 0.2};
  settle_on_nothing(ranking);
  EXPECT_EQ(of(1), 1.0);
}

// Below the noise a cause that nobody knows is at most as likely as not; a law that was fitted to it stays, as far as unknowns are none of the catalogue's.
TEST_F(Doubt, OfTheUnknownBelowTheNoise) {
  ranking = {{cause_of({}, 0.2)}, 0.8};
  doubt_the_unknown_below_the_noise(0.0, ranking);
  EXPECT_LT(ranking.unknown, of(0));
  EXPECT_GT(ranking.unknown, 0.2);
  const double without_law = ranking.unknown;
  ranking = {{cause_of({}, 0.2)}, 0.8};
  doubt_the_unknown_below_the_noise(0.8, ranking);
  EXPECT_GT(ranking.unknown, without_law);
  EXPECT_GE(ranking.unknown, kOutsideTheCatalogue * 0.8);
  EXPECT_LT(ranking.unknown, 0.8);
}

// A size at the end of its range is not sure: its cause loses, the one with its other effect gains, and the page is told. One within it keeps all.
TEST_F(Doubt, OfASizeAtTheEndOfItsRange) {
  ranking = {{cause_of({"a", "b"}, 0.9), cause_of({"b"}, 0.1)}, 0.0};
  ranking.causes[0].point.effects[0].values[0] = kUpper;
  doubt(false, false);
  EXPECT_LT(of(0), 0.9);
  EXPECT_GT(of(0), of(1));  // it still leads
  EXPECT_EQ(ranking.unknown, 0.0);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("a.size was fitted to the upper end of its range, 10 N m"), std::string::npos) << remarks[0];
  ranking = {{cause_of({"a"}, 1.0)}, 0.0};
  doubt(false, false);
  EXPECT_EQ(of(0), 1.0);
  EXPECT_EQ(remarks.size(), 1U);
}

// An interval beyond the range is cut off there. That the effect acts is not known then, and where the residual of parameters alone is no more than
// noise, nothing is missing.
TEST_F(Doubt, OfASizeThatTheRecordsDoNotDetermine) {
  ranking = {{cause_of({"a"}, 0.9), cause_of({}, 0.1)}, 0.0};
  ranking.causes[0].sizes[0].low = -5.0;
  doubt(false, true);
  EXPECT_EQ(ranking.causes[0].sizes[0].low, 0.0);
  EXPECT_LT(of(0), 0.9);
  EXPECT_EQ(ranking.unknown, 0.0);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("do not determine it"), std::string::npos) << remarks[0];
}

// A size that may be none: the effect may as well not act. One that is known to be there, however small, keeps all.
TEST_F(Doubt, OfASizeThatMayBeNone) {
  const auto left = [&](bool may_be_none) {
    ranking = {{cause_of({"a"}, 0.9), cause_of({}, 0.1)}, 0.0};
    ranking.causes[0].sizes[0].may_be_none = may_be_none;
    remarks.clear();
    doubt(false, true);
    return of(0);
  };
  EXPECT_LT(left(true), 0.9);
  EXPECT_EQ(ranking.unknown, 0.0);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("do not tell it from 0 N m, where the effect is absent"), std::string::npos) << remarks[0];
  EXPECT_EQ(left(false), 0.9);
  EXPECT_TRUE(remarks.empty());
}

// Parameters that no machine of one make has: something may hide in them, beside nothing missing as well, unless the residual of the file's own
// parameters is no more than noise.
TEST_F(Doubt, OfParametersThatNoMachineHas) {
  nuisances.parameters.resize(1);
  const auto with_parameter_at = [&](double deviations, double prior_chance) {
    ranking = {{cause_of({}, 1.0)}, 0.0};
    ranking.causes[0].point.nuisance = {deviations};
    ranking.causes[0].prior_chance = prior_chance;
  };
  with_parameter_at(-2.0 * kFarOff, 1.0);
  doubt(false, false);
  EXPECT_GT(ranking.unknown, 0.2);
  with_parameter_at(0.5 * kFarOff, 0.1 * kFarTogether);
  doubt(false, false);
  EXPECT_GT(ranking.unknown, 0.2);
  with_parameter_at(0.5 * kFarOff, 1.0);
  doubt(false, false);
  EXPECT_EQ(ranking.unknown, 0.0);
  // The odds of one machine in a thousand in which something hides: as likely as the parameters of one in a thousand, and nearly sure of one in a million.
  const auto taken = [&](double prior_chance) {
    with_parameter_at(0.5 * kFarOff, prior_chance);
    doubt(false, false);
    return ranking.unknown;
  };
  EXPECT_NEAR(taken(1e-3), 0.5, 1e-12);
  EXPECT_NEAR(taken(5e-4), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(taken(1e-6), 0.9, 1e-12);
  EXPECT_NEAR(taken(0.9 * kFarTogether), 0.4, 1e-12);
  // The draws of a stochastic effect take the parameters along.
  common::EffectCatalogue with_draws = catalogue();
  with_draws.effects[1].stochastic.emplace();
  ranking = {{cause_of({"a"}, 0.5), cause_of({"b"}, 0.5)}, 0.0};
  for (Cause& cause : ranking.causes) cause.prior_chance = 1e-6;
  doubt_what_no_machine_has(with_draws, nuisances, false, false, ranking, remarks);
  EXPECT_NEAR(of(0), 0.1 * 0.5, 1e-12);
  EXPECT_NEAR(of(1), 0.6 * 0.5, 1e-12);
  with_parameter_at(-2.0 * kFarOff, 1.0);
  doubt(true, false);
  EXPECT_EQ(ranking.unknown, 0.0);
}

// A draw beside a law that explains nearly all alone is not sure: that law may be another one. One beside a law that explains less is, as is a draw alone.
TEST_F(Doubt, OfADrawBesideALaw) {
  common::EffectCatalogue with_draws = catalogue();
  with_draws.effects[1].stochastic.emplace();
  const EvidenceSettings evidence;
  const auto doubted = [&](double explained_alone) {
    ranking = {{cause_of({"b", "a"}, 0.9), cause_of({"a"}, 0.1), cause_of({"b"}, 0.0)}, 0.0};
    ranking.causes[0].explained = 0.99;
    ranking.causes[1].explained = explained_alone;
    remarks.clear();
    doubt_draws_beside_a_law(with_draws, evidence, ranking, remarks);
    return of(0) < 0.9;
  };
  EXPECT_TRUE(doubted(0.95));
  EXPECT_GT(of(0), of(1));
  EXPECT_EQ(of(2), 0.0);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("b adds 4.0 % to the share of the gap explained on the fitted records, beside a"), std::string::npos) << remarks[0];
  EXPECT_FALSE(doubted(0.99 - 1.1 * evidence.unknown_share));
  EXPECT_TRUE(remarks.empty());
  ranking = {{cause_of({"b"}, 1.0)}, 0.0};
  doubt_draws_beside_a_law(with_draws, evidence, ranking, remarks);
  EXPECT_EQ(of(0), 1.0);
}

// What is unknown may be a known effect's with another law: causes share by their evidence, but none passes the unknown by it that predicted nothing, and none gets anything for a law that stands beside it.
TEST_F(Doubt, WhetherTheUnknownIsAnotherLaw) {
  ranking = {{cause_of({"a"}, 0.2), cause_of({"b"}, 0.2), cause_of({}, 0.1)}, 0.5};
  ranking.causes[1].with_unknown_law = 1.0;
  share_with_other_laws(ranking);
  EXPECT_GT(of(0), 0.2);
  EXPECT_EQ(of(1), 0.2);
  EXPECT_EQ(of(2), 0.1);
  ranking = {{cause_of({"a"}, 0.49)}, 0.51};
  share_with_other_laws(ranking);
  EXPECT_GE(ranking.unknown, of(0));
  ranking = {{cause_of({"a"}, 0.49)}, 0.51};
  ranking.causes[0].validation = Validation{};
  ranking.causes[0].validation->holds = true;
  share_with_other_laws(ranking);
  EXPECT_GT(of(0), ranking.unknown);
}

// By the priors: of one effect that is the controller's, or of two of which one is.
TEST_F(Doubt, WhereTheControllersAnswersCouldNotBeCompared) {
  const EvidenceSettings evidence;
  ranking = {{cause_of({}, 1.0)}, 0.0};
  leave_room_for_the_controller(10, 40, evidence, ranking);
  const double room = evidence.prior_single / 4.0 + evidence.prior_pair * (1.0 - 9.0 / 16.0);
  EXPECT_NEAR(of(0), evidence.prior_nothing / (evidence.prior_nothing + room), 1e-12);
}

// The room of what the records hide is by its odds, and never so large that nothing missing does not lead.
TEST_F(Doubt, OfWhatTheRecordsHide) {
  ranking = {{cause_of({}, 0.8), cause_of({"a"}, 0.2)}, 0.0};
  double hidden = leave_room_for_the_hidden({0.25, {}}, ranking);
  EXPECT_NEAR(hidden, 0.2 * 0.8, 1e-12);
  EXPECT_NEAR(of(0) + hidden, 0.8, 1e-12);
  ranking = {{cause_of({}, 0.5), cause_of({"a"}, 0.4)}, 0.1};
  hidden = leave_room_for_the_hidden({1e6, {}}, ranking);
  EXPECT_NEAR(of(0), 0.4, 1e-12);
  ranking.unknown += hidden;
  EXPECT_EQ(leave_room_for_the_hidden({1e6, {}}, ranking = {{cause_of({"a"}, 0.6), cause_of({}, 0.4)}, 0.0}), 0.0);
}

// One effect alone may hide a second one, and an answer whose residual is more than noise may be another: neither is sure. From two effects whose
// residual is noise nothing is taken.
TEST_F(Doubt, OfTheLead) {
  ranking = {{cause_of({"a", "b"}, 1.0)}, 0.0};
  calibrate_lead(ranking);
  EXPECT_EQ(of(0), 1.0);
  ranking = {{cause_of({"b"}, 0.0), cause_of({"a"}, 1.0)}, 0.0};
  calibrate_lead(ranking);
  EXPECT_EQ(name_of(ranking.causes[0]), "a");
  EXPECT_LT(of(0), 0.9);
  EXPECT_GT(of(0), 0.85);
  for (const std::vector<std::string>& effects : {std::vector<std::string>{}, {"a", "b"}}) {
    ranking = {{cause_of(effects, 1.0)}, 0.0};
    ranking.causes[0].mean_square = 2.0;
    calibrate_lead(ranking);
    EXPECT_LT(of(0), 0.9);
    EXPECT_GT(of(0), ranking.unknown);
  }
}

// Commands between the rows of a record are lost to it, as commands are that the wire loses.
// Of sizes of 1 s: within a row of 2 s, and beyond one of half a second.
TEST_F(Doubt, OfADelayWithinARowThatMayHoldUntilTheNext) {
  common::EffectCatalogue late = catalogue();
  late.effects[0].acts_late = true;
  for (const double row : {2.0, 0.5}) {
    ranking = {{cause_of({"a"}, 0.6), cause_of({"a", "b"}, 0.2), cause_of({"b"}, 0.1)}, 0.1};
    remarks.clear();
    doubt_what_held_rows_do(late, row, ranking, remarks);
    const bool is_within = row > 1.0;
    EXPECT_NEAR(of(0), is_within ? 0.36 : 0.6, 1e-12);  // a doubted cause loses 0.4
    EXPECT_NEAR(of(1), is_within ? 0.12 : 0.2, 1e-12);
    EXPECT_EQ(remarks.size(), is_within ? 1u : 0u);
  }
  EXPECT_NEAR(of(2), 0.1, 1e-12);
}

TEST_F(Doubt, OfWhatTheWireLosesByChanceWhereCommandsMayLieBetweenTheRows) {
  common::EffectCatalogue wired = catalogue();
  wired.effects[0].subsystem = common::Subsystem::wire;
  wired.effects[0].stochastic = common::Stochastic{};
  const auto doubt_chance = [&](bool may_hide_commands) {
    ranking = {{cause_of({"a"}, 0.6), cause_of({"a", "b"}, 0.2), cause_of({"b"}, 0.1)}, 0.1};
    remarks.clear();
    doubt_chance_on_the_wire(wired, may_hide_commands, ranking, remarks);
  };
  doubt_chance(false);
  EXPECT_EQ(of(0), 0.6);
  EXPECT_TRUE(remarks.empty());
  doubt_chance(true);
  EXPECT_NEAR(of(0), 0.36, 1e-12);  // a doubted cause loses 0.4
  EXPECT_NEAR(of(1), 0.12, 1e-12);
  EXPECT_NEAR(of(2) + ranking.unknown, 0.52, 1e-12);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("faster than the recorder"), std::string::npos);
}

// A tenth of a hertz of one accelerometer and hardly anything else: the sensor's own offset does it as well. What the torques have seen too is no matter of that sensor.
TEST_F(Doubt, OfWhatAnOffsetThatWandersDoes) {
  ranking = {{cause_of({"a"}, 0.5), cause_of({"b"}, 0.2), cause_of({}, 0.2)}, 0.1};
  doubt_what_an_offset_does([](const Cause& cause) { return ChannelShare{"tip acceleration", cause.effects.front() == "a" ? 0.97 : 0.3}; }, 0.1, ranking, remarks);
  EXPECT_NEAR(of(0), 0.3, 1e-12);  // a doubted cause loses 0.4
  EXPECT_EQ(of(1), 0.2);
  EXPECT_EQ(of(2), 0.2);
  EXPECT_NEAR(ranking.unknown, 0.3, 1e-12);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("a is not sure: 97 % of what it explains is in the tip acceleration below 0.1 Hz"), std::string::npos) << remarks[0];
}

TEST_F(Doubt, GainsOfAccelerometersTakeWhatTheyExplain) {
  ranking = {{cause_of({}, 0.05), cause_of({"a"}, 0.8), cause_of({"b"}, 0.1)}, 0.05};
  doubt_what_gains_do([](const Cause& cause) { return GainsInstead{cause.effects.front() == "a" ? 0.5 : 0.0, "", "tip accelerometer gain 1.040 (+-0.002)"}; }, ranking, remarks);
  EXPECT_NEAR(of(0), 0.05, 1e-12);
  EXPECT_NEAR(of(1), 0.4, 1e-12);
  EXPECT_NEAR(of(2), 0.1, 1e-12);
  EXPECT_NEAR(ranking.unknown, 0.45, 1e-12);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("tip accelerometer gain 1.040 (+-0.002)"), std::string::npos) << remarks[0];
}

TEST_F(Doubt, GainsBesideAnEffectHandOnToIt) {
  ranking = {{cause_of({}, 0.0), cause_of({"a", "b"}, 0.8), cause_of({"a"}, 0.1), cause_of({"b"}, 0.05)}, 0.05};
  doubt_what_gains_do([](const Cause& cause) { return cause.effects.size() == 2 ? GainsInstead{0.5, "a", "tip accelerometer gain 1.040 (+-0.002)"} : GainsInstead{}; }, ranking, remarks);
  EXPECT_NEAR(of(1), 0.4, 1e-12);
  EXPECT_NEAR(of(2), 0.5, 1e-12);
  EXPECT_NEAR(of(3), 0.05, 1e-12);
  EXPECT_NEAR(ranking.unknown, 0.05, 1e-12);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("as well beside a: tip"), std::string::npos) << remarks[0];
}

}  // namespace
}  // namespace slewlab::diagnosis
