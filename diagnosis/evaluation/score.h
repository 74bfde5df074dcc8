// Judges a diagnosis on withheld cases.
//
// An effect counts as visible where it changes any signal by more than 3 noise floors (make.h). What is scored of
// visible effects is also given for all of them. The first answer of a result is the most probable of its causes
// and "outside the catalogue".
//
// - false alarms: gap said on "nothing" and "parameters".
// - detection: gap said on cases with an effect, of whatever kind.
// - subsystem: the most probable one is that of a true effect (one effect, two effects).
// - first cause: one effect; 1 where the first answer is it alone, 1/size where the first answer declares a group of
//   that size with the truth in it. First three: the same over the first three answers, the best of them.
// - probability on the true cause: one effect; that of the cause with the true effect alone.
// - two effects: the first answer names both; also given where each of them alone is visible beside the other.
// - unknown: left-out and no-catalogue cases whose first answer is "outside the catalogue".
// - calibration: the first answer's probability against how often it is right, 10 bins, mean absolute difference
//   weighted by cases; over cases whose truth can be known (nothing, parameters, visible effects).
// - that an effect acts: the probabilities of all answers that name it, alone or with another, together. Given besides: that of the true
//   effect (one effect), and the calibration of the most probable one of all effects, nothing missing and "outside the catalogue".
// - coverage: of the first answers that are right, the share of comparable sizes within the 90 % interval.
// - gap closed: (before - after) / (before - informed) on the unseen manoeuvre, informed being a fit that was told
//   the effects; mean over visible one- and two-effect cases where the informed fit closes 10 % or more.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evaluation/case_result.h"

namespace slewlab::diagnosis::withheld {

inline constexpr double kVisible = 3.0;  // [-] noise floors

struct Judged {
  CaseAnswer answer;
  CaseResult result;
  std::optional<double> unseen_informed;
};

// A share of cases, or a mean over them, with its 95 % interval.
struct Score {
  std::string name;
  double value = 0.0;
  double low = 0.0, high = 1.0;  // 95 %: Wilson for shares, normal for means
  int cases = 0;
  double aim_low = 0.0, aim_high = 1.0;
  bool reached() const { return cases > 0 && value >= aim_low - 1e-12 && value <= aim_high + 1e-12; }
};

struct CalibrationBin {
  double stated = 0.0;  // mean
  double right = 0.0;   // share
  int cases = 0;
};

struct SizePoint {
  std::string law, effect;
  double size = 0.0, visibility = 0.0;
  bool detected = false;
  double credit = 0.0;  // first cause
};

struct ScoreTable {
  std::vector<Score> scores;      // with an aim
  std::vector<Score> also;        // the same on all effects, visible or not; refusals; time
  std::map<std::string, std::map<std::string, int>> confusion;  // truth -> first answer -> cases
  std::map<std::string, Score> per_effect;                      // first cause, visible single effects
  std::vector<SizePoint> sizes;                                 // single effects
  std::vector<CalibrationBin> calibration;
  std::vector<std::string> failures;  // one line per visible case that is not answered rightly
};
ScoreTable tabulate(const std::vector<Judged>& cases);

nlohmann::json to_json(const ScoreTable& table);
std::string as_text(const ScoreTable& table);

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
  int first = 0;  // only so many, from the beginning of the set; 0: all
  std::string how = "with accelerometers";  // one line; a folder takes results of one kind alone
  bool informed_fits = true;  // false: none are made, and the gap's share counts those that are there already
};

// Throws std::runtime_error: no set there, digest wrong.
std::vector<CaseInput> case_inputs(const std::filesystem::path& directory);
std::vector<CaseAnswer> open_answers(const std::filesystem::path& directory);

using ScoreProgress = std::function<void(int done, int all, const std::string& line)>;

// Diagnoses every case (or the first ones that were asked for) that has no result yet, then opens the answers, lets `informed` (may be empty) fit, and
// writes DIR/<results>/score.json. Empty where `is_stopped` said so first: call again to go on.
std::optional<ScoreTable> score_cases(const ScoreSettings& settings, const DiagnoseCase& diagnose,
                                      const InformedFit& informed, const ScoreProgress& progress = {},
                                      const std::function<bool()>& is_stopped = {});

}  // namespace slewlab::diagnosis::withheld
