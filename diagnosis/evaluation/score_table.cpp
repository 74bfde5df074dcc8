#include "diagnosis/evaluation/score_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>


namespace slewlab::diagnosis::withheld {

using nlohmann::json;

namespace {

constexpr double kQuantile = 1.959963984540054;  // of the normal distribution, 95 % both sides
constexpr const char* kUnknown = "outside the catalogue";
constexpr const char* kNothingMissing = "nothing missing";

// One answer of a result, in the order of probability.
struct Given {
  double probability = 0.0;
  bool unknown = false;
  const NamedCause* cause = nullptr;
};

std::vector<Given> ranked(const CaseResult& result) {
  std::vector<Given> all;
  for (const NamedCause& cause : result.causes) all.push_back({cause.probability, false, &cause});
  all.push_back({result.probability_unknown, true, nullptr});
  std::stable_sort(all.begin(), all.end(), [](const Given& a, const Given& b) { return a.probability > b.probability; });
  return all;
}

std::set<std::string> names(const CaseAnswer& answer) {
  std::set<std::string> effects;
  for (const TrueEffect& effect : answer.effects) effects.insert(effect.effect);
  return effects;
}

std::set<std::string> names(const NamedCause& cause) { return {cause.effects.begin(), cause.effects.end()}; }

bool has_effect(Kind kind) { return kind != Kind::kNothing && kind != Kind::kParameters; }
bool is_outside(Kind kind) { return kind == Kind::kLeftOut || kind == Kind::kNoCatalogue; }

// The probability that each effect acts, summed over all answers that name it; of nothing missing and of the unknown.
std::map<std::string, double> acting_probabilities(const std::vector<Given>& given) {
  std::map<std::string, double> sums;
  for (const Given& one : given) {
    if (one.unknown || one.cause->effects.empty()) {
      sums[one.unknown ? kUnknown : kNothingMissing] += one.probability;
      continue;
    }
    for (const std::string& effect : one.cause->effects) sums[effect] += one.probability;
  }
  return sums;
}

bool acts(const CaseAnswer& answer, const std::string& name) {
  if (is_outside(answer.kind)) return name == kUnknown;
  return answer.effects.empty() ? name == kNothingMissing : names(answer).contains(name);
}

// The effects of a cause of a group, which is "a", "a with b", ... (diagnosis/cause.h).
std::set<std::string> names_in(const std::string& cause) {
  static const std::string kWith = " with ";
  std::set<std::string> effects;
  for (std::size_t begin = 0, end; begin <= cause.size(); begin = end + kWith.size()) {
    end = std::min(cause.find(kWith, begin), cause.size());
    effects.insert(cause.substr(begin, end - begin));
  }
  return effects;
}

// The answer names these effects and no other, or declares that it cannot be told from a cause that does.
bool names_all(const Given& given, const std::set<std::string>& effects) {
  if (given.unknown) return false;
  const std::vector<std::string>& group = given.cause->group;
  return names(*given.cause) == effects || std::any_of(group.begin(), group.end(), [&](const std::string& other) { return names_in(other) == effects; });
}

// One over the number of causes that the answer declares as not to be told apart.
double share_of_group(const Given& given, const std::string& effect) {
  return names_all(given, {effect}) ? 1.0 / static_cast<double>(1 + given.cause->group.size()) : 0.0;
}

bool first_is_right(const CaseAnswer& answer, const CaseResult& result) {
  if (!result.refusal.empty()) return false;  // which says nothing, not even that it is unknown
  const Given first = ranked(result).front();
  if (is_outside(answer.kind)) return first.unknown;
  return names_all(first, names(answer));
}

std::string label(const Given& given) {
  if (given.unknown) return kUnknown;
  if (given.cause->effects.empty()) return kNothingMissing;
  return fmt::format("{}", fmt::join(names(*given.cause), " + "));
}

std::string label(const CaseAnswer& answer) {
  if (answer.kind == Kind::kNoCatalogue) return answer.effects.at(0).law + " (no catalogue)";
  if (answer.effects.empty()) return kNothingMissing;
  const std::string text = fmt::format("{}", fmt::join(names(answer), " + "));
  return answer.kind == Kind::kLeftOut ? text + " (left out)" : text;
}

Score mean_score(const std::string& name, const std::vector<double>& values, double aim_low, double aim_high) {
  Score score{name, 0.0, 0.0, 1.0, static_cast<int>(values.size()), aim_low, aim_high};
  if (values.empty()) return score;
  const double n = static_cast<double>(values.size());
  double sum = 0.0, square = 0.0;
  bool is_share = true;
  for (const double value : values) {
    sum += value;
    is_share = is_share && (value == 0.0 || value == 1.0);
  }
  const double mean = sum / n;
  score.value = mean;
  if (is_share) {
    const double z2 = kQuantile * kQuantile;
    const double centre = (mean + z2 / (2.0 * n)) / (1.0 + z2 / n);
    const double half = kQuantile / (1.0 + z2 / n) * std::sqrt(mean * (1.0 - mean) / n + z2 / (4.0 * n * n));
    score.low = std::max(0.0, centre - half);
    score.high = std::min(1.0, centre + half);
    return score;
  }
  for (const double value : values) square += (value - mean) * (value - mean);
  const double half = kQuantile * std::sqrt(square / std::max(1.0, n - 1.0) / n);
  score.low = mean - half;
  score.high = mean + half;
  return score;
}

struct Stated {
  double probability;
  bool right;
};

std::vector<CalibrationBin> calibration_bins(const std::vector<Stated>& stated) {
  constexpr std::size_t kBins = 10;
  std::vector<CalibrationBin> bins(kBins);
  for (const Stated& one : stated) {
    CalibrationBin& bin = bins[std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, one.probability) * kBins))];
    bin.stated += one.probability;
    bin.right += one.right ? 1.0 : 0.0;
    ++bin.cases;
  }
  for (CalibrationBin& bin : bins) {
    if (bin.cases == 0) continue;
    bin.stated /= bin.cases;
    bin.right /= bin.cases;
  }
  return bins;
}

