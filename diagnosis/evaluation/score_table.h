// What the results of withheld cases are worth: each score's definition, the table of all, its JSON and its text.
//
// An effect counts as visible where it changes any signal that is recorded by more than 3 noise floors (make.h), as plain to see by more than 6. What
// is scored of visible effects is also given for all of them. The first answer of a result is the most probable of its causes
// and "outside the catalogue". An answer that declares causes as not to be told apart names them all: effects that are indistinguishable for
// these sensors are one answer.
//
// - false alarms: gap said on "nothing" and "parameters".
// - stated above 0.9 and wrong: of the first answers that are stated so and whose truth can be known (nothing, parameters, visible effects).
// - detection: gap said on cases with an effect that is plain to see, of whatever kind; also given for visible ones.
// - subsystem: the most probable one is that of a true effect (one effect, two effects).
// - first cause: one effect; the first answer names it, alone. First three: one of the first three answers does. Given besides: where
//   an answer counts one over the number of causes that it declares as not to be told apart.
// - probability on the true cause: one effect; that of the cause with the true effect alone.
// - two effects: the first answer names both (or declares them as one with those that it names), where each of them alone is visible beside the other; also given where they are visible together.
// - unknown: left-out and no-catalogue cases whose first answer is "outside the catalogue". Its variable: of those of laws that follow one, the
//   share in which it is among those that the diagnosis says is followed.
// - calibration: the first answer's probability against how often it is right, 10 bins, mean absolute difference
//   weighted by cases; over cases whose truth can be known.
// - that an effect acts: the probabilities of all answers that name it, alone or with another, together. Given besides: that of the true
//   effect (one effect), and the calibration of the most probable one of all effects, nothing missing and "outside the catalogue".
// - after one manoeuvre: first cause right once the manoeuvre that the diagnosis proposes was driven and diagnosed with the others, and the same with one that is drawn;
//   answers that were sure, and for which none is proposed, stand as they were.
// - coverage: of the first answers that are right, the share of comparable sizes within the 90 % interval.
// - gap closed: (before - after) / (before - informed) on the unseen manoeuvre, informed being a fit that was told
//   the effects; mean over visible one- and two-effect cases where the informed fit closes 10 % or more.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evaluation/case_result.h"

namespace slewlab::diagnosis::withheld {

inline constexpr double kVisible = 3.0;      // [-] noise floors
inline constexpr double kPlainToSee = 6.0;   // [-] noise floors
inline constexpr double kStatedSure = 0.9;   // probability

struct Judged {
  CaseAnswer answer;
  CaseResult result;
  std::optional<double> unseen_informed;
  // With one more manoeuvre: the one that the result proposes, and the one that was drawn. The result itself where it proposes none; nothing
  // where no second round was asked for.
  std::optional<CaseResult> proposed, drawn;
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

}  // namespace slewlab::diagnosis::withheld
