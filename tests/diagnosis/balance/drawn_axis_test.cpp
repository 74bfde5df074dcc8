// Axes of drawn_axis.h that are decided clearly: what they were given is what has to be said. All kinds and conditions are scored by axis_scores.
#include "tests/diagnosis/balance/drawn_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "sim/machine/machine_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kSure = 0.9;

struct Case {
  const char* kind;
  unsigned seed;
  const char* decisive;  // law that has to be named; "" where nothing may be
};

class DrawnAxisDiagnosis : public testing::TestWithParam<Case> {};

TEST_P(DrawnAxisDiagnosis, SaysWhatItWasGivenAndNothingElseForSure) {
  const DrawnAxis drawn = drawn_axis(GetParam().kind, GetParam().seed);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "axis.yaml";
  std::ofstream(file) << drawn.machine;
  const AxisDiagnosis found = diagnose_axis(sim::load_machine_file(file), drawn.runs);
  const std::string said = found.verdict + " (" + drawn.conditions + ")", decisive = GetParam().decisive;
  const auto& terms = found.answer.best.terms;
  if (decisive.empty()) {
    EXPECT_TRUE(terms.empty()) << said;
    return;
  }
  ASSERT_EQ(found.outcome, AxisOutcome::stated) << said;
  EXPECT_TRUE(std::any_of(terms.begin(), terms.end(), [&](const BalanceTerm& term) { return term.law == decisive; })) << said;
  for (const BalanceTerm& term : terms) {
    EXPECT_TRUE(term.probability < kSure || drawn.laws.contains(term.law) || drawn.alike.contains(term.law)) << term.words << " " << term.probability << ": " << said;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DrawnAxisDiagnosis,
                         testing::Values(Case{"nothing", 12, ""}, Case{"inertia", 11, ""}, Case{"dry_viscous", 11, "dry"}, Case{"offset", 11, "offset"},
                                         Case{"gravity", 11, "gravity"}, Case{"spring", 12, "spring"}, Case{"late", 12, "lag"}, Case{"three", 2, "stribeck"}),
                         [](const auto& one) { return std::string(one.param.kind); });

}  // namespace
}  // namespace slewlab::diagnosis
