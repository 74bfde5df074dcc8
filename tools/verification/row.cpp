#include "tools/verification/row.h"

#include <cmath>

namespace slewlab::tools {

namespace {

constexpr double kOfRounding = 1e-12;  // relative: some thousand roundings of a double, far below any digit that is printed

}  // namespace

const char* name_of(RowVerdict verdict) {
  switch (verdict) {
    case RowVerdict::kPass: return "pass";
    case RowVerdict::kMisses: return "misses";
    case RowVerdict::kCannotBeReached: return "cannot be reached";
  }
  return "";
}

double deviation(const VerificationRow& row) {
  const double difference = std::fabs(row.ours - row.thesis) <= kOfRounding * std::fabs(row.thesis) ? 0.0 : row.ours - row.thesis;
  return row.criterion == Criterion::kRelative ? difference / row.thesis : difference;
}

VerificationRow judge(VerificationRow row) {
  bool pass = false;
  switch (row.criterion) {
    case Criterion::kRelative:
    case Criterion::kAbsolute: pass = std::fabs(deviation(row)) <= row.tolerance; break;
    case Criterion::kAtMost: pass = row.ours <= row.thesis; break;
    case Criterion::kAtLeast: pass = row.ours >= row.thesis; break;
  }
  row.verdict = pass ? RowVerdict::kPass : RowVerdict::kMisses;
  return row;
}

VerificationRow judge_unreachable(VerificationRow row, const std::string& why) {
  row = judge(std::move(row));
  if (row.verdict == RowVerdict::kMisses) {
    row.verdict = RowVerdict::kCannotBeReached;
    row.note = why;
  }
  return row;
}

namespace {

VerificationRow row(Criterion criterion, std::string id, std::string what, std::string unit, double thesis,
                    double ours, double tolerance, std::string note) {
  return judge({.id = std::move(id),
                .what = std::move(what),
                .unit = std::move(unit),
                .thesis = thesis,
                .ours = ours,
                .criterion = criterion,
                .tolerance = tolerance,
                .verdict = RowVerdict::kMisses,
                .note = std::move(note)});
}

}  // namespace

VerificationRow relative_row(std::string id, std::string what, std::string unit, double thesis, double ours,
                             double tolerance, std::string note) {
  return row(Criterion::kRelative, std::move(id), std::move(what), std::move(unit), thesis, ours, tolerance,
             std::move(note));
}

VerificationRow absolute_row(std::string id, std::string what, std::string unit, double thesis, double ours,
                             double tolerance, std::string note) {
  return row(Criterion::kAbsolute, std::move(id), std::move(what), std::move(unit), thesis, ours, tolerance,
             std::move(note));
}

VerificationRow at_most_row(std::string id, std::string what, std::string unit, double bound, double ours,
                            std::string note) {
  return row(Criterion::kAtMost, std::move(id), std::move(what), std::move(unit), bound, ours, 0.0,
             std::move(note));
}

VerificationRow at_least_row(std::string id, std::string what, std::string unit, double bound, double ours,
                             std::string note) {
  return row(Criterion::kAtLeast, std::move(id), std::move(what), std::move(unit), bound, ours, 0.0,
             std::move(note));
}

}  // namespace slewlab::tools