// Mean distance of what was stated from what was right, weighted by cases. Its interval is that of a weighted mean whose
// bins err as shares do, Laplace's (k + 1) / (n + 2) standing for the share, so that a bin of one case is not certain.
Score calibration_score(const std::string& name, const std::vector<CalibrationBin>& bins) {
  Score score{name, 0.0, 0.0, 1.0, 0, 0.0, 0.05};
  double error = 0.0, variance = 0.0;
  for (const CalibrationBin& bin : bins) {
    const double n = bin.cases;
    const double share = (bin.right * n + 1.0) / (n + 2.0);
    error += std::fabs(bin.stated - bin.right) * n;
    variance += n * share * (1.0 - share);
    score.cases += bin.cases;
  }
  if (score.cases == 0) return score;
  const double half = kQuantile * std::sqrt(variance) / score.cases;
  score.value = error / score.cases;
  score.low = std::max(0.0, score.value - half);
  score.high = std::min(1.0, score.value + half);
  return score;
}

// Values of a score on visible cases and on all of them.
struct Tally {
  std::vector<double> visible, all;
  void add(bool is_visible, double value) {
    if (is_visible) visible.push_back(value);
    all.push_back(value);
  }
};

struct Tallies {
  std::vector<double> alarms, sure_and_wrong, refused, seconds;
  std::vector<double> plainly_detected;
  Tally detected, subsystem;
  Tally first, first_by_share, three, probability;
  std::vector<double> acting, proposed, drawn;
  std::map<std::string, std::vector<double>> per_effect;
  Tally both;
  std::vector<double> each_visible;
  Tally unknown;
  std::vector<double> left_out, no_catalogue, variable;
  std::vector<double> covered, closed;
  std::vector<Stated> stated, stated_acting;
};

// One case, as all that count it need it.
struct Counted {
  const CaseAnswer& answer;
  const CaseResult& result;
  std::vector<Given> given;
  bool visible;
  bool right;
  const Given& top() const { return given.front(); }
};

