// Every section of `slewlab verify` that needs the crane alone is a test: each of its rows must
// pass, or be one that cannot be reached and says why. The expected numbers are the thesis's, row by row.
#include <gtest/gtest.h>

#include "tools/verification/verification.h"

namespace slewlab::tools {
namespace {

class PlantRows : public testing::TestWithParam<VerificationSection> {};

TEST_P(PlantRows, RowsAreReached) {
  SlewRuns runs(load_verification_inputs(std::filesystem::path(SLEWLAB_SOURCE_DIR) / "config"));
  const VerificationRows rows = GetParam().compute(runs);
  ASSERT_FALSE(rows.empty());
  for (const VerificationRow& row : rows) {
    EXPECT_NE(row.verdict, Verdict::kMisses)
        << row.id << " " << row.what << ": thesis " << row.thesis << ", ours " << row.ours << " " << row.unit;
    EXPECT_FALSE(row.verdict == Verdict::kCannotBeReached && row.note.empty()) << row.id << " " << row.what;
  }
}

std::vector<VerificationSection> sections() {
  std::vector<VerificationSection> result;
  for (const VerificationSection& section : verification_sections()) {
    if (section.needs_controller == false) result.push_back(section);
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(Thesis, PlantRows, testing::ValuesIn(sections()),
                         [](const auto& test) { return test.param.id; });

}  // namespace
}  // namespace slewlab::tools
