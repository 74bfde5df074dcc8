// Every section of `slewlab verify` is a test: each of its rows must pass, or be one that cannot be reached and
// says why. The expected numbers are the thesis's, row by row.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <vector>

#include "tools/verification/verification.h"

namespace slewlab::tools {

inline void PrintTo(const VerificationSection& section, std::ostream* out) { *out << section.id; }

inline void expect_rows_reached(const VerificationSection& section) {
  SlewRuns runs(load_verification_inputs(std::filesystem::path(SLEWLAB_SOURCE_DIR) / "config"));
  const VerificationRows rows = section.compute(runs);
  ASSERT_FALSE(rows.empty());
  for (const VerificationRow& row : rows) {
    EXPECT_NE(row.verdict, RowVerdict::kMisses)
        << row.id << " " << row.what << ": thesis " << row.thesis << ", ours " << row.ours << " " << row.unit;
    EXPECT_FALSE(row.verdict == RowVerdict::kCannotBeReached && row.note.empty()) << row.id << " " << row.what;
  }
}

inline std::vector<VerificationSection> sections_that_need_a_controller(bool needed) {
  std::vector<VerificationSection> result;
  for (const VerificationSection& section : verification_sections()) {
    if (section.needs_controller == needed) result.push_back(section);
  }
  return result;
}

}  // namespace slewlab::tools
