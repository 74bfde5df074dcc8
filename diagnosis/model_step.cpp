#include "diagnosis/model_step.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

ModelSteps steps_for_forces(Problem& problem, std::span<const std::string> without, const EvidenceSettings& evidence) {
  std::vector<common::EffectInstance> starts = catalogue_starts(problem.catalogue, problem.nominal, without, last_moment(problem), problem.thresholds.spell_every);
  const std::vector<common::EffectInstance> of_all = what_every_machine_does(problem.catalogue, problem.nominal, without);
  starts.insert(starts.end(), of_all.begin(), of_all.end());
  int most = 1;
  for (const Record& record : problem.records) most = std::max(most, steps_of_the_settings(problem.nominal, record.step));
  ModelSteps steps_of;
  auto& [found, of_columns] = steps_of;
  std::vector<Point> open;  // that need more steps than were tried
  for (const common::EffectInstance& start : starts) {
    if (!acts_by_force(start.name) || !found.emplace(start.name, most).second) continue;
    open.emplace_back();
    open.back().effects = {start};
  }
  of_columns = found;
  if (most == 1) return steps_of;
  const ForceSteps before = problem.force_steps;
  const auto with_steps = [&](int steps) {
    for (const Point& point : open) problem.force_steps[point.effects.front().name] = steps;
    return differences(problem, open);
  };
  std::vector<Eigen::VectorXd> finest = with_steps(most);
  const Eigen::VectorXd none = differences(problem, Point{});
  const double share = problem.settings.independent_share;
  const auto is_enough = [&](const Eigen::VectorXd& coarse, const Eigen::VectorXd& fine) {
    const double gap = share * (fine - none).squaredNorm();
    return share * (coarse - fine).squaredNorm() <= kStepShare * (evidence.law_freedom + evidence.law_share * gap);
  };
  const auto is_enough_for_columns = [&](const Eigen::VectorXd& coarse, const Eigen::VectorXd& fine) { return (coarse - fine).norm() <= kColumnShare * (fine - none).norm(); };
  for (int steps = 1; steps < most && !open.empty(); steps *= 2) {
    const std::vector<Eigen::VectorXd> coarse = with_steps(steps);
    std::vector<Point> still_open;
    std::vector<Eigen::VectorXd> still_finest;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::string& name = open[i].effects.front().name;
      const bool is_done = is_enough(coarse[i], finest[i]);
      if (is_done || is_enough_for_columns(coarse[i], finest[i])) of_columns[name] = std::min(of_columns[name], steps);
      if (is_done) {
        found[name] = steps;
        continue;
      }
      still_open.push_back(open[i]);
      still_finest.push_back(std::move(finest[i]));
    }
    open = std::move(still_open);
    finest = std::move(still_finest);
  }
  problem.force_steps = before;
  return steps_of;
}

}  // namespace slewlab::diagnosis
