// Scores of results written by hand, counted by hand.
#include "diagnosis/evaluation/score_table.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace slewlab::diagnosis::withheld {
namespace {

Judged judged(Kind kind, const std::vector<std::string>& effects, double visibility, std::vector<NamedCause> causes,
              double unknown, bool gap) {
  Judged one;
  one.answer.name = one.result.name = "case";
  one.answer.kind = kind;
  one.answer.visibility = visibility;
  for (const std::string& effect : effects) {
    one.answer.effects.push_back({"a law", effect, "drive", {{"size", 2.0, true}, {"shape", 1.0, false}}, visibility, ""});
  }
  one.result.causes = std::move(causes);
  one.result.probability_unknown = unknown;
  one.result.gap = gap;
  one.result.subsystems = {{"drive", 0.9}, {"house", 0.1}};
  return one;
}

NamedCause cause(const std::vector<std::string>& effects, double probability, const std::vector<std::string>& group = {}) {
  NamedCause one{effects, probability, group, {}, 0.0, 0.0, {}};
  for (const std::string& effect : effects) one.sizes.push_back({effect, "size", 2.1, 1.9, 2.3});
  return one;
}

const Score& score_named(const ScoreTable& table, const std::string& name) {
  for (const auto* list : {&table.scores, &table.also}) {
    for (const Score& score : *list) {
      if (score.name == name) return score;
    }
  }
  throw std::invalid_argument(name);
}

TEST(Score, FalseAlarmsCountNothingAndParametersAlone) {
  const ScoreTable table = tabulate({judged(Kind::kNothing, {}, 0, {cause({}, 1.0)}, 0, false),
                                     judged(Kind::kParameters, {}, 0, {cause({}, 0.9)}, 0.1, false),
                                     judged(Kind::kParameters, {}, 0, {cause({"lag"}, 0.9)}, 0.1, true),
                                     judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "false alarms").value, 1.0 / 3.0);
  EXPECT_EQ(score_named(table, "false alarms").cases, 3);
  EXPECT_FALSE(score_named(table, "false alarms").reached());
  EXPECT_DOUBLE_EQ(score_named(table, "detection").value, 1.0);
}

// Above six floors an effect is plain to see, above three it is visible.
TEST(Score, OnlyEffectsThatArePlainToSeeMustBeDetected) {
  const ScoreTable table = tabulate({judged(Kind::kOneEffect, {"lag"}, 2.9, {cause({}, 1.0)}, 0, false),
                                     judged(Kind::kOneEffect, {"lag"}, 5.9, {cause({}, 1.0)}, 0, false),
                                     judged(Kind::kOneEffect, {"lag"}, 6.1, {cause({"lag"}, 1.0)}, 0, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "detection").value, 1.0);
  EXPECT_EQ(score_named(table, "detection").cases, 1);
  EXPECT_DOUBLE_EQ(score_named(table, "detection, visible effects").value, 0.5);
  EXPECT_DOUBLE_EQ(score_named(table, "detection, all effects").value, 1.0 / 3.0);
}

// Of the three answers above 0.9 whose truth can be known one is wrong; 0.85 is not sure, and nobody can know what 2.9 floors show.
TEST(Score, OfTheSureAnswersTheWrongOnesAreCounted) {
  const ScoreTable table = tabulate({judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.95)}, 0, true),
                                     judged(Kind::kOneEffect, {"lag"}, 9, {cause({"wind"}, 0.95)}, 0, true),
                                     judged(Kind::kOneEffect, {"lag"}, 9, {cause({"wind"}, 0.85)}, 0, true),
                                     judged(Kind::kOneEffect, {"lag"}, 2.9, {cause({}, 0.95)}, 0, false),
                                     judged(Kind::kParameters, {}, 0, {cause({}, 0.95)}, 0, false)});
  const Score score = score_named(table, "stated above 0.9 and wrong");
  EXPECT_EQ(score.cases, 3);
  EXPECT_DOUBLE_EQ(score.value, 1.0 / 3.0);
}

TEST(Score, ADeclaredGroupIsOneAnswer) {
  const ScoreTable table =
      tabulate({judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0, true),                    // by its share 1
                judged(Kind::kOneEffect, {"lag"}, 9, {cause({"delay"}, 0.9, {"lag", "loss"})}, 0, true),  // 1/3
                judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9, {"delay"})}, 0, true),          // 1/2
                judged(Kind::kOneEffect, {"lag"}, 9, {cause({"wind"}, 0.9), cause({"lag"}, 0.1)}, 0, true)});  // 0, in three
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right").value, 0.75);
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right, by the group's size").value, (1.0 + 1.0 / 3.0 + 0.5) / 4.0);
  EXPECT_DOUBLE_EQ(score_named(table, "true cause in the first three").value, 1.0);
  EXPECT_DOUBLE_EQ(score_named(table, "mean probability on the true cause").value, (0.9 + 0.0 + 0.9 + 0.1) / 4.0);
}

