#include "diagnosis/validate.h"

#include <algorithm>

#include "diagnosis/chance.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kHeldOutRounds = 3;  // at most, with fresh columns

}  // namespace

bool has_fit(const common::EffectAbout& effect) { return effect.read_off == common::ReadOff::none && !comes_by_chance(effect); }

HeldOut fit_without_last(Problem& problem, const WhiteningSettings& settings, const Shadow& follower, const Point& answer) {
  const Record& last = problem.records.back();
  HeldOut held{answer, last.name, last.start_time, problem.records.size() == 1};
  if (held.is_half) {
    std::vector<bool> trusted = trusted_stretches(last, follower, settings);
    std::fill(trusted.begin() + static_cast<std::ptrdiff_t>(last.size() / 2), trusted.end(), false);
    problem.whitening = {make_whitening(last, trusted, problem.gains, follower, settings)};
    held.from_time = last.time(last.size() / 2);
  } else {
    problem.records.pop_back();
    problem.whitening.pop_back();
  }
  held.point.nuisance.assign(nuisance_count(problem), 0.0);
  const auto nuisances = static_cast<Eigen::Index>(held.point.nuisance.size());
  FitResult result = fit(problem, Eigen::MatrixXd::Zero(difference_count(problem), nuisances), held.point);
  settle(problem, result, kHeldOutRounds);
  held.point = result.point;
  return held;
}

}  // namespace slewlab::diagnosis
