// Fits a hypothesis (a set of effects) to records with all nuisances free under their priors.
//
//   cost = L(s (sum(d^2) - n)) + sum(p(z)) + sum(q(x)),    L(c) = nu ln(1 + c / nu) for c > 0, c otherwise
//
// d are the n whitened differences (their mean square is the residual variance ratio, 1 = noise only), z the nuisances and x the effects' parameters,
// both in standard deviations of their priors p and q (nuisance.h). So cost is -2 ln of the posterior density. s is the share of the differences that
// are independent of each other: what mesh and step make wrong shows in many of them. What the noise cannot explain is mismatch of mesh, step and
// laws. Its size is not known beforehand, and with it integrated out a sum of squares counts as in a Student distribution of nu degrees of freedom
// (learned, docs/diagnosis/method.md): in full while it is small, by ratios when it is large. Gauss-Newton steps with the weight dL/dc, shortened
// where the cost would rise; the columns are difference quotients, corrected after each step by what it showed.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "common/effect.h"
#include "diagnosis/coordinates.h"
#include "diagnosis/evidence.h"
#include "diagnosis/least_squares.h"
#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

inline constexpr double kNoise = 0.1;                // share by which the sensors' noise is known
inline constexpr double kNoiseAlone = 1.0 + kNoise;  // largest residual variance ratio of noise alone
double mean_square(const Eigen::VectorXd& difference);

// What of the differences noise alone does not explain: s (sum(d^2) - n).
double residual_power(const Eigen::VectorXd& difference, const FitSettings& settings);

// L of the residual power, and dL/dc.
double discounted(double residual_power, double law_freedom);
double discounted_weight(double residual_power, double law_freedom);

// -2 ln of the prior at a point.
double prior_cost(const Problem& problem, const Point& point);

// The prior as rows below weighted differences: row k says -2 ln prior = (value + slope dz)^2 + constant about the point.
struct PriorRows {
  Eigen::VectorXd value, slope;
};
PriorRows prior_rows(const Problem& problem, const Point& point);

// Products of columns with each other.
Eigen::MatrixXd gram_of(const Eigen::MatrixXd& columns);

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
  double residual_power = 0.0;
  std::vector<double> nuisance_deviation;  // of each nuisance parameter, in standard deviations of its prior; from the curvature
  std::vector<double> deviation;     // of each effect parameter in order, in its own unit; the same
  int idle_rounds = 0;               // of its last rounds with fresh columns: they were worth little
  double cost_from_afar = std::numeric_limits<double>::infinity();  // at which it was last tried from afar
  double cost_elsewhere = std::numeric_limits<double>::infinity();  // and from typical shapes
};

// A machine as a point has it, before anything is fitted: no columns.
FitResult fit_at(Problem& problem, Point point);

// The nominal machine, before anything is fitted.
FitResult nominal_fit(Problem& problem);

// From where it stands with nothing known of its columns, for its cost.
void begin_anew(const Problem& problem, FitResult& result);

// What each record's beginning is like alone (the load's swing, where motors and boom stand), from where it stands: the parameters stay.
void fit_beginnings(Problem& problem, FitResult& result);

// Fits the effects of `start` and the nuisances, from there: one round with nuisance columns from somewhere near. Nuisances that an
// effect stands for (EffectAbout::stands_for) stay nominal.
FitResult fit(Problem& problem, const Eigen::MatrixXd& nuisance_columns, const Point& start);

// From a point of which no column is known, so many rounds with fresh ones at most.
FitResult fit_from(Problem& problem, Point start, int rounds);

// The same from where another fit stands, with its nuisance columns: on a nominal machine that has changed since.
FitResult fit_again(Problem& problem, const FitResult& fitted);

// Fresh columns, nuisances' and effects', where a fit stands.
void renew_columns(Problem& problem, FitResult& result);

// Goes on with the nuisance columns of another fit, where that has any.
void take_nuisance_columns(const Problem& problem, const Eigen::MatrixXd& columns, FitResult& result);

// A point moved by `change` in coordinates, nuisances first, within all bounds; and the change that leads from one to another.
Point moved(const common::EffectCatalogue& catalogue, const Point& point, const Eigen::VectorXd& change);
Eigen::VectorXd step_between(const common::EffectCatalogue& catalogue, const Point& from, const Point& to);

// Covariance of what the records and the priors leave open where a fit has ended, in coordinates, nuisances first.
Eigen::MatrixXd covariance(const Problem& problem, const FitResult& result);

// Where the fits have ended: prior, information, mean square and the spread of the sizes, from the curvature there.
void conclude(const Problem& problem, FitResult& result);

// The residual power and the prior of a fit where misfits count less than in it. By the fit's columns, the parameters would stand where
//   M(residual power - floor) + prior
// is least. A fit takes every unlikely value that noise or a law's misfit asks for; an evidence that discounts the misfit must not count the value in
// full.
struct Relaxed {
  double residual_power = 0.0, prior = 0.0;
};
// By `residual_power`, and how the fit's columns and differences change it: columns' products with each other and with the differences. No products: of a power, not of a motion.
struct PowerAbout {
  double residual_power = 0.0;
  Eigen::MatrixXd gram;
  Eigen::VectorXd slope;
};
Relaxed relax(const Problem& problem, const FitResult& result, const PowerAbout& power, const MisfitCost& misfit_cost, double floor);

// One more round from where it stands, with fresh columns of the effects and, if asked, of the nuisances. False: it was
// worth little, and so would be another.
bool improve(Problem& problem, FitResult& result, bool fresh_nuisances);

// From far off a discounted misfit has valleys of its own, where steps end. With as many degrees of freedom as there are independent
// differences (times so many) it is that of a noise whose size is not known, which leads on. At most so many rounds; the cost is the
// settings' afterwards.
void settle_from_afar(Problem& problem, FitResult& result, double times, int rounds);

// Rounds with fresh columns until two in a row were worth little: one may have stood in a narrow valley of two parameters, along which the next goes on.
void settle_until_idle(Problem& problem, FitResult& result);

// Whether a fit whose last round led from one cost to another would come down to `reach` in so many more at that pace.
bool would_come_down(double from, double to, int rounds, double reach);

// Rounds with fresh columns of both, at most as many, until one was worth little; none behind two such, and none where those that are left would not come
// down to `reach`.
void settle(Problem& problem, FitResult& result, int rounds, double reach = std::numeric_limits<double>::infinity());

// Rounds along the axes of what the records leave open, at most as many, to the floor of its valley: for fits whose costs are compared. Not further where those that are left would not come down to `reach`.
void settle_to_the_floor(Problem& problem, FitResult& result, int rounds, double reach = std::numeric_limits<double>::infinity());

}  // namespace slewlab::diagnosis
