#include "diagnosis/problem.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "diagnosis/hidden_commands.h"
#include "diagnosis/own_noise.h"
#include "diagnosis/stochastic.h"
#include "sim/integrate/batch.h"
#include "sim/machine/effect_scales.h"
#include "sim/model/cannot_be_built.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kVeryFarOff = 1e3;    // whitened difference of a machine that cannot follow at all
constexpr double kNotStable = 1e12;    // one beyond which a machine is not stable: its motion grows without end, and only the record's end keeps it from a number that is none
constexpr std::size_t kMostRoom = std::size_t{1} << 28;  // [bytes] of the series of one thread's simulations: eight of ten minutes at 1 kHz

}  // namespace

bool has_same_effects(const Point& a, const Point& b) {
  const auto is_one_name = [](const common::EffectInstance& x, const common::EffectInstance& y) { return x.name == y.name; };
  return a.effects.size() == b.effects.size() && std::is_permutation(a.effects.begin(), a.effects.end(), b.effects.begin(), is_one_name);
}

sim::MachineSettings with_boom_elements(sim::MachineSettings machine, int least) {
  sim::BoomParameters& boom = machine.crane.boom;
  if (boom.element_count > 0) boom.element_count = std::max(boom.element_count, least);
  return machine;
}

sim::MachineSettings machine_at(const sim::MachineSettings& nominal, const Nuisances& nuisances, const Point& point) {
  sim::MachineSettings settings = nominal;
  settings.crane = with_nuisances(nuisances, settings.crane, point.nuisance);
  if (point.seed != 0) settings.seed = point.seed;
  settings.effects.insert(settings.effects.end(), point.effects.begin(), point.effects.end());
  if (!settings.effects.empty() && !settings.scales) settings.scales = sim::effect_scales(nominal.crane, nominal.drive_protection);
  return settings;
}

Eigen::Index difference_count(const Problem& problem) {
  return first_rows(problem).back();
}

std::unique_ptr<Problem> same_machine(const Problem& problem) {
  auto other = std::make_unique<Problem>();
  other->nominal = problem.nominal;
  other->catalogue = problem.catalogue;
  other->thresholds = problem.thresholds;
  other->nuisances = problem.nuisances;
  other->gains = problem.gains;
  other->force_steps = problem.force_steps;
  other->column_steps = problem.column_steps;
  other->commands_per_row = problem.commands_per_row;
  other->settings = problem.settings;
  other->threads = problem.threads;
  other->is_stopped = problem.is_stopped;
  return other;
}

std::size_t nuisance_count(const Problem& problem) { return problem.nuisances.count(problem.records.size()); }

double longest_record(const Problem& problem) {
  double longest = 0.0;
  for (const Record& record : problem.records) longest = std::max(longest, record.step * static_cast<double>(record.size()));
  return longest;
}

double last_moment(const Problem& problem) {
  double last = 0.0;
  for (const Record& record : problem.records) last = std::max(last, record.effects_begin() + record.step * static_cast<double>(record.size()));
  return last;
}

const DriveCourse& SimulationStock::drives(const Record& record, std::size_t index, const sim::DriveProtectionSettings& protection) {
  const std::lock_guard lock(mutex_);
  if (drives_.size() <= index) drives_.resize(index + 1);
  if (!drives_[index]) drives_[index] = std::make_unique<const DriveCourse>(drive_course(record, protection));
  return *drives_[index];
}

std::unique_ptr<SimulationRoom> SimulationStock::take_room() {
  const std::lock_guard lock(mutex_);
  if (rooms_.empty()) return std::make_unique<SimulationRoom>();
  std::unique_ptr<SimulationRoom> room = std::move(rooms_.back());
  rooms_.pop_back();
  return room;
}

void SimulationStock::give_back(std::unique_ptr<SimulationRoom> room) {
  const std::lock_guard lock(mutex_);
  rooms_.push_back(std::move(room));
}

namespace {

Shadowing shadowing_at(const Problem& problem, Follower follower, const Point& point, std::size_t record, Shadow& result) {
  return {std::move(follower), encoder_latency(problem.nuisances, point.nuisance), beginning_of(problem.nuisances, point.nuisance, record), &result};
}

// Commands between the rows act ahead as the point has it; in `ahead`, which must live as long.
void take_lead(const Problem& problem, const Point& point, std::size_t record, std::optional<MoreTorques>& ahead, Shadowing& shadowing) {
  const double lead = command_lead(problem.nuisances, point.nuisance);
  if (lead == 0.0) return;
  ahead = torques_ahead(problem.records[record], lead);
  shadowing.more_torques.push_back(&*ahead);
}

const DriveCourse& drives_of(const Problem& problem, std::size_t record) {
  return problem.stock.drives(problem.records[record], record, problem.nominal.drive_protection);
}

}  // namespace

