// How right the diagnosis of a plain axis is, on axes drawn by drawn_axis.h: one line per axis, then the table of docs/axis.md.
//
//   axis_scores FIRST_SEED COUNT [KIND...]
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "sim/machine/machine_file.h"
#include "tests/common/number_argument.h"
#include "tests/diagnosis/balance/drawn_axis.h"
#include "tests/diagnosis/balance/least_squares.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kSure = 0.9;      // probability from which a law is stated as sure
constexpr double kYardstick = 1.1;  // times least squares, aimed at on data that were not fitted

struct Tally {
  int all = 0, refused = 0, stated = 0, nothing = 0, cannot_tell = 0, unknown = 0;
  int unknown_said = 0, wrong_and_sure = 0, every_law = 0, family = 0, beyond_balance = 0, beyond_forward = 0, predicted = 0;
};

sim::MachineFile machine_of(const DrawnAxis& drawn) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "axis.yaml";
  std::ofstream(file) << drawn.machine;
  return sim::load_machine_file(file);
}

void judge(const std::string& kind, unsigned seed, Tally& tally) {
  const DrawnAxis drawn = drawn_axis(kind, seed);
  ++tally.all;
  std::string outcome, error, laws;
  double balance = 0.0, forward = 0.0;
  try {
    const sim::MachineFile axis = machine_of(drawn);
    const AxisDiagnosis found = diagnose_axis(axis, drawn.runs);
    const bool is_named = found.outcome == AxisOutcome::stated && !found.answer.best.terms.empty();
    bool is_wrong = false, is_all = drawn.laws.empty() == found.answer.best.terms.empty();
    for (const BalanceTerm& term : found.answer.best.terms) {
      laws += fmt::format(" {} {:.2f}", term.law, term.probability);
      if (is_named && term.probability >= kSure && !drawn.laws.contains(term.law) && !drawn.alike.contains(term.law)) is_wrong = true;
    }
    for (const std::string& law : drawn.laws) {
      is_all = is_all && std::any_of(found.answer.best.terms.begin(), found.answer.best.terms.end(), [&](const BalanceTerm& term) { return term.law == law; });
    }
    const bool is_unknown = found.outcome == AxisOutcome::unknown;
    tally.unknown_said += is_unknown || found.has_remainder;
    const bool is_friction = std::any_of(found.answer.best.terms.begin(), found.answer.best.terms.end(), [](const BalanceTerm& term) { return term.family == LawFamily::friction; });
    outcome = is_named ? "stated" : is_unknown ? "unknown" : found.outcome == AxisOutcome::not_identifiable ? "cannot tell" : "nothing";
    tally.stated += outcome == "stated";
    tally.nothing += outcome == "nothing";
    tally.unknown += outcome == "unknown";
    tally.cannot_tell += outcome == "cannot tell";
    tally.wrong_and_sure += is_wrong;
    tally.every_law += is_all && (is_named || drawn.laws.empty());
    tally.family += drawn.laws.empty() ? !is_named : is_named && is_friction;
    if (is_wrong) error = "WRONG AND SURE ";
    const Split split = split_of(axis, drawn.runs, drawn.unseen);
    const UnseenErrors ours = predicted(split, found), theirs = least_squares(split);
    balance = ours.balance / theirs.balance;
    forward = ours.forward / theirs.forward;
    ++tally.predicted;
    tally.beyond_balance += balance > kYardstick;
    tally.beyond_forward += forward > kYardstick;
    for (const BalanceTerm& term : found.answer.best.details) laws += fmt::format(" [{} {:.2f}]", term.law, term.probability);
    for (const BalanceTerm& term : found.answer.best.terms) if (term.law == "lag") laws += fmt::format(" (lag {:.3g} s)", term.size[0]);
    laws += fmt::format(" | skew {:.2g} ms", 1e3 * found.answer.best.skew);
    laws += fmt::format(" | unknown {:.2f} | {}", found.answer.probability_unknown, found.verdict);
  } catch (const NoBalance& problem) {
    outcome = "refused";
    laws = fmt::format(" {}", problem.what());
    ++tally.refused;
  }
  fmt::print("{:12} {:4} {}{:11} balance {:.3f} forward {:.3f} |{} | {}\n", kind, seed, error, outcome, balance, forward, laws, drawn.conditions);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: axis_scores FIRST_SEED COUNT [KIND...]\n");
    return 2;
  }
  std::vector<std::string> kinds(argv + 3, argv + argc);
  if (kinds.empty()) kinds = drawn_kinds();
  const auto first = number_argument(argc, argv, 1, 0u), count = number_argument(argc, argv, 2, 0u);
  std::map<std::string, Tally> tallies;
  for (const std::string& kind : kinds) {
    for (unsigned k = 0; k < count; ++k) judge(kind, first + k, tallies[kind]);
  }
  fmt::print("\n| kind | axes | stated | nothing | cannot tell | unknown | unknown or beside | refused | wrong and sure | every law | friction first | balance > 1.1 | forward > 1.1 |\n"
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  Tally all;
  const auto line = [](const std::string& name, const Tally& t) {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", name, t.all, t.stated, t.nothing, t.cannot_tell, t.unknown, t.unknown_said, t.refused,
               t.wrong_and_sure, t.every_law, t.family, t.beyond_balance, t.beyond_forward);
  };
  for (const std::string& kind : kinds) {
    const Tally& t = tallies[kind];
    line(kind, t);
    all = {all.all + t.all, all.refused + t.refused, all.stated + t.stated, all.nothing + t.nothing, all.cannot_tell + t.cannot_tell, all.unknown + t.unknown,
           all.unknown_said + t.unknown_said, all.wrong_and_sure + t.wrong_and_sure, all.every_law + t.every_law, all.family + t.family, all.beyond_balance + t.beyond_balance,
           all.beyond_forward + t.beyond_forward, all.predicted + t.predicted};
  }
  line("all", all);
  return 0;
}

}  // namespace
}  // namespace slewlab::diagnosis

int main(int argc, char** argv) { return slewlab::diagnosis::run(argc, argv); }
