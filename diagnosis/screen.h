// The whole catalogue, looked at once: what each effect, from each of its starts, could linearly take away of the residual of parameters alone. One
// simulation per start, and closer looks at the size that it forecasts.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/effect.h"
#include "diagnosis/fit.h"
#include "diagnosis/progress.h"

namespace slewlab::diagnosis {

inline constexpr double kLargestAmount = 20.0;         // of the screened size that a linear forecast is trusted with
inline constexpr double kLeastGain = 6.0;              // fall of the cost, forecast linearly, for which an effect is refined
inline constexpr std::size_t kStartsPerEffect = 2;     // that are refined at most

// Indices of the parameters that say when a spell is, of an effect that lasts for one.
struct SpellPlaces {
  std::size_t begin, duration, fade;
};
SpellPlaces places_of(const common::EffectAbout& about);

// The points from which an effect is tried: its typical size, and a fraction of it, where most laws are still linear;
// other sizes where the size enters not proportionally; other shapes. An angle that enters as a sine needs two
// quarters of each: the others follow from them (between_quarters), of two that multiply as well. Where there are two angles, only the
// typical size and the values worth a try are turned, all round and in every combination where the two do not multiply. An effect
// that lasts for a spell begins at many moments of the `duration` [s], `spell_every` [s] apart at least, and never ends (between_beginnings).
std::vector<common::EffectInstance> starts_of(const common::EffectAbout& about, double duration, double spell_every);

struct Screened {
  common::EffectInstance start;
  Eigen::VectorXd column;       // change of the differences by the start's size; empty where nobody asks for it any more
  double visibility = 0.0;      // sum of squares of the column, nuisances taken out
  double amount = 0.0;          // of the start's size, fitted
  double left = 0.0;            // sum of squares of its residual, linearly
};

// The point with the start added, its fading parameters scaled by `amount`.
Point with_amount(const common::EffectCatalogue& catalogue, Point point, const Screened& screened, double amount);

// Projects out what fitted parameters can imitate. Below the differences stand the rows of their prior, so that an effect
// that relieves parameters of an unlikely value counts for that too.
class Projector {
 public:
  // `prior` of the point where the columns were taken.
  Projector(const Eigen::MatrixXd& columns, PriorRows prior, double weight)
      : prior_(std::move(prior)), scale_(1.0 / std::sqrt(weight)), columns_(columns.rows() + columns.cols(), columns.cols()) {
    columns_.topRows(columns.rows()) = columns;
    columns_.bottomRows(columns.cols()) = (scale_ * prior_.slope).asDiagonal();
    factor_.compute(columns_.transpose() * columns_);
  }
  // Of the differences at the point itself.
  Eigen::VectorXd gap(const Eigen::VectorXd& difference) const {
    Eigen::VectorXd vector(columns_.rows());
    vector << difference, scale_ * prior_.value;
    return project(vector);
  }
  // Of a change of the differences, or of what another projector has made of one.
  Eigen::VectorXd operator()(const Eigen::VectorXd& change) const {
    Eigen::VectorXd vector = Eigen::VectorXd::Zero(columns_.rows());
    vector.head(change.size()) = change;
    return project(vector);
  }

 private:
  Eigen::VectorXd project(const Eigen::VectorXd& vector) const {
    return vector - columns_ * factor_.solve(columns_.transpose() * vector);
  }

  PriorRows prior_;
  double scale_;
  Eigen::MatrixXd columns_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

// Of what is fitted there.
Projector projector_of(const Problem& problem, const FitResult& fitted);

// The fit's machine with the effects that another one has too, and their columns.
FitResult common_ground(Problem& problem, const FitResult& fitted, const Point& other);

// Gives `screened` the multiple of the column that takes most of `target` away, at most `farthest`, and the sum of squares of the residual. A
// negative multiple only where the effect's size turns sign.
void try_amount(const common::EffectCatalogue& catalogue, const Eigen::VectorXd& column, const Eigen::VectorXd& target, Screened& screened, double farthest = kLargestAmount);

// Of one effect that begins at one moment each and never ends, at least two of them by rising beginnings, the best one from one
// beginning to a later one.
Screened between_beginnings(const common::EffectCatalogue& catalogue, const std::vector<const Screened*>& endless, const Eigen::VectorXd& target);

// The multiples x, y of two columns that take most of `target` away together; nothing where the columns are parallel: where
// 1 - cosine^2 is not above `least`.
struct Amounts {
  double x, y;
  double a_target, b_target;  // the columns' products with the target
};
std::optional<Amounts> joint_amounts(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& target, double least);

bool has_effect(std::span<const common::EffectInstance> effects, std::string_view name);

struct Screening {
  std::set<std::string> names;               // of the effects that were tried
  std::vector<Screened> tried;               // all starts and closer looks; with their columns the best of each effect, and all that the power of draws is asked of
  std::map<std::string, double> visibility;  // largest of each effect's
  Eigen::VectorXd gap;                       // residual of parameters alone, as the projector shows it
};
// From where the law comes again with one of the lengths [rad], its angles all round: beside the law's mean two quarters do not tell the others. None of a law that does not recur.
std::vector<common::EffectInstance> recurring_starts(const common::EffectAbout& about, std::span<const double> lengths);
// All starts of the machine's catalogue but of `without`, of what the nominal machine has, and of what is read off a record.
// `duration` [s] of the longest record, in which an effect may begin at any time; what recurs with an angle of the axis is tried with the `lengths` [rad] as well.
std::vector<common::EffectInstance> catalogue_starts(const common::EffectCatalogue& catalogue, const sim::MachineSettings& nominal, std::span<const std::string> without,
                                                     double duration, double spell_every, std::span<const double> lengths = {});
// What every machine does and a linear model leaves out, as it is; nothing of what the nominal machine has, or of `without`.
std::vector<common::EffectInstance> what_every_machine_does(const common::EffectCatalogue& catalogue, const sim::MachineSettings& nominal, std::span<const std::string> without);

// Of each effect the start with the smallest residual, in the order of their residuals; of all that was tried, or of some.
std::vector<const Screened*> best_of_each(const Screening& screening);
std::vector<const Screened*> best_of_each(std::vector<const Screened*> screened);

// The start, and where it has angles those a quarter turn on, in every combination: enough to tell what lies between.
std::vector<common::EffectInstance> with_quarters(const common::EffectAbout& about, const common::EffectInstance& start);

// The best of each effect, and where it has angles that one a quarter turn on: enough to look from elsewhere.
std::vector<common::EffectInstance> best_starts(const Problem& problem, const Screening& screening);

// Beside what `from` has already. The projector takes out what is fitted there.
Screening screen(Problem& problem, const FitResult& from, const Projector& project, std::span<const common::EffectInstance> starts,
                 const Progress& tell);

// Fall of the cost that the start promises.
double forecast(const Problem& problem, const FitResult& from, const Screening& screening, const Screened& screened);

}  // namespace slewlab::diagnosis
