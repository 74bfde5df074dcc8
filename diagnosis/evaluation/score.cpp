#include "diagnosis/evaluation/score.h"

#include <fmt/format.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "diagnosis/evaluation/make.h"
#include "diagnosis/evaluation/seal.h"
#include "diagnosis/evaluation/side_by_side.h"

namespace slewlab::diagnosis::withheld {

namespace fs = std::filesystem;
using nlohmann::json;

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

namespace {

std::vector<CaseInput> asked_for(const ScoreSettings& settings) {
  std::vector<CaseInput> inputs = case_inputs(settings.directory);
  const int all = static_cast<int>(inputs.size());
  if (settings.from < 1 || settings.from > all || settings.first < 0 || settings.from - 1 + settings.first > all) {
    throw std::invalid_argument(settings.from == 1 ? fmt::format("the first {} cases are asked for; {} holds {}", settings.first, settings.directory.string(), all)
                                                   : fmt::format("{} from case {} on are asked for; {} holds {}",
                                                                 settings.first > 0 ? fmt::format("{} cases", settings.first) : "the cases",
                                                                 settings.from, settings.directory.string(), all));
  }
  inputs.erase(inputs.begin(), inputs.begin() + settings.from - 1);
  if (settings.first > 0) inputs.resize(static_cast<std::size_t>(settings.first));
  return inputs;
}

// The folder for the results, which takes those of one kind alone.
fs::path results_folder(const ScoreSettings& settings) {
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
  return folder;
}

CaseResult read_result(const fs::path& file) { return result_from(json::parse(read_whole(file))); }

// One part of the work, told case by case.
class Telling {
 public:
  Telling(const ScoreProgress& progress, std::size_t all) : progress_(progress), all_(static_cast<int>(all)) {}
  void operator()(const std::string& line) {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (progress_) progress_(done_, all_, line);
  }

 private:
  const ScoreProgress& progress_;
  int all_;
  int done_ = 0;
  std::mutex mutex_;
};

struct Judging {
  const ScoreSettings& settings;
  const DiagnoseCase& diagnose;
  const InformedFit& informed;
  const ScoreProgress& progress;
  const std::function<bool()>& is_stopped;
  std::vector<CaseInput> inputs;
  fs::path folder;
  fs::path file(const CaseInput& input, const char* what = "") const { return folder / (input.name + what + ".json"); }
};

bool diagnose_all(const Judging& judging) {
  Telling tell(judging.progress, judging.inputs.size());
  return side_by_side(judging.inputs.size(), judging.settings.threads, judging.is_stopped, [&](std::size_t n) {
    const CaseInput& input = judging.inputs[n];
    if (fs::exists(judging.file(input))) return tell(input.name + ": there already");
    CaseResult result = judging.diagnose(input);
    result.name = input.name;
    write_whole(judging.file(input), to_json(result).dump(1) + "\n");
    tell(input.name + ": diagnosed");
  });
}

// The case with the log of one more manoeuvre, driven by its machine; the result stands beside the first one.
void diagnose_with(const Judging& judging, const MakeSettings& set, std::size_t n, const std::optional<Manoeuvre>& manoeuvre, const std::string& which) {
  CaseInput input = judging.inputs[n];
  const fs::path file = judging.file(input, ("." + which).c_str());
  if (!manoeuvre || fs::exists(file)) return;
  const fs::path log = judging.folder / (input.name + "." + which + ".lcmlog");
  measure_again(set, judging.settings.from + static_cast<int>(n), *manoeuvre, which, log);
  input.logs.push_back(log);
  CaseResult result = judging.diagnose(input);
  result.name = input.name;
  write_whole(file, to_json(result).dump(1) + "\n");
}

bool second_round(const Judging& judging) {
  Telling tell(judging.progress, judging.inputs.size());
  const MakeSettings set = settings_of(judging.settings.directory);
  return side_by_side(judging.inputs.size(), judging.settings.threads, judging.is_stopped, [&](std::size_t n) {
    const CaseResult first = read_result(judging.file(judging.inputs[n]));
    diagnose_with(judging, set, n, first.next, "proposed");
    diagnose_with(judging, set, n, first.drawn, "drawn");
    tell(judging.inputs[n].name + (first.next ? ": second round" : ": sure, no second round"));
  });
}

std::optional<double> informed_fit(const Judging& judging, const CaseInput& input, const Judged& one) {
  const bool named = one.answer.kind == Kind::kOneEffect || one.answer.kind == Kind::kTwoEffects;
  if (!judging.informed || !named || !one.result.refusal.empty()) return {};
  const fs::path file = judging.file(input, ".informed");
  if (!fs::exists(file) && judging.settings.informed_fits) {
    std::vector<std::string> effects;
    for (const TrueEffect& effect : one.answer.effects) effects.push_back(effect.effect);
    write_whole(file, json{{"unseen_informed", judging.informed(input, effects)}}.dump() + "\n");
  }
  if (!fs::exists(file)) return {};
  return json::parse(read_whole(file)).at("unseen_informed").get<double>();
}

bool judge_all(const Judging& judging, const std::vector<CaseAnswer>& answers, std::vector<Judged>& judged) {
  Telling tell(judging.progress, judging.inputs.size());
  return side_by_side(judging.inputs.size(), judging.settings.threads, judging.is_stopped, [&](std::size_t n) {
    const CaseInput& input = judging.inputs[n];
    Judged& one = judged[n];
    one.answer = answers[static_cast<std::size_t>(judging.settings.from - 1) + n];
    one.result = read_result(judging.file(input));
    const auto again = [&](const char* which) { return fs::exists(judging.file(input, which)) ? read_result(judging.file(input, which)) : one.result; };
    if (judging.settings.second_round) {
      one.proposed = again(".proposed");
      one.drawn = again(".drawn");
    }
    one.unseen_informed = informed_fit(judging, input, one);
    tell(input.name + ": judged");
  });
}

}  // namespace

std::optional<ScoreTable> score_cases(const ScoreSettings& settings, const DiagnoseCase& diagnose,
                                      const InformedFit& informed, const ScoreProgress& progress,
                                      const std::function<bool()>& is_stopped) {
  const Judging judging{settings, diagnose, informed, progress, is_stopped, asked_for(settings), results_folder(settings)};
  if (!diagnose_all(judging)) return std::nullopt;
  if (settings.second_round && !second_round(judging)) return std::nullopt;

  // Only now, with every result on disk, is the seal broken.
  const std::vector<CaseAnswer> answers = open_answers(settings.directory);
  if (answers.size() != case_inputs(settings.directory).size()) throw std::runtime_error("answers.json holds another number of cases");
  std::vector<Judged> judged(judging.inputs.size());
  if (!judge_all(judging, answers, judged)) return std::nullopt;
  ScoreTable table = tabulate(judged);
  json out = to_json(table);
  out["cases"] = judging.inputs.size();
  out["from"] = settings.from;
  out["set"] = json::parse(read_whole(settings.directory / "about.json"));
  write_whole(judging.folder / "score.json", out.dump(1) + "\n");
  return table;
}

}  // namespace slewlab::diagnosis::withheld
