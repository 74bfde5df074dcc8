// `slewlab withhold make`: draws machines nobody has looked at and writes their logs (docs/withheld.md).
// `slewlab withhold score`: lets a diagnosis judge them, then opens the answers and prints the scores.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "diagnosis/evaluation/score.h"

namespace slewlab::tools {

struct WithholdMakeOptions {
  int cases = 0;
  unsigned long long seed = 0;
  std::string purpose;  // tune or score; empty: what the seed serves
  std::filesystem::path directory;
  std::filesystem::path crane, controller;
  double rate = 1000.0;               // [Hz] of the record
  double controller_period_ms = 0.0;  // 0: as the record
  std::string sensors = "all";        // all, tip or none
  std::string begin = "rest";         // rest, on, motion or any
  std::string laws = "withheld";      // withheld or known
  int threads = 2;
};

// Progress on `out`, problems on `complaints`. Ends early and whole on SIGINT or SIGTERM; to go on, call it again.
// Answers with the exit code: 0, 1 where something is wrong, 128 with the signal's number where it was interrupted.
int withhold_make(const WithholdMakeOptions& options, std::ostream& out, std::ostream& complaints);

// The same for scoring, with the diagnosis that is to be judged. Results that are there already are kept.
int withhold_score(const diagnosis::withheld::ScoreSettings& settings,
                   const diagnosis::withheld::DiagnoseCase& diagnose,
                   const diagnosis::withheld::InformedFit& informed, std::ostream& out, std::ostream& complaints);

struct WithholdScoreOptions {
  std::filesystem::path directory;
  std::string results = "results";
  bool no_accelerometers = false;
  int threads = 2;
  int from = 1;
  int first = 0;  // cases of the set from there on; 0: all
  bool no_informed_fits = false;
  bool second_round = false;
};

// Scores this project's own diagnosis.
int withhold_judge(const WithholdScoreOptions& options, std::ostream& out, std::ostream& complaints);

}  // namespace slewlab::tools
