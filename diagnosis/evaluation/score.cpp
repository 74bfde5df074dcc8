#include "diagnosis/evaluation/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "diagnosis/evaluation/make.h"
#include "diagnosis/evaluation/seal.h"
#include "diagnosis/evaluation/side_by_side.h"

namespace slewlab::diagnosis::withheld {

namespace fs = std::filesystem;
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

// A single true effect against one answer.
double credit(const std::string& effect, const Given& given) {
  if (given.unknown || given.cause->effects.size() != 1) return 0.0;
  const std::vector<std::string>& group = given.cause->group;
  const bool named = given.cause->effects[0] == effect;
  const bool in_group = std::find(group.begin(), group.end(), effect) != group.end();
  return named || in_group ? 1.0 / static_cast<double>(1 + group.size()) : 0.0;
}

bool first_is_right(const CaseAnswer& answer, const Given& first) {
  if (is_outside(answer.kind)) return first.unknown;
  return !first.unknown && names(*first.cause) == names(answer);
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

}  // namespace

ScoreTable tabulate(const std::vector<Judged>& cases) {
  ScoreTable table;
  std::vector<double> alarms, detected, subsystem, first, three, probability, both, unknown, covered, closed;
  std::vector<double> all_detected, all_subsystem, all_first, all_three, all_probability, all_both, all_unknown;
  std::vector<double> refused, seconds, left_out, no_catalogue, each_visible;
  std::map<std::string, std::vector<double>> per_effect;
  std::vector<Stated> stated, stated_acting;
  std::vector<double> acting;

  for (const Judged& judged : cases) {
    const CaseAnswer& answer = judged.answer;
    const CaseResult& result = judged.result;
    const std::optional<double>& informed = judged.unseen_informed;
    const std::vector<Given> given = ranked(result);
    const Given& top = given.front();
    const std::map<std::string, double> probability_of = acting_probabilities(given);
    const bool visible = answer.visibility > kVisible;
    const bool is_refused = !result.refusal.empty();  // which says nothing, not even that it is unknown
    const bool right = !is_refused && first_is_right(answer, top);
    refused.push_back(is_refused ? 1.0 : 0.0);
    seconds.push_back(result.seconds);
    ++table.confusion[label(answer)][is_refused ? "refused" : label(top)];
    const auto add = [&](std::vector<double>& of_visible, std::vector<double>& of_all, double value) {
      if (visible) of_visible.push_back(value);
      of_all.push_back(value);
    };
    if (!has_effect(answer.kind)) {
      alarms.push_back(result.gap ? 1.0 : 0.0);
    } else {
      add(detected, all_detected, result.gap ? 1.0 : 0.0);
    }
    if (!has_effect(answer.kind) || visible) {
      stated.push_back({top.probability, right});
      const auto most = std::max_element(probability_of.begin(), probability_of.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      stated_acting.push_back({most->second, acts(answer, most->first)});
    }
    if ((!has_effect(answer.kind) && (result.gap || !right)) || (visible && !right)) {
      table.failures.push_back(fmt::format("{} ({}): {} at {:.1f} noise floors; answered {} with {:.2f}{}", answer.name,
                                           name_of(answer.kind), label(answer), answer.visibility,
                                           is_refused ? "refused: " + result.refusal : label(top),
                                           top.probability, result.gap ? "" : ", no gap"));
    }
    if (answer.kind == Kind::kOneEffect || answer.kind == Kind::kTwoEffects) {
      const bool hit = !result.subsystems.empty() &&
                       std::any_of(answer.effects.begin(), answer.effects.end(), [&](const TrueEffect& effect) {
                         return effect.subsystem == result.subsystems.front().first;
                       });
      add(subsystem, all_subsystem, hit ? 1.0 : 0.0);
      if (right) {
        for (const TrueEffect& effect : answer.effects) {
          for (const TrueSize& size : effect.sizes) {
            if (!size.comparable) continue;
            for (const NamedSize& found : top.cause->sizes) {
              if (found.effect != effect.effect || found.parameter != size.parameter) continue;
              covered.push_back(found.low <= size.value && size.value <= found.high ? 1.0 : 0.0);
            }
          }
        }
      }
      if (visible && informed && result.unseen_before - *informed > 0.1 * result.unseen_before) {
        closed.push_back((result.unseen_before - result.unseen_after) / (result.unseen_before - *informed));
      }
    }
    if (answer.kind == Kind::kOneEffect) {
      const std::string& effect = answer.effects.at(0).effect;
      double best = 0.0;
      for (std::size_t k = 0; k < std::min<std::size_t>(3, given.size()); ++k) {
        best = std::max(best, credit(effect, given[k]));
      }
      double on_truth = 0.0;
      for (const Given& one : given) {
        if (!one.unknown && names(*one.cause) == names(answer)) on_truth += one.probability;
      }
      const auto acting_truth = probability_of.find(effect);
      if (visible) acting.push_back(acting_truth == probability_of.end() ? 0.0 : acting_truth->second);
      const double now = credit(effect, top);
      add(first, all_first, now);
      add(three, all_three, best);
      add(probability, all_probability, on_truth);
      if (visible) per_effect[effect].push_back(now);
      table.sizes.push_back({answer.effects[0].law, effect,
                             answer.effects[0].sizes.empty() ? 0.0 : answer.effects[0].sizes[0].value,
                             answer.visibility, result.gap, now});
    }
    if (answer.kind == Kind::kTwoEffects) {
      add(both, all_both, right ? 1.0 : 0.0);
      const bool each_is_visible = std::all_of(answer.effects.begin(), answer.effects.end(),
                                               [](const TrueEffect& effect) { return effect.visibility > kVisible; });
      if (each_is_visible) each_visible.push_back(right ? 1.0 : 0.0);
    }
    if (is_outside(answer.kind)) {
      add(unknown, all_unknown, right ? 1.0 : 0.0);
      if (visible) (answer.kind == Kind::kLeftOut ? left_out : no_catalogue).push_back(right ? 1.0 : 0.0);
    }
  }

  table.calibration = calibration_bins(stated);
  const Score calibration = calibration_score("calibration error", table.calibration);

  table.scores = {mean_score("false alarms", alarms, 0.0, 0.02),
                  mean_score("detection", detected, 0.98, 1.0),
                  mean_score("subsystem right", subsystem, 0.97, 1.0),
                  mean_score("first cause right", first, 0.95, 1.0),
                  mean_score("true cause in the first three", three, 0.99, 1.0),
                  mean_score("mean probability on the true cause", probability, 0.85, 1.0),
                  mean_score("both of two effects named", both, 0.75, 1.0),
                  mean_score("\"outside the catalogue\" where due", unknown, 0.85, 1.0),
                  calibration,
                  mean_score("90 % intervals that cover", covered, 0.85, 0.95),
                  mean_score("share of the gap closed", closed, 0.95, 10.0)};
  table.also = {mean_score("detection, all effects", all_detected, 0.0, 1.0),
                mean_score("subsystem right, all effects", all_subsystem, 0.0, 1.0),
                mean_score("first cause right, all effects", all_first, 0.0, 1.0),
                mean_score("true cause in the first three, all effects", all_three, 0.0, 1.0),
                mean_score("mean probability on the true cause, all effects", all_probability, 0.0, 1.0),
                mean_score("both of two effects named, all", all_both, 0.0, 1.0),
                mean_score("both of two effects named, each visible", each_visible, 0.0, 1.0),
                mean_score("\"outside the catalogue\" where due, all", all_unknown, 0.0, 1.0),
                mean_score("\"outside the catalogue\", left out", left_out, 0.0, 1.0),
                mean_score("\"outside the catalogue\", no catalogue", no_catalogue, 0.0, 1.0),
                mean_score("mean probability that the true effect acts", acting, 0.0, 1.0),
                calibration_score("calibration error, most probable effect", calibration_bins(stated_acting)),
                mean_score("refused", refused, 0.0, 1.0),
                mean_score("seconds per case", seconds, 0.0, 1e9)};
  for (const auto& [effect, values] : per_effect) {
    table.per_effect[effect] = mean_score(effect, values, 0.0, 1.0);
  }
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
  text += "\n";
  for (const Score& score : table.also) {
    if (score.cases > 0) text += fmt::format("{:<48}{:>8.3f}{:>18}{:>7}\n", score.name, score.value,
                                             fmt::format("{:.3f} ... {:.3f}", score.low, score.high), score.cases);
  }
  return text;
}

std::vector<CaseInput> case_inputs(const fs::path& directory) {
  const fs::path about_file = directory / "about.json";
  if (!fs::exists(about_file)) throw std::runtime_error(directory.string() + " holds no withheld cases (no about.json)");
  if (!fs::exists(directory / "digest.txt")) {
    throw std::runtime_error(directory.string() + " is not complete: call `slewlab withhold make` again to finish it");
  }
  const json about = json::parse(read_whole(about_file));
  std::vector<CaseInput> inputs;
  for (int n = 1; n <= about.at("cases").get<int>(); ++n) {
    const fs::path folder = directory / case_name(n);
    CaseInput input;
    input.name = case_name(n);
    input.crane = directory / about.at("crane").get<std::string>();
    input.controller = directory / about.at("controller").get<std::string>();
    input.controller_period = about.at("controller_period_s");
    input.logs = {folder / "a.lcmlog", folder / "b.lcmlog"};
    input.unseen = folder / "unseen.lcmlog";
    input.without = json::parse(read_whole(folder / "given.json")).at("without").get<std::vector<std::string>>();
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::vector<CaseAnswer> open_answers(const fs::path& directory) {
  const std::string text = read_whole(directory / "sealed" / "answers.json");
  const std::string digest = read_whole(directory / "digest.txt");
  if (digest.substr(0, 64) != sha256(text)) {
    throw std::runtime_error((directory / "sealed" / "answers.json").string() +
                             " is not the file that was sealed: its SHA-256 is " + sha256(text) +
                             ", digest.txt says " + digest.substr(0, 64));
  }
  std::vector<CaseAnswer> answers;
  const json sealed = json::parse(text);
  for (const json& one : sealed.at("cases")) {
    try {
      answers.push_back(answer_from(one));
    } catch (const json::exception& problem) {
      throw std::runtime_error(fmt::format("{}: {}: {}; made by another version of slewlab? Make the set again with its seed (about.json)",
                                           (directory / "sealed" / "answers.json").string(), one.value("case", "a case without a name"),
                                           problem.what()));
    }
  }
  return answers;
}

std::optional<ScoreTable> score_cases(const ScoreSettings& settings, const DiagnoseCase& diagnose,
                                      const InformedFit& informed, const ScoreProgress& progress,
                                      const std::function<bool()>& is_stopped) {
  std::vector<CaseInput> inputs = case_inputs(settings.directory);
  const std::size_t whole = inputs.size();
  if (settings.first < 0 || static_cast<std::size_t>(settings.first) > whole) {
    throw std::invalid_argument(fmt::format("the first {} cases are asked for; {} holds {}", settings.first, settings.directory.string(), whole));
  }
  if (settings.first > 0) inputs.resize(static_cast<std::size_t>(settings.first));
  const fs::path folder = settings.directory / settings.results;
  fs::create_directories(folder);
  const fs::path how_file = folder / "how.txt";
  if (!fs::exists(how_file)) {
    if (!fs::is_empty(folder)) {
      throw std::invalid_argument(
          fmt::format("{} holds results of which nobody knows how they were made; give another folder with --results", folder.string()));
    }
    write_whole(how_file, settings.how + "\n");
  }
  if (const std::string how = read_whole(how_file); how != settings.how + "\n") {
    throw std::invalid_argument(fmt::format("{} holds results \"{}\", not \"{}\"; give these another folder with --results", folder.string(),
                                            how.substr(0, how.find('\n')), settings.how));
  }
  std::mutex mutex;
  int done = 0;
  const int all = static_cast<int>(inputs.size());
  const auto tell = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done, all, line);
  };
  const auto result_file = [&](const CaseInput& input) { return folder / (input.name + ".json"); };
  const bool diagnosed = side_by_side(inputs.size(), settings.threads, is_stopped, [&](std::size_t n) {
    const CaseInput& input = inputs[n];
    if (fs::exists(result_file(input))) return tell(input.name + ": there already");
    CaseResult result = diagnose(input);
    result.name = input.name;
    write_whole(result_file(input), to_json(result).dump(1) + "\n");
    tell(input.name + ": diagnosed");
  });
  if (!diagnosed) return std::nullopt;

  // Only now, with every result on disk, is the seal broken.
  const std::vector<CaseAnswer> answers = open_answers(settings.directory);
  if (answers.size() != whole) throw std::runtime_error("answers.json holds another number of cases");
  std::vector<Judged> judged(inputs.size());
  done = 0;
  const bool finished = side_by_side(inputs.size(), settings.threads, is_stopped, [&](std::size_t n) {
    Judged& one = judged[n];
    one.answer = answers[n];
    one.result = result_from(json::parse(read_whole(result_file(inputs[n]))));
    const bool named = one.answer.kind == Kind::kOneEffect || one.answer.kind == Kind::kTwoEffects;
    if (informed && named && one.result.refusal.empty()) {
      const fs::path file = folder / (inputs[n].name + ".informed.json");
      if (!fs::exists(file) && settings.informed_fits) {
        std::vector<std::string> effects;
        for (const TrueEffect& effect : one.answer.effects) effects.push_back(effect.effect);
        write_whole(file, json{{"unseen_informed", informed(inputs[n], effects)}}.dump() + "\n");
      }
      if (fs::exists(file)) one.unseen_informed = json::parse(read_whole(file)).at("unseen_informed").get<double>();
    }
    tell(inputs[n].name + ": judged");
  });
  if (!finished) return std::nullopt;
  ScoreTable table = tabulate(judged);
  json out = to_json(table);
  out["cases"] = inputs.size();
  out["set"] = json::parse(read_whole(settings.directory / "about.json"));
  write_whole(folder / "score.json", out.dump(1) + "\n");
  return table;
}

}  // namespace slewlab::diagnosis::withheld