// An answer that was right stays right; one that was not is what it has become with one more manoeuvre.
TEST(Score, TheSecondRoundIsCountedBesides) {
  std::vector<Judged> cases(3, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.95)}, 0, true));
  for (Judged& one : cases) one.proposed = one.drawn = one.result;
  cases[1].result.causes = {cause({"wind"}, 0.5), cause({"lag"}, 0.4)};
  cases[2].result.causes = cases[2].proposed->causes = cases[2].drawn->causes = cases[1].drawn->causes = cases[1].result.causes;
  const ScoreTable table = tabulate(cases);
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right").value, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right after one proposed manoeuvre").value, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right after one drawn manoeuvre").value, 1.0 / 3.0);
  EXPECT_EQ(score_named(tabulate({judged(Kind::kOneEffect, {"lag"}, 9, {}, 1, true)}), "first cause right after one proposed manoeuvre").cases, 0);
}

// Of the unknown the variable counts where the law follows one and the unknown was answered; one of several that cannot be told apart is enough.
TEST(Score, TheUnknownsVariableIsCounted) {
  std::vector<Judged> cases(5, judged(Kind::kNoCatalogue, {""}, 9, {}, 0.9, true));
  for (Judged& one : cases) one.answer.effects[0].follows = "angle";
  cases[0].result.follows = {"angle"};
  cases[1].result.follows = {"time", "angle"};
  cases[2].result.follows = {"speed"};
  cases[3].result.causes = {cause({"wind"}, 0.95)};  // not answered as unknown
  cases[4].answer.effects[0].follows = "";
  const Score score = score_named(tabulate(cases), "its variable right");
  EXPECT_EQ(score.cases, 3);
  EXPECT_DOUBLE_EQ(score.value, 2.0 / 3.0);
}

// One effect and two of which it is one say together that it acts: 0.9 is right of a single effect, and of a pair of which the other
// effect was not named.
TEST(Score, AnEffectActsInAllAnswersThatNameIt) {
  const std::vector<NamedCause> answers{cause({"lag"}, 0.6), cause({"lag", "wind"}, 0.3), cause({"wind"}, 0.1)};
  const ScoreTable table = tabulate({judged(Kind::kOneEffect, {"lag"}, 9, answers, 0, true),
                                     judged(Kind::kTwoEffects, {"lag", "loss"}, 9, answers, 0, true),
                                     judged(Kind::kOneEffect, {"heel"}, 9, answers, 0, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "mean probability that the true effect acts").value, 0.5 * (0.9 + 0.0));
  EXPECT_EQ(score_named(table, "mean probability that the true effect acts").cases, 2);
  EXPECT_NEAR(score_named(table, "calibration error, most probable effect").value, 0.9 - 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(score_named(table, "calibration error").value, 0.6 - 1.0 / 3.0, 1e-12);
}

TEST(Score, UnknownIsDueOutsideTheCatalogueAndWrongWithin) {
  const ScoreTable table = tabulate({judged(Kind::kLeftOut, {"lag"}, 9, {cause({"wind"}, 0.3)}, 0.7, true),
                                     judged(Kind::kNoCatalogue, {""}, 9, {cause({"wind"}, 0.8)}, 0.2, true),
                                     judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.4)}, 0.6, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "\"outside the catalogue\" where due").value, 0.5);
  EXPECT_DOUBLE_EQ(score_named(table, "first cause right").value, 0.0);
  EXPECT_EQ(table.confusion.at("lag (left out)").at("outside the catalogue"), 1);
  EXPECT_EQ(table.confusion.at("lag").at("outside the catalogue"), 1);
  EXPECT_EQ(table.failures.size(), 2u);
}

// To refuse is not to say that a cause is in no catalogue.
TEST(Score, ARefusalIsRightNowhere) {
  Judged refused = judged(Kind::kLeftOut, {"lag"}, 9, {}, 0.0, false);
  refused.result.refusal = "gears that knock all the time";
  const ScoreTable table = tabulate({refused});
  EXPECT_DOUBLE_EQ(score_named(table, "\"outside the catalogue\" where due").value, 0.0);
  EXPECT_EQ(table.failures.size(), 1u);
}

TEST(Score, BothOfTwoAreNamedTogetherInAnyOrder) {
  const ScoreTable table =
      tabulate({judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"wind", "lag"}, 0.8)}, 0, true),
                judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"lag"}, 0.8)}, 0, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "both of two effects named").value, 0.5);
}

// A declared group names pairs as it names single effects; a pair of which it holds one effect alone is not named.
TEST(Score, ADeclaredGroupOfPairsIsOneAnswer) {
  const ScoreTable table =
      tabulate({judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"wind", "delay"}, 0.8, {"wind with loss", "wind with lag"})}, 0, true),
                judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"wind", "delay"}, 0.8, {"wind with loss", "lag with heel"})}, 0, true)});
  EXPECT_DOUBLE_EQ(score_named(table, "both of two effects named").value, 0.5);
}

