// Lets a diagnosis judge a set of withheld cases and opens the answers when every case is answered. What is counted stands in score_table.h.
//
// Second round: where a result proposes a manoeuvre, the case's machine drives it, it is diagnosed together with the others (<case>.proposed.json), and so is
// one that was drawn (<case>.drawn.json).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evaluation/score_table.h"

namespace slewlab::diagnosis::withheld {

// What is given for one case. `unseen` is for judging what was found, after it was found.
struct CaseInput {
  std::string name;
  std::filesystem::path crane, controller;
  double controller_period = 0.0;  // [s]
  std::vector<std::filesystem::path> logs;
  std::filesystem::path unseen;
  std::vector<std::string> without;  // effects that the diagnosis must not know
};
using DiagnoseCase = std::function<CaseResult(const CaseInput&)>;
// The size of the gap in the unseen manoeuvre, in the same unit, for a fit that is told the true effects.
using InformedFit = std::function<double(const CaseInput&, const std::vector<std::string>& effects)>;

struct ScoreSettings {
  std::filesystem::path directory;
  std::string results = "results";  // folder in it; another one for other sensors or settings
  int threads = 2;
  int from = 1;   // the case to begin with
  int first = 0;  // only so many, from that case on; 0: all
  std::string how = "with accelerometers";  // one line; a folder takes results of one kind alone
  bool second_round = false;
  bool informed_fits = true;  // false: none are made, and the gap's share counts those that are there already
};

// Throws std::runtime_error: no set there, digest wrong.
std::vector<CaseInput> case_inputs(const std::filesystem::path& directory);
std::vector<CaseAnswer> open_answers(const std::filesystem::path& directory);

using ScoreProgress = std::function<void(int done, int all, const std::string& line)>;

// Diagnoses every case (or those that were asked for) that has no result yet, then opens the answers, lets `informed` (may be empty) fit, and
// writes DIR/<results>/score.json. Empty where `is_stopped` said so first: call again to go on.
std::optional<ScoreTable> score_cases(const ScoreSettings& settings, const DiagnoseCase& diagnose,
                                      const InformedFit& informed, const ScoreProgress& progress = {},
                                      const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis::withheld
