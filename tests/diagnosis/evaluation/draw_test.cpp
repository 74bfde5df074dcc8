// Expected numbers: the proportions and bounds that draw.h and issue 4 state.
#include "diagnosis/evaluation/draw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

namespace slewlab::diagnosis::withheld {
namespace {

TEST(Draw, SeedsOfTuningAndScoringAreKeptApart) {
  EXPECT_NO_THROW(check_seed(999, Purpose::kTune));
  EXPECT_NO_THROW(check_seed(1000, Purpose::kScore));
  EXPECT_THROW(check_seed(999, Purpose::kScore), std::invalid_argument);
  EXPECT_THROW(check_seed(1000, Purpose::kTune), std::invalid_argument);
}

TEST(Draw, KindsComeInProportion) {
  std::map<Kind, int> count;
  for (const DrawnCase& drawn : draw_cases(400, 3)) ++count[drawn.kind];
  EXPECT_EQ(count[Kind::kNothing], 60);
  EXPECT_EQ(count[Kind::kParameters], 60);
  EXPECT_EQ(count[Kind::kOneEffect], 160);
  EXPECT_EQ(count[Kind::kTwoEffects], 60);
  EXPECT_EQ(count[Kind::kLeftOut], 30);
  EXPECT_EQ(count[Kind::kNoCatalogue], 30);
}

TEST(Draw, EffectsComeEquallyOften) {
  std::map<std::string, int> count;
  for (const DrawnCase& drawn : draw_cases(400, 3)) {
    if (drawn.kind == Kind::kOneEffect) ++count[drawn.laws[0].law];
  }
  int in_catalogue = 0, fewest = 1000, most = 0;
  for (const Law& law : laws()) {
    if (law.effect.empty()) continue;
    ++in_catalogue;
    fewest = std::min(fewest, count[law.name]);
    most = std::max(most, count[law.name]);
  }
  EXPECT_GE(in_catalogue, 40);
  EXPECT_LE(most - fewest, 1);
}

TEST(Draw, SpreadStaysWithinFivePercentAndNothingMissingHasNone) {
  double lowest = 1.0, highest = 1.0;
  for (const DrawnCase& drawn : draw_cases(200, 4)) {
    ASSERT_EQ(drawn.spread.size(), spread_parameters().size());
    for (const double factor : drawn.spread) {
      if (drawn.kind == Kind::kNothing) {
        EXPECT_EQ(factor, 1.0);
      }
      lowest = std::min(lowest, factor);
      highest = std::max(highest, factor);
    }
  }
  EXPECT_GE(lowest, 0.95);
  EXPECT_LE(highest, 1.05);
  EXPECT_LT(lowest, 0.951);
  EXPECT_GT(highest, 1.049);
}

TEST(Draw, WhatIsLeftOutIsTheTrueEffectAndDecoysNeverAre) {
  int decoys = 0;
  for (const DrawnCase& drawn : draw_cases(300, 5)) {
    std::set<std::string> effects;
    for (const DrawnLaw& law : drawn.laws) effects.insert(law_named(law.law).effect);
    if (drawn.kind == Kind::kLeftOut) {
      ASSERT_EQ(drawn.without.size(), 1u);
      EXPECT_EQ(*effects.begin(), drawn.without[0]);
    } else if (!drawn.without.empty()) {
      ++decoys;
      EXPECT_EQ(effects.count(drawn.without[0]), 0u);
    }
  }
  EXPECT_GT(decoys, 15);  // an eighth of 277 is 35
}

TEST(Draw, SizesKeepToTheirLawsRange) {
  for (const DrawnCase& drawn : draw_cases(300, 6)) {
    for (const DrawnLaw& one : drawn.laws) {
      const Law& law = law_named(one.law);
      EXPECT_GE(one.size, std::min(law.low, law.high) * (1.0 - 1e-12)) << law.name;
      EXPECT_LE(one.size, std::max(law.low, law.high) * (1.0 + 1e-12)) << law.name;
    }
  }
}

TEST(Draw, AtLeastFourLawsAreInNoCatalogue) {
  EXPECT_GE(std::count_if(laws().begin(), laws().end(), [](const Law& law) { return law.effect.empty(); }), 4);
}

TEST(Draw, TwoEffectsDiffer) {
  for (const DrawnCase& drawn : draw_cases(300, 7)) {
    if (drawn.kind == Kind::kTwoEffects) {
      EXPECT_NE(drawn.laws[0].law, drawn.laws[1].law);
    }
  }
}

TEST(Draw, SameSeedSameCases) {
  const std::vector<DrawnCase> one = draw_cases(50, 8), two = draw_cases(50, 8), other = draw_cases(50, 9);
  int same = 0;
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(one[n].spread, two[n].spread);
    EXPECT_EQ(one[n].noise_seeds, two[n].noise_seeds);
    same += one[n].noise_seeds == other[n].noise_seeds ? 1 : 0;
  }
  EXPECT_EQ(same, 0);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