// A pair of which one alone changes no signal by three floors is a pair like any other, but not one of two visible effects.
TEST(Score, PairsOfTwoVisibleEffectsAreCountedBesides) {
  std::vector<Judged> cases{judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"wind", "lag"}, 0.8)}, 0, true),
                            judged(Kind::kTwoEffects, {"lag", "wind"}, 9, {cause({"lag"}, 0.8)}, 0, true)};
  cases[1].answer.effects[1].visibility = 2.9;
  EXPECT_DOUBLE_EQ(score_named(tabulate(cases), "both of two effects named").value, 0.5);
  const Score score = score_named(tabulate(cases), "both of two effects named, each visible");
  EXPECT_DOUBLE_EQ(score.value, 1.0);
  EXPECT_EQ(score.cases, 1);
}

// Four answers of 0.9, three of them right: stated 0.9, right 0.75.
TEST(Score, CalibrationErrorIsTheDistanceBetweenStatedAndRight) {
  std::vector<Judged> cases(4, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true));
  cases[3].answer.effects[0].effect = "wind";
  EXPECT_NEAR(score_named(tabulate(cases), "calibration error").value, 0.15, 1e-12);
}

// Three of four: Laplace's share is (3 + 1) / (4 + 2), its deviation sqrt(2/3 1/3 / 4) = 0.236, 1.96 of that 0.462; the
// interval about 0.15 ends at 0 below. With a hundred times the cases it is ten times as narrow: 1.96 sqrt(0.75 0.25 / 400).
TEST(Score, CalibrationErrorCarriesAnIntervalThatNarrowsWithTheCases) {
  std::vector<Judged> cases(4, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true));
  cases[3].answer.effects[0].effect = "wind";
  const Score few = score_named(tabulate(cases), "calibration error");
  EXPECT_DOUBLE_EQ(few.low, 0.0);
  EXPECT_NEAR(few.high, 0.15 + 0.462, 1e-3);
  std::vector<Judged> many;
  for (int i = 0; i < 100; ++i) many.insert(many.end(), cases.begin(), cases.end());
  const Score sure = score_named(tabulate(many), "calibration error");
  EXPECT_NEAR(sure.low, 0.15 - 0.0424, 1e-3);
  EXPECT_NEAR(sure.high, 0.15 + 0.0424, 1e-3);
}

TEST(Score, CoverageCountsComparableSizesOfRightAnswers) {
  std::vector<Judged> cases(2, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true));
  cases[1].answer.effects[0].sizes[0].value = 3.0;  // outside 1.9 ... 2.3
  const Score score = score_named(tabulate(cases), "90 % intervals that cover");
  EXPECT_EQ(score.cases, 2);
  EXPECT_DOUBLE_EQ(score.value, 0.5);
}

TEST(Score, GapClosedIsMeasuredAgainstTheInformedFit) {
  std::vector<Judged> cases(2, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true));
  cases[0].result.unseen_before = 10.0;
  cases[0].result.unseen_after = 2.8;
  cases[0].unseen_informed = 2.0;  // 7.2 of 8
  cases[1].result.unseen_before = 10.0;
  cases[1].unseen_informed = 9.5;  // nothing to close
  const Score score = score_named(tabulate(cases), "share of the gap closed");
  EXPECT_EQ(score.cases, 1);
  EXPECT_NEAR(score.value, 0.9, 1e-12);
}

// Wilson's interval for 8 of 10 at 95 %: 0.490 ... 0.943 (Wilson 1927, worked with z = 1.96).
TEST(Score, SharesCarryWilsonsInterval) {
  std::vector<Judged> cases(10, judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9)}, 0.1, true));
  cases[0].result.gap = cases[1].result.gap = false;
  const Score score = score_named(tabulate(cases), "detection");
  EXPECT_DOUBLE_EQ(score.value, 0.8);
  EXPECT_NEAR(score.low, 0.490, 0.001);
  EXPECT_NEAR(score.high, 0.943, 0.001);
}

TEST(Score, ResultsSurviveTheirJson) {
  CaseResult result = judged(Kind::kOneEffect, {"lag"}, 9, {cause({"lag"}, 0.9, {"delay"})}, 0.1, true).result;
  result.unseen_before = 3.0;
  result.causes[0].sizes[0].high = std::numeric_limits<double>::infinity();
  result.follows = {"speed", "time"};
  result.next = Manoeuvre{{{0.5, 0.3}, {2.0, -1.0}}, 6.8};
  const CaseResult back = result_from(nlohmann::json::parse(to_json(result).dump()));
  EXPECT_EQ(back.causes[0].effects, result.causes[0].effects);
  EXPECT_EQ(back.causes[0].group, result.causes[0].group);
  EXPECT_EQ(back.causes[0].sizes[0].high, result.causes[0].sizes[0].high);
  EXPECT_EQ(back.subsystems, result.subsystems);
  EXPECT_EQ(back.unseen_before, 3.0);
  EXPECT_EQ(back.follows, result.follows);
  EXPECT_FALSE(back.drawn);
  ASSERT_TRUE(back.next);
  EXPECT_EQ(back.next->duration, 6.8);
  ASSERT_EQ(back.next->requests.size(), 2u);
  EXPECT_EQ(back.next->requests[1].time, 2.0);
  EXPECT_EQ(back.next->requests[1].speed_request, -1.0);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
