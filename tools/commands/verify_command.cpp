#include "tools/commands/verify_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "common/input_error.h"
#include "tools/verification/verification.h"

namespace slewlab::tools {

namespace {

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string tolerance_of(const VerificationRow& row) {
  switch (row.criterion) {
    case Criterion::kRelative: return fmt::format("{:.3g} %", 100.0 * row.tolerance);
    case Criterion::kAbsolute: return row.tolerance == 0.0 ? "exact" : fmt::format("+-{:.3g}", row.tolerance);
    case Criterion::kAtMost: return "at most";
    case Criterion::kAtLeast: return "at least";
  }
  return "";
}

std::string deviation_of(const VerificationRow& row) {
  return row.criterion == Criterion::kRelative ? fmt::format("{:+.2f} %", 100.0 * deviation(row))
                                               : fmt::format("{:+.3g}", deviation(row));
}

const char* name_of(Criterion criterion) {
  switch (criterion) {
    case Criterion::kRelative: return "relative";
    case Criterion::kAbsolute: return "absolute";
    case Criterion::kAtMost: return "at most";
    case Criterion::kAtLeast: return "at least";
  }
  return "";
}

nlohmann::json to_json(const VerificationRow& row) {
  return {{"id", row.id},
          {"what", row.what},
          {"unit", row.unit},
          {"thesis", row.thesis},
          {"ours", row.ours},
          {"deviation", deviation(row)},
          {"criterion", name_of(row.criterion)},
          {"tolerance", row.tolerance},
          {"verdict", tools::name_of(row.verdict)},
          {"note", row.note}};
}

}  // namespace

int verify(const VerifyOptions& options, std::ostream& out, std::ostream& complaints) {
  VerificationInputs inputs;
  try {
    inputs = load_verification_inputs(options.config_directory);
  } catch (const common::InputError& error) {
    complaints << error.what() << '\n';
    return 2;
  }
  SlewRuns runs(inputs);
  nlohmann::json rows = nlohmann::json::array();
  int passed = 0, missed = 0, unreachable = 0;
  if (!options.json) {
    out << fmt::format("{:<8} {:<78} {:>10} {:>10} {:<8} {:>10} {:>9}  {}\n", "thesis", "what", "thesis", "ours",
                       "unit", "deviation", "tolerance", "verdict");
  }
  for (const VerificationSection& section : verification_sections()) {
    for (const VerificationRow& row : section.compute(runs)) {
      (row.verdict == RowVerdict::kPass ? passed : row.verdict == RowVerdict::kMisses ? missed : unreachable) += 1;
      if (options.json) {
        rows.push_back(to_json(row));
        continue;
      }
      out << fmt::format("{:<8} {:<78} {:>10} {:>10} {:<8} {:>10} {:>9}  {}\n", row.id, row.what, number(row.thesis),
                         number(row.ours), row.unit, deviation_of(row), tolerance_of(row), name_of(row.verdict));
      if (!row.note.empty()) out << fmt::format("{:<9}{}\n", "", row.note);
    }
  }
  if (options.json) {
    out << nlohmann::json{{"rows", rows},
                          {"passed", passed},
                          {"missed", missed},
                          {"cannot_be_reached", unreachable}}
               .dump(2)
        << '\n';
  } else {
    out << fmt::format("{} rows pass, {} miss, {} cannot be reached\n", passed, missed, unreachable);
  }
  return missed == 0 ? 0 : 1;
}

}  // namespace slewlab::tools
