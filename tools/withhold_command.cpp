#include "tools/withhold_command.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <ostream>

#include "common/input_error.h"
#include "diagnosis/withheld/make.h"

namespace slewlab::tools {

namespace {

std::atomic<bool> interrupted{false};
void note_interrupt(int) { interrupted = true; }

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
  interrupted = false;
  const auto before_int = std::signal(SIGINT, note_interrupt);
  const auto before_term = std::signal(SIGTERM, note_interrupt);
  int code = 0;
  try {
    const auto start = std::chrono::steady_clock::now();
    int made = 0;
    const auto progress = [&](int done, int all, const std::string& line) {
      const bool fresh = line.find("there already") == std::string::npos;
      if (fresh) ++made;
      const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      out << fmt::format("{}/{} {}", done, all, line);
      if (fresh) out << fmt::format(", about {:.0f} s left", spent / made * (all - done));
      out << std::endl;
    };
    if (make_cases(settings, progress, &interrupted)) {
      out << fmt::format("{} cases for \"{}\" in {}; answers sealed, digest in digest.txt\n", settings.cases,
                         name_of(settings.purpose), settings.directory.string());
    } else {
      out << "interrupted; the same command goes on where it stopped\n";
      code = 130;
    }
  } catch (const common::InputError& error) {
    complaints << error.what() << '\n';
    code = 1;
  } catch (const std::exception& error) {
    complaints << "withhold make: " << error.what() << '\n';
    code = 1;
  }
  std::signal(SIGINT, before_int);
  std::signal(SIGTERM, before_term);
  return code;
}

}  // namespace slewlab::tools
