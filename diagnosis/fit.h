// Fits a hypothesis (a set of effects) to records with all nuisances free under their priors.
//
//   cost = L(s (sum(d^2) - n)) + sum(p(z)) + sum(q(x)),    L(c) = nu ln(1 + c / nu) for c > 0, c otherwise
//
// d are the n whitened differences (noise alone leaves a mean square of 1), z the nuisances and x the effects'
// parameters, both in standard deviations of their priors p and q (nuisance.h). So cost is -2 ln of the posterior density. s is the share of
// the differences that are independent of each other: what mesh and step make wrong shows in many of them. What the
// noise cannot explain is mismatch of mesh, step and laws; its size is not known beforehand, and with it integrated out
// a sum of squares counts as in a Student distribution of nu degrees of freedom (learned, docs/diagnosis/method.md): in full while
// it is small, by ratios when it is large. Gauss-Newton steps with the weight dL/dc, shortened where the cost would
// rise; the columns are difference quotients, corrected after each step by what it showed.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/effect.h"
#include "diagnosis/evidence.h"
#include "diagnosis/least_squares.h"
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

// Of a flexible boom, at least, whatever the machine's file has, unless the record is of a machine cut as the file has it. With half as
// many the higher modes stand so far off that the error of a large effect is fitted by a second one; 10, 12 and 16 leave the same.
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
  Records records;
  std::vector<Whitening> whitening;  // per record
  FitSettings settings;
  int threads = 1;
  std::atomic<int> helpers{0};  // threads besides the caller's that are at work now
  std::atomic<std::int64_t> simulations{0};
  std::atomic<std::int64_t> simulation_time{0};  // [ns] in them, summed over the threads
  mutable SimulationStock stock;
  const AddedPower* added_power = nullptr;         // by whose power the differences are divided
  std::function<bool()> is_stopped = [] { return false; };  // asked before every simulation: where true, unwind with Interrupted
};

struct Interrupted {};

// Calls work(0) to work(count - 1), on as many threads as are free, and returns when all are done. Calls nest: a share that shares out
// itself gets the threads that have become free by then, never more than `threads` together. Each call must write only what is its own,
// so that the results do not depend on who did them. The first exception is thrown again, and nothing new is begun after it.
void share_out(Problem& problem, std::size_t count, const std::function<void(std::size_t)>& work);

std::size_t nuisance_count(const Problem& problem);
double longest_record(const Problem& problem);  // [s]

// The machine at a point as it follows one of the records.
Shadow shadow_at(const Problem& problem, const Point& point, std::size_t record);

// How many whitened differences all records have.
Eigen::Index difference_count(const Problem& problem);

// The whitened differences of all records, one below the other.
Eigen::VectorXd differences(Problem& problem, const Point& point);

// The same for many points.
std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points);

// The same at one point, under what `courses` say of the drives, one for each record, and not the records.
Eigen::VectorXd differences(Problem& problem, const Point& point, std::span<const DriveCourse> courses);

// Where the differences of each record begin, and where the last ones end.
std::vector<Eigen::Index> first_rows(const Problem& problem);

double mean_square(const Eigen::VectorXd& difference);

// What of the differences noise alone does not explain: s (sum(d^2) - n).
double excess(const Eigen::VectorXd& difference, const FitSettings& settings);

// L of the excess, and dL/dc.
double discounted(double excess, double law_freedom);
double discounted_weight(double excess, double law_freedom);

// The prior as rows below weighted differences: row k says -2 ln prior = (value + slope dz)^2 + constant about the point.
struct PriorRows {
  Eigen::VectorXd value, slope;
};
PriorRows prior_rows(const Problem& problem, const Point& point);

// What a squared difference counts in the cost: s dL/dc.
double data_weight(const Eigen::VectorXd& difference, const FitSettings& settings);

struct FitResult {
  Point point;
  Eigen::VectorXd difference;
  Eigen::MatrixXd columns;           // d difference / d z, then d difference / d x
  double cost = 0.0;
  double prior = 0.0;                // sum(p(z)) + sum(q(x))
  Eigen::VectorXd information;       // eigenvalues of columns^T columns
  Ending ending = Ending::settled;   // of the last descent
  double mean_square = 0.0;          // of the differences
  double excess = 0.0;
  std::vector<double> deviation;     // of each effect parameter in order, in its own unit; from the curvature
};

// The nominal machine, before anything is fitted: no columns.
FitResult nominal_fit(Problem& problem);

// Where the hypotheses are compared: with the nuisances alone fitted, concluded.
FitResult fit_nuisances(Problem& problem, const FitResult& nominal);

// Fits the effects of `start` and the nuisances, from there: one round with nuisance columns from somewhere near. Nuisances that an
// effect stands for (EffectAbout::stands_for) stay nominal.
FitResult fit(Problem& problem, const Eigen::MatrixXd& nuisance_columns, const Point& start);

// Goes on with the nuisance columns of another fit, where that has any.
void take_nuisance_columns(const Problem& problem, const Eigen::MatrixXd& columns, FitResult& result);

// A point moved by `change` in coordinates, nuisances first, within all bounds.
Point moved(const common::EffectCatalogue& catalogue, const Point& point, const Eigen::VectorXd& change);

// Covariance of what the records and the priors leave open where a fit has ended, in coordinates, nuisances first.
Eigen::MatrixXd covariance(const Problem& problem, const FitResult& result);

// Where the fits have ended: prior, information, mean square and the spread of the sizes, from the curvature there.
void conclude(const Problem& problem, FitResult& result);

// What a fit leaves and what its point costs where misfits count less than in the fit: where the parameters would stand if
//   M(excess - floor) + prior
// were what is made small, by the fit's columns. A fit takes every unlikely value that noise or a law's misfit asks for; an evidence that
// discounts the misfit must not count the value in full.
struct Relaxed {
  double excess = 0.0, prior = 0.0;
};
Relaxed relax(const Problem& problem, const FitResult& result, const MisfitCost& misfit_cost, double floor);

// One more round from where it stands, with fresh columns of the effects and, if asked, of the nuisances. False: it was
// worth little, and so would be another.
bool improve(Problem& problem, FitResult& result, bool fresh_nuisances);

// From far off a discounted misfit has valleys of its own, where steps end. With as many degrees of freedom as there are independent
// differences (times so many) it is that of a noise whose size is not known, which leads on. At most so many rounds; the cost is the
// settings' afterwards.
void settle_from_afar(Problem& problem, FitResult& result, double times, int rounds);

// Rounds with fresh columns of both, at most as many, until one was worth little.
void settle(Problem& problem, FitResult& result, int rounds);

// Coordinates of effect parameters in standard deviations of their priors.
double to_coordinate(const common::EffectParameter& parameter, double value);
// The same back, within the parameter's bounds.
double value_at(const common::EffectParameter& parameter, double coordinate);
// An angle that may be any: what goes beyond half a turn comes back from the other side.
bool is_all_round(const common::EffectParameter& parameter);
// How much `value` changes per standard deviation of its prior, in its own unit.
double value_per_deviation(const common::EffectParameter& parameter, double value);

// Of all parameters of the effects, in their order; and the effects with their parameters there, within their bounds.
Eigen::VectorXd effect_coordinates(const common::EffectCatalogue& catalogue, std::span<const common::EffectInstance> effects);
std::vector<common::EffectInstance> effects_at(const common::EffectCatalogue& catalogue, std::vector<common::EffectInstance> effects,
                                               const Eigen::VectorXd& coordinates);

}  // namespace slewlab::diagnosis