std::vector<Eigen::Index> first_rows(const Problem& problem) {
  std::vector<Eigen::Index> rows{0};
  for (const Whitening& whitening : problem.whitening) rows.push_back(rows.back() + whitening.size());
  return rows;
}

Shadow shadow_at(const Problem& problem, const Point& point, std::size_t record) {
  Shadow result;
  std::vector<Shadowing> alone;
  alone.push_back(shadowing_at(problem, follower_of(machine_at(problem.nominal, problem.nuisances, point), grid_of(problem.records[record]), problem.force_steps), point, record,
                               result));
  std::optional<MoreTorques> ahead;
  take_lead(problem, point, record, ahead, alone.front());
  shadow(std::move(alone), problem.records[record], drives_of(problem, record), problem.gains);
  return result;
}

void share_out(Problem& problem, std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto take_shares = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::jthread> helpers;
  while (helpers.size() + 1 < count) {
    if (++problem.helpers >= problem.threads) {
      --problem.helpers;
      break;
    }
    helpers.emplace_back([&] {
      take_shares();
      --problem.helpers;
    });
  }
  take_shares();
  helpers.clear();
  if (failure) std::rethrow_exception(failure);
}

namespace {

// Series of one machine's Shadow [bytes].
std::size_t room_for(const Record& record) {
  const auto accelerometers = static_cast<std::size_t>(std::count_if(record.acceleration.begin(), record.acceleration.end(),
                                                                     [](const std::vector<double>& series) { return !series.empty(); }));
  return (static_cast<std::size_t>(record.group_count) + accelerometers) * record.size() * sizeof(double);
}

// Simulations that one thread takes on at once: as many machines as a batch has lanes, no more where that leaves a thread without work, nor
// than there is room for: of an hour at 1 kHz, one.
std::size_t side_by_side(const Problem& problem, std::size_t points) {
  const auto threads = static_cast<std::size_t>(problem.threads), records = problem.records.size();
  std::size_t most = sim::is_supported(sim::BatchWidth::eight) ? 8 : 4;
  for (const Record& record : problem.records) most = std::clamp(kMostRoom / std::max<std::size_t>(1, room_for(record)), std::size_t{1}, most);
  const std::size_t shares = std::max<std::size_t>(1, threads / records);  // of the points, one for each thread
  return std::clamp((points + shares - 1) / shares, std::size_t{1}, most);
}

// The whitened differences of some of the points, under those torques where there are any, from one of the records. A machine that is not there, because its boom buckles, is far off.
void differ(Problem& problem, std::span<const Point> points, std::span<const std::optional<Follower>> followers, std::size_t r,
            std::span<const std::vector<MoreTorques>> torques, std::span<Eigen::VectorXd> results, Eigen::Index first_row) {
  std::unique_ptr<SimulationRoom> room = problem.stock.take_room();
  if (room->shadows.size() < points.size()) room->shadows.resize(points.size());
  std::vector<Shadowing> shadowings;
  std::vector<std::optional<MoreTorques>> ahead(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!followers[i]) continue;
    shadowings.push_back(shadowing_at(problem, *followers[i], points[i], r, room->shadows[i]));
    if (!torques.empty() && !torques[i].empty()) shadowings.back().more_torques.push_back(&torques[i][r]);
    take_lead(problem, points[i], r, ahead[i], shadowings.back());
  }
  shadow(std::move(shadowings), problem.records[r], drives_of(problem, r), problem.gains);
  for (std::size_t i = 0; i < points.size(); ++i) {
    auto rows = results[i].segment(first_row, problem.whitening[r].size());
    if (followers[i]) {
      whiten(problem.whitening[r], room->shadows[i], room->transform, rows);
    } else {
      rows.setConstant(kVeryFarOff);
    }
  }
  problem.stock.give_back(std::move(room));
  problem.simulations += static_cast<std::int64_t>(points.size());
}

