#include "tools/withhold_command.h"

#include "diagnosis/case_diagnosis.h"
#include "diagnosis/withheld/score.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <ostream>

#include "diagnosis/withheld/make.h"

namespace slewlab::tools {

namespace {

std::atomic<bool> interrupted{false};
void note_interrupt(int) { interrupted = true; }

using diagnosis::withheld::MakeProgress;

// Runs `work` with SIGINT and SIGTERM caught, progress with the time left, and problems as one line. `work` answers
// false where it was interrupted.
int run_interruptibly(const char* name, std::ostream& out, std::ostream& complaints,
                      const std::function<bool(const MakeProgress&)>& work) {
  interrupted = false;
  const auto before_int = std::signal(SIGINT, note_interrupt);
  const auto before_term = std::signal(SIGTERM, note_interrupt);
  const auto start = std::chrono::steady_clock::now();
  int fresh = 0;
  const MakeProgress progress = [&](int done, int all, const std::string& line) {
    out << fmt::format("{}/{} {}", done, all, line);
    if (line.find("there already") == std::string::npos) {
      const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      out << fmt::format(", about {:.0f} s left", spent / ++fresh * (all - done));
    }
    out << std::endl;
  };
  int code = 0;
  try {
    if (!work(progress)) {
      out << "interrupted; the same command goes on where it stopped\n";
      code = 130;
    }
  } catch (const std::exception& error) {
    complaints << "slewlab " << name << ": " << error.what() << '\n';
    code = 1;
  }
  std::signal(SIGINT, before_int);
  std::signal(SIGTERM, before_term);
  return code;
}

}  // namespace

int withhold_make(const WithholdMakeOptions& options, std::ostream& out, std::ostream& complaints) {
  using namespace slewlab::diagnosis::withheld;
  if (!options.purpose.empty() && options.purpose != "tune" && options.purpose != "score") {
    complaints << "--purpose is \"" << options.purpose << "\"; it must be tune or score\n";
    return 1;
  }
  MakeSettings settings;
  settings.cases = options.cases;
  settings.seed = options.seed;
  settings.purpose = options.purpose.empty() ? (options.seed < kFirstScoringSeed ? Purpose::kTune : Purpose::kScore)
                                             : (options.purpose == "tune" ? Purpose::kTune : Purpose::kScore);
  settings.directory = options.directory;
  settings.crane = options.crane;
  settings.controller = options.controller;
  settings.controller_period = options.controller_period_ms * 1e-3;
  settings.threads = options.threads;
  return run_interruptibly("withhold make", out, complaints, [&](const MakeProgress& progress) {
    if (!make_cases(settings, progress, &interrupted)) return false;
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
    const std::optional<ScoreTable> table = score_cases(settings, diagnose, informed, progress, &interrupted);
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
  score.threads = options.threads;
  return withhold_score(
      score,
      [settings](const diagnosis::withheld::CaseInput& input) { return diagnosis::diagnose_case(input, settings); },
      [settings](const diagnosis::withheld::CaseInput& input, const std::vector<std::string>& effects) {
        return diagnosis::informed_gap(input, effects, settings);
      },
      out, complaints);
}

}  // namespace slewlab::tools
