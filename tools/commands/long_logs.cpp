#include "tools/commands/long_logs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "diagnosis/stretch.h"

namespace slewlab::tools {

namespace {

constexpr double kNanosecond = 1e-9;    // [s]
constexpr double kNearlyWhole = 0.95;   // of a log, from which on it is not cut
constexpr std::size_t kMostSaid = 3;    // of stretches that were passed over
constexpr std::size_t kMostTried = 24;  // of a run

double total_length(const LoggedRuns& logged) {
  double total = 0.0;
  for (const LoggedRun& one : logged.runs) total += diagnosis::length_of(one.run);
  return total;
}

std::string place_of(const diagnosis::Stretch& stretch) {
  return fmt::format("{:.1f} to {:.1f} s", static_cast<double>(stretch.from) * kNanosecond, static_cast<double>(stretch.to) * kNanosecond);
}

// Where more logs were given than a stretch each leaves useful, those in which most moves. The others are named.
void leave_out_logs(const LongLogSettings& settings, LoggedRuns& logged) {
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(settings.most / settings.shortest));
  if (logged.runs.size() <= count) return;
  const auto motion = [&](const LoggedRun& one) {
    const double length = std::min(diagnosis::length_of(one.run), settings.shortest);
    const std::vector<diagnosis::Stretch> stretches = diagnosis::stretches_by_motion(one.run, length, settings.time);
    return stretches.empty() ? 0.0 : stretches.front().motion;
  };
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t r = 0; r < logged.runs.size(); ++r) ranked.emplace_back(-motion(logged.runs[r]), r);
  std::sort(ranked.begin(), ranked.end());
  std::vector<bool> is_kept(logged.runs.size(), false);
  for (std::size_t k = 0; k < count; ++k) is_kept[ranked[k].second] = true;
  std::vector<LoggedRun> kept;
  std::vector<std::string> remarks;
  for (std::size_t r = 0; r < logged.runs.size(); ++r) {
    LoggedRun& one = logged.runs[r];
    if (is_kept[r]) {
      kept.push_back(std::move(one));
    } else {
      remarks.push_back(fmt::format("{}: left out, for less moves in it than in {} other logs, of each of which {:.3g} s are fitted", one.name, count, settings.most / static_cast<double>(count)));
      remarks.insert(remarks.end(), one.remarks.begin(), one.remarks.end());
    }
  }
  logged.runs = std::move(kept);
  logged.runs.back().remarks.insert(logged.runs.back().remarks.end(), remarks.begin(), remarks.end());
}

struct Judged {
  diagnosis::Stretch stretch;
  double moves = 0.0;  // in what is judged of it
};

MeasuredRun part_of(const LoggedRun& one, const diagnosis::Stretch& stretch) {
  return {fmt::format("{} {}", one.name, place_of(stretch)), msgs::read_run(one.run, stretch.from, stretch.to), {}};
}

// The stretches of a run that can be judged, most moves first, and what was said of those that cannot. Of very long logs those are looked at in which most moves, as they are.
std::vector<Judged> judged_stretches(const LongLogSettings& settings, const LoggedRun& one, double length, std::vector<std::string>& passed_over) {
  std::vector<diagnosis::Stretch> stretches = diagnosis::stretches_by_motion(one.run, length, settings.time);
  stretches.resize(std::min(stretches.size(), kMostTried));
  std::vector<Judged> judged;
  for (const diagnosis::Stretch& stretch : stretches) {
    const MeasuredRun part = part_of(one, stretch);
    std::string problem;
    try {
      const double share = settings.judged_share(part);
      if (share >= settings.least_judged) judged.push_back({stretch, share * stretch.motion});
      else problem = fmt::format("{}: {:.0f} % of it lie away from impacts of the gears", part.name, 100.0 * share);
    } catch (const std::runtime_error& refused) {
      problem = refused.what();
    }
    if (!problem.empty() && passed_over.size() < kMostSaid) passed_over.push_back("passed over: " + problem);
  }
  std::stable_sort(judged.begin(), judged.end(), [](const Judged& a, const Judged& b) { return a.moves > b.moves; });
  return judged;
}

}  // namespace

FittedRuns fitted_runs(const LongLogSettings& settings, LoggedRuns&& logged) {
  const bool is_long = settings.most < kNearlyWhole * total_length(logged);
  if (is_long) leave_out_logs(settings, logged);
  std::vector<double> lengths;
  for (const LoggedRun& one : logged.runs) lengths.push_back(diagnosis::length_of(one.run));
  const std::vector<double> fitted = diagnosis::fitted_lengths(lengths, settings.most);
  FittedRuns runs{{{}, logged.is_damaged}, {{}, logged.is_damaged}};
  for (std::size_t r = 0; r < logged.runs.size(); ++r) {
    LoggedRun& one = logged.runs[r];
    std::vector<std::string> passed_over;
    std::vector<Judged> judged;
    if (is_long && fitted[r] < kNearlyWhole * lengths[r]) judged = judged_stretches(settings, one, fitted[r], passed_over);
    if (judged.empty()) {
      runs.fitted.runs.push_back({std::move(one.name), msgs::read_run(one.run), std::move(one.remarks)});
    } else {
      std::string said = fmt::format("{}: of its {:.4g} s {} are fitted, where most moves", one.name, lengths[r], place_of(judged[0].stretch));
      if (judged.size() > 1) said += fmt::format(", and {} try the answer", place_of(judged[1].stretch));
      one.remarks.push_back(said + "; --fitted-seconds fits more");
      one.remarks.insert(one.remarks.end(), passed_over.begin(), passed_over.end());
      runs.fitted.runs.push_back(part_of(one, judged[0].stretch));
      runs.fitted.runs.back().remarks = std::move(one.remarks);
      if (judged.size() > 1) runs.unseen.runs.push_back(part_of(one, judged[1].stretch));
    }
    one.run = {};
  }
  return runs;
}

}  // namespace slewlab::tools
