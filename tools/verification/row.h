// One row of the reproduction of the thesis: what it prints, what this code computes, and the verdict.
#pragma once

#include <string>
#include <vector>

namespace slewlab::tools {

enum class Criterion {
  kRelative,  // |ours / thesis - 1| <= tolerance
  kAbsolute,  // |ours - thesis| <= tolerance
  kAtMost,    // ours <= thesis: the thesis gives a bound
  kAtLeast,   // ours >= thesis
};

enum class RowVerdict { kPass, kMisses, kCannotBeReached };
const char* name_of(RowVerdict verdict);

struct VerificationRow {
  std::string id;    // table, figure or section of the thesis
  std::string what;
  std::string unit;
  double thesis = 0.0;
  double ours = 0.0;
  Criterion criterion = Criterion::kRelative;
  double tolerance = 0.0;  // unused for a bound
  RowVerdict verdict = RowVerdict::kMisses;
  std::string note;  // what was compared; why a row cannot be reached
};

inline constexpr double kThesisTolerance = 0.05;  // thesis 2.1: a relative error of 5 % is accepted
inline constexpr double kRounding = 0.01;         // values printed to two or three digits

using VerificationRows = std::vector<VerificationRow>;

// The row with its verdict.
VerificationRow judge(VerificationRow row);

// The same where the thesis's value does not follow from what it gives: a miss becomes kCannotBeReached, and
// the note says why.
VerificationRow judge_unreachable(VerificationRow row, const std::string& why);

// A judged row of each criterion.
VerificationRow relative_row(std::string id, std::string what, std::string unit, double thesis, double ours,
                             double tolerance, std::string note = "");
VerificationRow absolute_row(std::string id, std::string what, std::string unit, double thesis, double ours,
                             double tolerance, std::string note = "");
VerificationRow at_most_row(std::string id, std::string what, std::string unit, double bound, double ours,
                            std::string note = "");
VerificationRow at_least_row(std::string id, std::string what, std::string unit, double bound, double ours,
                             std::string note = "");

// Relative deviation from the thesis; from a value of 0 and for bounds, the difference.
double deviation(const VerificationRow& row);

}  // namespace slewlab::tools
