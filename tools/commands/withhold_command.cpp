#include "tools/commands/withhold_command.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <ostream>

#include "common/input_error.h"
#include "common/stop_signal.h"
#include "diagnosis/evaluation/case_diagnosis.h"
#include "diagnosis/evaluation/draw.h"
#include "diagnosis/evaluation/make.h"
#include "diagnosis/evaluation/score.h"
#include "tools/commands/output_folder.h"

namespace slewlab::tools {

namespace {

using diagnosis::withheld::MakeProgress;

// Runs `work` with SIGINT and SIGTERM caught, progress with the time left, and problems as one line. `work` answers
// false where it was interrupted.
int run_interruptibly(const char* name, std::ostream& out, std::ostream& complaints,
                      const std::function<bool(const MakeProgress&)>& work) {
  common::catch_stop_signals();
  auto start = std::chrono::steady_clock::now();
  auto told = start;
  int before = 0;
  int fresh = 0;
  const MakeProgress progress = [&](int done, int all, const std::string& line) {
    // Where it counts from the beginning again, other work has begun that takes its own time.
    if (done < before) {
      start = told;
      fresh = 0;
    }
    before = done;
    told = std::chrono::steady_clock::now();
    out << fmt::format("{}/{} {}", done, all, line);
    if (line.find("there already") == std::string::npos) {
      const double spent = std::chrono::duration<double>(told - start).count();
      out << fmt::format(", about {:.0f} s left", spent / ++fresh * (all - done));
    }
    out << std::endl;
  };
  try {
    if (work(progress)) return 0;
    out << "interrupted; the same command goes on where it stopped\n";
    return common::stop_exit_code();
  } catch (const common::InputError& error) {
    complaints << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    complaints << "slewlab " << name << ": " << error.what() << '\n';
    return 1;
  }
}

}  // namespace

int withhold_make(const WithholdMakeOptions& options, std::ostream& out, std::ostream& complaints) {
  using namespace slewlab::diagnosis::withheld;
  if (!options.purpose.empty() && options.purpose != "tune" && options.purpose != "score") {
    complaints << "--purpose is \"" << options.purpose << "\"; it must be tune or score\n";
    return 2;
  }
  MakeSettings settings;
  settings.cases = options.cases;
  settings.seed = options.seed;
  settings.purpose = options.purpose.empty() ? (options.seed < kFirstScoringSeed ? Purpose::kTune : Purpose::kScore)
                                             : (options.purpose == "tune" ? Purpose::kTune : Purpose::kScore);
  settings.directory = options.directory;
  settings.crane = options.crane;
  settings.controller = options.controller;
  constexpr double kLowestRate = 1.0;  // [Hz]: less than that records nothing of a slew
  if (!(options.rate >= kLowestRate)) {
    complaints << "--rate is " << options.rate << " Hz; it must be at least " << kLowestRate << " Hz\n";
    return 2;
  }
  settings.record_period = 1.0 / options.rate;
  settings.controller_period = options.controller_period_ms > 0.0 ? options.controller_period_ms * 1e-3 : settings.record_period;
  try {
    check_seed(settings.seed, settings.purpose);
    settings.sensors = sensors_named(options.sensors);
    settings.begin = begin_named(options.begin);
    settings.laws = laws_named(options.laws);
  } catch (const std::invalid_argument& error) {
    complaints << "slewlab withhold make: " << error.what() << '\n';
    return 2;
  }
  settings.threads = options.threads;
  return run_interruptibly("withhold make", out, complaints, [&](const MakeProgress& progress) {
    make_output_folder(settings.directory);
    if (!make_cases(settings, progress, common::stop_requested)) return false;
    out << fmt::format("{} cases for \"{}\" in {}; answers sealed, digest in digest.txt\n", settings.cases,
                       name_of(settings.purpose), settings.directory.string());
    return true;
  });
}

int withhold_score(const diagnosis::withheld::ScoreSettings& settings,
                   const diagnosis::withheld::DiagnoseCase& diagnose,
                   const diagnosis::withheld::InformedFit& informed, std::ostream& out, std::ostream& complaints) {
  using namespace slewlab::diagnosis::withheld;
  return run_interruptibly("withhold score", out, complaints, [&](const MakeProgress& progress) {
    if (!std::filesystem::exists(settings.directory / "about.json")) {
      throw common::InputError({{{"DIR", 0, 0}, "", "'" + settings.directory.string() + "', which holds no withheld cases (no about.json)", "a folder of slewlab withhold make"}});
    }
    const std::optional<ScoreTable> table = score_cases(settings, diagnose, informed, progress, common::stop_requested);
    if (!table) return false;
    out << '\n' << as_text(*table) << "\nin " << (settings.directory / settings.results / "score.json").string() << '\n';
    return true;
  });
}

int withhold_judge(const WithholdScoreOptions& options, std::ostream& out, std::ostream& complaints) {
  diagnosis::CaseSettings settings;
  settings.accelerometers = !options.no_accelerometers;
  diagnosis::withheld::ScoreSettings score;
  score.directory = options.directory;
  score.results = options.results;
  score.how = options.no_accelerometers ? "encoders and torques alone" : "with accelerometers";
  score.threads = options.threads;
  score.from = options.from;
  score.first = options.first;
  score.informed_fits = !options.no_informed_fits;
  score.second_round = options.second_round;
  return withhold_score(
      score,
      [settings](const diagnosis::withheld::CaseInput& input) { return diagnosis::diagnose_case(input, settings, common::stop_requested); },
      [settings](const diagnosis::withheld::CaseInput& input, const std::vector<std::string>& effects) {
        return diagnosis::informed_gap(input, effects, settings, common::stop_requested);
      },
      out, complaints);
}

}  // namespace slewlab::tools