void count_gap(const Counted& one, Tallies& tallies) {
  const double gap = one.result.gap ? 1.0 : 0.0;
  if (!has_effect(one.answer.kind)) {
    tallies.alarms.push_back(gap);
    return;
  }
  tallies.detected.add(one.visible, gap);
  if (one.answer.visibility > kPlainToSee) tallies.plainly_detected.push_back(gap);
}

// What was stated of a truth that can be known.
void count_stated(const Counted& one, Tallies& tallies) {
  if (has_effect(one.answer.kind) && !one.visible) return;
  tallies.stated.push_back({one.top().probability, one.right});
  if (one.top().probability > kStatedSure && one.result.refusal.empty()) tallies.sure_and_wrong.push_back(one.right ? 0.0 : 1.0);
  const std::map<std::string, double> acting = acting_probabilities(one.given);
  const auto most = std::max_element(acting.begin(), acting.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  tallies.stated_acting.push_back({most->second, acts(one.answer, most->first)});
}

void count_subsystem(const Counted& one, Tallies& tallies) {
  const bool hit = !one.result.subsystems.empty() &&
                   std::any_of(one.answer.effects.begin(), one.answer.effects.end(),
                               [&](const TrueEffect& effect) { return effect.subsystem == one.result.subsystems.front().first; });
  tallies.subsystem.add(one.visible, hit ? 1.0 : 0.0);
}

void count_intervals(const Counted& one, Tallies& tallies) {
  if (!one.right) return;
  for (const TrueEffect& effect : one.answer.effects) {
    for (const TrueSize& size : effect.sizes) {
      if (!size.comparable) continue;
      for (const NamedSize& found : one.top().cause->sizes) {
        if (found.effect != effect.effect || found.parameter != size.parameter) continue;
        tallies.covered.push_back(found.low <= size.value && size.value <= found.high ? 1.0 : 0.0);
      }
    }
  }
}

void count_gap_closed(const Counted& one, const std::optional<double>& informed, Tallies& tallies) {
  const double before = one.result.unseen_before;
  if (!one.visible || !informed || !(before - *informed > 0.1 * before)) return;
  tallies.closed.push_back((before - one.result.unseen_after) / (before - *informed));
}

void count_one_effect(const Counted& one, const Judged& judged, Tallies& tallies, std::vector<SizePoint>& sizes) {
  const TrueEffect& truth = one.answer.effects.at(0);
  const std::size_t three = std::min<std::size_t>(3, one.given.size());
  const bool in_three = std::any_of(one.given.begin(), one.given.begin() + static_cast<std::ptrdiff_t>(three),
                                    [&](const Given& given) { return names_all(given, {truth.effect}); });
  double on_truth = 0.0;
  for (const Given& given : one.given) {
    if (!given.unknown && names(*given.cause) == names(one.answer)) on_truth += given.probability;
  }
  const std::map<std::string, double> acting = acting_probabilities(one.given);
  const auto acts_here = acting.find(truth.effect);
  const double now = one.right ? 1.0 : 0.0;
  tallies.first.add(one.visible, now);
  tallies.first_by_share.add(one.visible, share_of_group(one.top(), truth.effect));
  tallies.three.add(one.visible, in_three ? 1.0 : 0.0);
  tallies.probability.add(one.visible, on_truth);
  if (one.visible) {
    tallies.acting.push_back(acts_here == acting.end() ? 0.0 : acts_here->second);
    tallies.per_effect[truth.effect].push_back(now);
    if (judged.proposed) tallies.proposed.push_back(first_is_right(one.answer, *judged.proposed) ? 1.0 : 0.0);
    if (judged.drawn) tallies.drawn.push_back(first_is_right(one.answer, *judged.drawn) ? 1.0 : 0.0);
  }
  sizes.push_back({truth.law, truth.effect, truth.sizes.empty() ? 0.0 : truth.sizes[0].value, one.answer.visibility, one.result.gap, now});
}

void count_two_effects(const Counted& one, Tallies& tallies) {
  tallies.both.add(one.visible, one.right ? 1.0 : 0.0);
  const bool each_is_visible = std::all_of(one.answer.effects.begin(), one.answer.effects.end(),
                                           [](const TrueEffect& effect) { return effect.visibility > kVisible; });
  if (each_is_visible) tallies.each_visible.push_back(one.right ? 1.0 : 0.0);
}

void count_unknown(const Counted& one, Tallies& tallies) {
  tallies.unknown.add(one.visible, one.right ? 1.0 : 0.0);
  if (!one.visible) return;
  (one.answer.kind == Kind::kLeftOut ? tallies.left_out : tallies.no_catalogue).push_back(one.right ? 1.0 : 0.0);
  const std::string& follows = one.answer.effects.at(0).follows;
  if (follows.empty() || !one.right) return;
  const std::vector<std::string>& said = one.result.follows;
  tallies.variable.push_back(std::find(said.begin(), said.end(), follows) != said.end() ? 1.0 : 0.0);
}

// One line where a case is answered wrongly that could be answered rightly; else nothing.
std::string failure(const Counted& one) {
  const CaseAnswer& answer = one.answer;
  const bool is_alarm = !has_effect(answer.kind) && (one.result.gap || !one.right);
  if (!is_alarm && !(one.visible && !one.right)) return "";
  return fmt::format("{} ({}): {} at {:.1f} noise floors; answered {} with {:.2f}{}", answer.name, name_of(answer.kind), label(answer), answer.visibility,
                     one.result.refusal.empty() ? label(one.top()) : "refused: " + one.result.refusal, one.top().probability,
                     one.result.gap ? "" : ", no gap");
}

void count(const Judged& judged, Tallies& tallies, ScoreTable& table) {
  const bool is_refused = !judged.result.refusal.empty();
  const Counted one{judged.answer, judged.result, ranked(judged.result), judged.answer.visibility > kVisible, first_is_right(judged.answer, judged.result)};
  const Kind kind = one.answer.kind;
  tallies.refused.push_back(is_refused ? 1.0 : 0.0);
  tallies.seconds.push_back(one.result.seconds);
  ++table.confusion[label(one.answer)][is_refused ? "refused" : label(one.top())];
  if (std::string line = failure(one); !line.empty()) table.failures.push_back(std::move(line));
  count_gap(one, tallies);
  count_stated(one, tallies);
  if (kind == Kind::kOneEffect || kind == Kind::kTwoEffects) {
    count_subsystem(one, tallies);
    count_intervals(one, tallies);
    count_gap_closed(one, judged.unseen_informed, tallies);
  }
  if (kind == Kind::kOneEffect) count_one_effect(one, judged, tallies, table.sizes);
  if (kind == Kind::kTwoEffects) count_two_effects(one, tallies);
  if (is_outside(kind)) count_unknown(one, tallies);
}

std::vector<Score> with_aims(const Tallies& t, const Score& calibration) {
  return {mean_score("false alarms", t.alarms, 0.0, 0.02),
          mean_score("stated above 0.9 and wrong", t.sure_and_wrong, 0.0, 0.03),
          mean_score("detection", t.plainly_detected, 0.98, 1.0),
          mean_score("first cause right", t.first.visible, 0.92, 1.0),
          mean_score("true cause in the first three", t.three.visible, 0.97, 1.0),
          mean_score("both of two effects named, each visible", t.each_visible, 0.75, 1.0),
          mean_score("\"outside the catalogue\" where due", t.unknown.visible, 0.85, 1.0),
          mean_score("its variable right", t.variable, 0.8, 1.0),
          calibration,
          mean_score("first cause right after one proposed manoeuvre", t.proposed, 0.96, 1.0),
          mean_score("90 % intervals that cover", t.covered, 0.85, 0.95),
          mean_score("share of the gap closed", t.closed, 0.97, 10.0)};
}

std::vector<Score> without_aims(const Tallies& t) {
  const auto plain = [](const char* name, const std::vector<double>& values) { return mean_score(name, values, 0.0, 1.0); };
  return {plain("detection, visible effects", t.detected.visible),
          plain("detection, all effects", t.detected.all),
          plain("subsystem right", t.subsystem.visible),
          plain("subsystem right, all effects", t.subsystem.all),
          plain("first cause right, all effects", t.first.all),
          plain("first cause right, by the group's size", t.first_by_share.visible),
          plain("true cause in the first three, all effects", t.three.all),
          plain("mean probability on the true cause", t.probability.visible),
          plain("mean probability on the true cause, all effects", t.probability.all),
          plain("mean probability that the true effect acts", t.acting),
          plain("both of two effects named", t.both.visible),
          plain("both of two effects named, all", t.both.all),
          plain("\"outside the catalogue\" where due, all", t.unknown.all),
          plain("\"outside the catalogue\", left out", t.left_out),
          plain("\"outside the catalogue\", no catalogue", t.no_catalogue),
          calibration_score("calibration error, most probable effect", calibration_bins(t.stated_acting)),
          plain("first cause right after one drawn manoeuvre", t.drawn),
          plain("refused", t.refused),
          mean_score("seconds per case", t.seconds, 0.0, 1e9)};
}

}  // namespace

