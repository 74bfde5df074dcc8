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

double total_length(const MeasuredRuns& measured) {
  double total = 0.0;
  for (const MeasuredRun& one : measured.runs) total += diagnosis::length_of(one.run);
  return total;
}

std::string place_of(const diagnosis::Stretch& stretch) {
  return fmt::format("{:.1f} to {:.1f} s", static_cast<double>(stretch.from) * kNanosecond, static_cast<double>(stretch.to) * kNanosecond);
}

// Where more logs were given than a stretch each leaves useful, those in which most moves. The others are named.
void leave_out_logs(const LongLogSettings& settings, MeasuredRuns& measured) {
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(settings.most / settings.shortest));
  if (measured.runs.size() <= count) return;
  const auto motion = [&](const MeasuredRun& one) {
    const double length = std::min(diagnosis::length_of(one.run), settings.shortest);
    const std::vector<diagnosis::Stretch> stretches = diagnosis::stretches_by_motion(one.run, length, settings.time);
    return stretches.empty() ? 0.0 : stretches.front().motion;
  };
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t r = 0; r < measured.runs.size(); ++r) ranked.emplace_back(-motion(measured.runs[r]), r);
  std::sort(ranked.begin(), ranked.end());
  std::vector<bool> is_kept(measured.runs.size(), false);
  for (std::size_t k = 0; k < count; ++k) is_kept[ranked[k].second] = true;
  std::vector<MeasuredRun> kept;
  std::vector<std::string> remarks;
  for (std::size_t r = 0; r < measured.runs.size(); ++r) {
    MeasuredRun& one = measured.runs[r];
    if (is_kept[r]) {
      kept.push_back(std::move(one));
    } else {
      remarks.push_back(fmt::format("{}: left out, for less moves in it than in {} other logs, of each of which {:.3g} s are fitted", one.name, count, settings.most / static_cast<double>(count)));
      remarks.insert(remarks.end(), one.remarks.begin(), one.remarks.end());
    }
  }
  measured.runs = std::move(kept);
  measured.runs.back().remarks.insert(measured.runs.back().remarks.end(), remarks.begin(), remarks.end());
}

struct Judged {
  diagnosis::Stretch stretch;
  MeasuredRun part;
  double moves = 0.0;  // in what is judged of it
};

// The stretches of a run that can be judged, most moves first, and what was said of those that cannot. Of very long logs those are looked at in which most moves, as they are.
std::vector<Judged> judged_stretches(const LongLogSettings& settings, const MeasuredRun& one, double length, std::vector<std::string>& passed_over) {
  std::vector<diagnosis::Stretch> stretches = diagnosis::stretches_by_motion(one.run, length, settings.time);
  stretches.resize(std::min(stretches.size(), kMostTried));
  std::vector<Judged> judged;
  for (const diagnosis::Stretch& stretch : stretches) {
    MeasuredRun part{fmt::format("{} {}", one.name, place_of(stretch)), diagnosis::cut(one.run, stretch), {}};
    std::string problem;
    try {
      const double share = settings.judged_share(part);
      if (share >= settings.least_judged) judged.push_back({stretch, std::move(part), share * stretch.motion});
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

std::vector<MeasuredRun> keep_stretches(const LongLogSettings& settings, MeasuredRuns& measured) {
  std::vector<MeasuredRun> unseen;
  if (settings.most >= kNearlyWhole * total_length(measured)) return unseen;
  leave_out_logs(settings, measured);
  std::vector<double> lengths;
  for (const MeasuredRun& one : measured.runs) lengths.push_back(diagnosis::length_of(one.run));
  const std::vector<double> fitted = diagnosis::fitted_lengths(lengths, settings.most);
  for (std::size_t r = 0; r < measured.runs.size(); ++r) {
    MeasuredRun& one = measured.runs[r];
    if (fitted[r] >= kNearlyWhole * lengths[r]) continue;
    std::vector<std::string> passed_over;
    std::vector<Judged> judged = judged_stretches(settings, one, fitted[r], passed_over);
    if (judged.empty()) continue;
    std::string said = fmt::format("{}: of its {:.4g} s {} are fitted, where most moves", one.name, lengths[r], place_of(judged[0].stretch));
    if (judged.size() > 1) said += fmt::format(", and {} try the answer", place_of(judged[1].stretch));
    std::vector<std::string> remarks = std::move(one.remarks);
    remarks.push_back(said + "; --fitted-seconds fits more");
    remarks.insert(remarks.end(), passed_over.begin(), passed_over.end());
    one = std::move(judged[0].part);
    one.remarks = std::move(remarks);
    if (judged.size() > 1) unseen.push_back(std::move(judged[1].part));
  }
  return unseen;
}

}  // namespace slewlab::tools