// `torques`: for each point those of each record, or none.
std::vector<Eigen::VectorXd> differences_under(Problem& problem, std::span<const Point> points, std::span<const std::vector<MoreTorques>> torques, const ForceSteps& force_steps) {
  const std::vector<Eigen::Index> first_row = first_rows(problem);
  std::vector<Eigen::VectorXd> results(points.size(), Eigen::VectorXd(first_row.back()));
  const auto count_time = [&](std::chrono::steady_clock::time_point begun) {
    problem.simulation_time +=
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - begun).count();
  };
  // Nothing where its boom buckles; any other error is one of the program's.
  const auto machine_for = [&](const Point& point, const Record& record) -> std::optional<Follower> {
    try {
      return follower_of(machine_at(problem.nominal, problem.nuisances, point), grid_of(record), force_steps);
    } catch (const sim::CannotBeBuilt&) {
      return std::nullopt;
    }
  };
  std::vector<std::optional<Follower>> made(points.size());
  share_out(problem, points.size(), [&](std::size_t i) {
    const auto begun = std::chrono::steady_clock::now();
    made[i] = machine_for(points[i], problem.records.front());
    count_time(begun);
  });
  const std::size_t together = side_by_side(problem, points.size()), records = problem.records.size();
  share_out(problem, (points.size() + together - 1) / together * records, [&](std::size_t share) {
    const auto begun = std::chrono::steady_clock::now();
    const std::size_t r = share % records, first = share / records * together, count = std::min(together, points.size() - first);
    for (std::size_t simulation = 0; simulation < count; ++simulation) {
      if (problem.is_stopped()) throw Interrupted{};
    }
    std::vector<std::optional<Follower>> followers(made.begin() + static_cast<std::ptrdiff_t>(first), made.begin() + static_cast<std::ptrdiff_t>(first + count));
    if (grid_of(problem.records[r]) != grid_of(problem.records.front())) {
      for (std::size_t i = 0; i < count; ++i) followers[i] = machine_for(points[first + i], problem.records[r]);
    }
    differ(problem, points.subspan(first, count), followers, r, torques.empty() ? torques : torques.subspan(first, count),
           std::span(results).subspan(first, count), first_row[r]);
    count_time(begun);
  });
  if (problem.is_by_own_noise) {
    share_out(problem, points.size(), [&](std::size_t i) {
      if (made[i] && results[i].allFinite()) results[i] = divided_by_own_noise(problem, points[i], results[i]);
    });
  }
  for (Eigen::VectorXd& result : results) {
    // A machine that is not stable at an odd point counts as very far off as well, not as a number that spreads.
    if (!result.allFinite() || result.cwiseAbs().maxCoeff() > kNotStable) result.setConstant(kVeryFarOff);
    if (problem.added_power == nullptr) continue;
    if (problem.added_power->mean.size() > 0) result += problem.added_power->mean;
    result = divided(*problem.added_power, result);
  }
  return results;
}

// With few steps a machine that is stable need not be.
bool is_followed(const Eigen::VectorXd& difference) { return difference.cwiseAbs().maxCoeff() < kVeryFarOff; }

bool takes_fewer_steps(const Problem& problem, std::span<const common::EffectInstance> effects) {
  return std::any_of(effects.begin(), effects.end(), [&](const common::EffectInstance& effect) {
    const auto few = problem.column_steps.find(effect.name), all = problem.force_steps.find(effect.name);
    return few != problem.column_steps.end() && all != problem.force_steps.end() && few->second < all->second;
  });
}

}  // namespace

Eigen::VectorXd differences(Problem& problem, const Point& point) {
  return std::move(differences_under(problem, {&point, 1}, {}, problem.force_steps).front());
}

std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points, std::span<const std::vector<MoreTorques>> torques) {
  return differences_under(problem, points, torques, problem.force_steps);
}

std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points) { return differences_under(problem, points, {}, problem.force_steps); }

ColumnBase column_base(Problem& problem, const Point& point, const Eigen::VectorXd& difference, const std::vector<MoreTorques>& torques) {
  ColumnBase base{difference, {}};
  if (!takes_fewer_steps(problem, point.effects) && !takes_fewer_steps(problem, problem.nominal.effects)) return base;
  Eigen::VectorXd by_few_steps = std::move(differences_under(problem, {&point, 1}, {&torques, 1}, problem.column_steps).front());
  if (is_followed(by_few_steps)) base.by_few_steps = std::move(by_few_steps);
  return base;
}

std::vector<Eigen::VectorXd> changes(Problem& problem, const ColumnBase& base, std::span<const Point> points, std::span<const std::vector<MoreTorques>> torques) {
  const auto changed_by = [&](const ForceSteps& steps, const Eigen::VectorXd& from) {
    std::vector<Eigen::VectorXd> result = differences_under(problem, points, torques, steps);
    const bool are_followed = std::all_of(result.begin(), result.end(), is_followed);
    for (Eigen::VectorXd& one : result) one -= from;
    return std::pair(std::move(result), are_followed);
  };
  if (base.by_few_steps) {
    auto [result, are_followed] = changed_by(problem.column_steps, *base.by_few_steps);
    if (are_followed) return std::move(result);
  }
  return changed_by(problem.force_steps, base.difference).first;
}

}  // namespace slewlab::diagnosis
