// Everything that stays the same over one diagnosis, and the residual of a hypothesis: the whitened differences between the records and the machine
// at a point as it follows them. Machines side by side, records and points on all threads; the same bits on any number of them.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/effect.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/whitening.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

struct FitSettings {
  double law_freedom = 100.0;      // nu
  double independent_share = 0.3;  // s
  int iterations = 4;      // per round, each round with fresh columns
  int attempts = 12;       // per round along a valley's floor
  int rounds = 12;         // at most, for the nuisances alone
  // Falls of the cost that were too small to go on: the fixed part in units of -2 ln of a probability.
  double enough = 0.5, enough_share = 0.002;   // of an iteration
  double settled = 2.0, settled_share = 0.01;  // of a round
};

// A point in the space of hypotheses.
struct Point {
  std::vector<double> nuisance;                 // in standard deviations: parameters, latency, each record's swing (nuisance.h)
  std::vector<common::EffectInstance> effects;  // parameter values in SI
  std::uint64_t seed = 0;                       // of the effects that draw numbers
};

// Whether two points name the same effects, whatever their order and sizes.
bool has_same_effects(const Point& a, const Point& b);

// Of a flexible boom, at least, whatever the machine's file has, unless the record is of a machine cut as the file has it. With half as many the
// higher modes are so far off that a second effect fits the error of a large one; with 10, 12 and 16 the residual is the same.
inline constexpr int kBoomElements = 12;

// The machine with its boom, where it has one that bends, cut into as many elements at least.
sim::MachineSettings with_boom_elements(sim::MachineSettings machine, int least);

// The nominal machine moved to a point.
sim::MachineSettings machine_at(const sim::MachineSettings& nominal, const Nuisances& nuisances, const Point& point);

struct AddedPower;  // stochastic.h

// What machines side by side are simulated in, used again by the next ones.
struct SimulationRoom {
  std::vector<Shadow> shadows;  // one for each machine
  TransformRoom transform;      // for one after the other
};

// What the simulations of a problem have in common, made when it is first asked for. The records must not change from then on.
class SimulationStock {
 public:
  // What a record's drives deliver.
  const DriveCourse& drives(const Record& record, std::size_t index, const sim::DriveProtectionSettings& protection);
  std::unique_ptr<SimulationRoom> take_room();
  void give_back(std::unique_ptr<SimulationRoom> room);

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<const DriveCourse>> drives_;  // per record
  std::vector<std::unique_ptr<SimulationRoom>> rooms_;      // that nobody works in
};

// A problem's records: its own, or some that another problem owns, which must outlive it. One of an hour at 1 kHz takes half a
// gigabyte, so that parts of a problem look at its records.
class Records {
 public:
  Records() = default;
  Records(const Records&) = delete;
  Records& operator=(const Records&) = delete;

  void push_back(Record record) {
    own_.push_back(std::move(record));
    seen_ = own_;
  }
  void look_at(std::span<const Record> others) { seen_ = others; }
  // Of one of its own; gives those that it had.
  std::vector<bool> set_impacts(std::size_t r, std::vector<bool> impacts_of_cause) { return std::exchange(own_.at(r).impacts_of_cause, std::move(impacts_of_cause)); }

  std::size_t size() const { return seen_.size(); }
  bool empty() const { return seen_.empty(); }
  const Record* data() const { return seen_.data(); }
  auto begin() const { return seen_.begin(); }
  auto end() const { return seen_.end(); }
  const Record& operator[](std::size_t r) const { return seen_[r]; }
  const Record& front() const { return seen_.front(); }
  const Record& back() const { return seen_.back(); }

 private:
  std::vector<Record> own_;
  std::span<const Record> seen_;
};

// Everything that stays the same over one diagnosis. Counts simulations; may be asked to stop.
struct Problem {
  // Without the modes above `highest_mode` of the thresholds: they would take a fifth of a simulation's time and change the differences,
  // of which none is above a fifth of it, by less than a hundredth of the noise (test).
  sim::MachineSettings nominal;
  common::EffectCatalogue catalogue;  // the effects that suit the nominal machine, in its units
  Thresholds thresholds;
  Nuisances nuisances;
  ShadowGains gains;                 // of the nominal crane
  ForceSteps force_steps;            // of the model between two readings (model_step.h)
  ForceSteps column_steps;           // the same for columns, which ask for less
  int commands_per_row = 1;          // that a record is taken to have (hidden_commands.h)
  Records records;
  std::vector<Whitening> whitening;  // per record
  FitSettings settings;
  int threads = 1;
  std::atomic<int> helpers{0};  // threads besides the caller's that are at work now
  std::atomic<std::int64_t> simulations{0};
  std::atomic<std::int64_t> simulation_time{0};  // [ns] in them, summed over the threads
  mutable SimulationStock stock;
  const AddedPower* added_power = nullptr;         // by whose power the differences are divided
  bool is_by_own_noise = false;                    // whether each point's differences are divided by what the noise is in its own machine (own_noise.h), at several times the cost
  std::function<bool()> is_stopped = [] { return false; };  // asked before every simulation: where true, unwind with Interrupted
};

struct Interrupted {};

// Of another problem on the same machine: all but its records and how they are whitened.
std::unique_ptr<Problem> same_machine(const Problem& problem);

// Calls work(0) to work(count - 1), on as many threads as are free, and returns when all are done. Calls nest: a share that shares out
// itself gets the threads that have become free by then, never more than `threads` together. Each call must write only what is its own,
// so that the results do not depend on who did them. The first exception is thrown again, and nothing new is begun after it.
void share_out(Problem& problem, std::size_t count, const std::function<void(std::size_t)>& work);

std::size_t nuisance_count(const Problem& problem);
double longest_record(const Problem& problem);  // [s]
double last_moment(const Problem& problem);     // [s] of the effects' time in any record

// The machine at a point as it follows one of the records.
Shadow shadow_at(const Problem& problem, const Point& point, std::size_t record);

// How many whitened differences all records have.
Eigen::Index difference_count(const Problem& problem);

// The whitened differences of all records, one below the other.
Eigen::VectorXd differences(Problem& problem, const Point& point);

// The same for many points.
std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points);

// The same, each point under more torques of its own, those of each record, or none.
std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points, std::span<const std::vector<MoreTorques>> torques);

// Where columns are taken: the differences of a point, and where effects act by forces those by as few of the model's steps as are enough for columns. Under torques where there are any.
struct ColumnBase {
  Eigen::VectorXd difference;
  std::optional<Eigen::VectorXd> by_few_steps;
};
ColumnBase column_base(Problem& problem, const Point& point, const Eigen::VectorXd& difference, const std::vector<MoreTorques>& torques = {});

// By how much the differences of other points are others, each under torques of its own where there are any.
std::vector<Eigen::VectorXd> changes(Problem& problem, const ColumnBase& base, std::span<const Point> points, std::span<const std::vector<MoreTorques>> torques = {});

// Where the differences of each record begin, and where the last ones end.
std::vector<Eigen::Index> first_rows(const Problem& problem);

}  // namespace slewlab::diagnosis