ScoreTable tabulate(const std::vector<Judged>& cases) {
  ScoreTable table;
  Tallies tallies;
  for (const Judged& judged : cases) count(judged, tallies, table);
  table.calibration = calibration_bins(tallies.stated);
  table.scores = with_aims(tallies, calibration_score("calibration error", table.calibration));
  table.also = without_aims(tallies);
  for (const auto& [effect, values] : tallies.per_effect) table.per_effect[effect] = mean_score(effect, values, 0.0, 1.0);
  return table;
}

namespace {

json score_json(const Score& score) {
  json out{{"name", score.name}, {"value", score.value}, {"low", score.low}, {"high", score.high},
           {"cases", score.cases}};
  if (score.cases == 0) out["value"] = nullptr;
  return out;
}

std::string aim_text(const Score& score) {
  if (score.aim_low > 0.0 && score.aim_high < 1.0) return fmt::format("{:g} ... {:g}", score.aim_low, score.aim_high);
  if (score.aim_low > 0.0) return fmt::format(">= {:g}", score.aim_low);
  return fmt::format("<= {:g}", score.aim_high);
}

}  // namespace

json to_json(const ScoreTable& table) {
  json out{{"scores", json::array()},      {"also", json::array()},  {"confusion", table.confusion},
           {"per_effect", json::object()}, {"sizes", json::array()}, {"calibration", json::array()},
           {"failures", table.failures}};
  for (const Score& score : table.scores) {
    json one = score_json(score);
    one["aim"] = aim_text(score);
    one["reached"] = score.reached();
    out["scores"].push_back(one);
  }
  for (const Score& score : table.also) out["also"].push_back(score_json(score));
  for (const auto& [effect, score] : table.per_effect) out["per_effect"][effect] = score_json(score);
  for (const SizePoint& point : table.sizes) {
    out["sizes"].push_back({{"law", point.law},
                            {"effect", point.effect},
                            {"size", point.size},
                            {"visibility", point.visibility},
                            {"detected", point.detected},
                            {"credit", point.credit}});
  }
  for (const CalibrationBin& bin : table.calibration) {
    out["calibration"].push_back({{"stated", bin.stated}, {"right", bin.right}, {"cases", bin.cases}});
  }
  return out;
}

std::string as_text(const ScoreTable& table) {
  std::string text = fmt::format("{:<48}{:>8}{:>18}{:>7}  {:<14}{}\n", "score", "value", "95 %", "cases", "aim", "");
  for (const Score& score : table.scores) {
    text += score.cases == 0
                ? fmt::format("{:<48}{:>8}{:>18}{:>7}  {:<14}\n", score.name, "-", "", 0, aim_text(score))
                : fmt::format("{:<48}{:>8.3f}{:>18}{:>7}  {:<14}{}\n", score.name, score.value,
                              fmt::format("{:.3f} ... {:.3f}", score.low, score.high), score.cases, aim_text(score),
                              score.reached() ? "reached" : "NOT REACHED");
  }
  text += '\n';
  for (const Score& score : table.also) {
    if (score.cases > 0) text += fmt::format("{:<48}{:>8.3f}{:>18}{:>7}\n", score.name, score.value,
                                             fmt::format("{:.3f} ... {:.3f}", score.low, score.high), score.cases);
  }
  return text;
}

}  // namespace slewlab::diagnosis::withheld
