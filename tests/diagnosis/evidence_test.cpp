#include "diagnosis/evidence.h"

#include <gtest/gtest.h>

#include <numeric>

namespace slewlab::diagnosis {
namespace {

double total(const Probabilities& p) {
  return std::accumulate(p.candidate.begin(), p.candidate.end(), p.unknown);
}

TEST(Evidence, ProbabilitiesSumToOne) {
  const Probabilities p = weigh({{{}, 5.0}, {{"a"}, 1.0}, {{"b"}, 3.0}, {{"a", "b"}, 0.9}}, 40, {});
  EXPECT_NEAR(total(p), 1.0, 1e-12);
}

TEST(Evidence, NothingMissingIsSaidWhereEffectsGainNothing) {
  const Probabilities p = weigh({{{}, 1.0}, {{"a"}, 0.9999}, {{"a", "b"}, 0.9998}}, 40, {});
  EXPECT_GT(p.candidate[0], 0.9);
}

TEST(Evidence, ASecondEffectMustEarnItsPlace) {
  const Probabilities p = weigh({{{}, 20.0}, {{"a"}, 1.0}, {{"a", "b"}, 0.999}}, 40, {});
  EXPECT_GT(p.candidate[1], p.candidate[2]);
}

TEST(Evidence, UnknownWhereEveryCauseLeavesMuchOfALargeGap) {
  const Probabilities p = weigh({{{}, 100.0}, {{"a"}, 60.0}, {{"a", "b"}, 50.0}}, 40, {});
  EXPECT_GT(p.unknown, 0.99);
}

TEST(Evidence, KnownWhereACauseLeavesLittle) {
  const Probabilities p = weigh({{{}, 100.0}, {{"a"}, 1.0}}, 40, {});
  EXPECT_LT(p.unknown, 0.01);
}

TEST(Evidence, WantsTheCandidateWithoutEffects) {
  EXPECT_THROW(weigh({{{"a"}, 1.0}}, 40, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
