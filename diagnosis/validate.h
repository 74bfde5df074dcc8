// Prediction of data that were not fitted. The last record, or of a single one its second half, is held out, and in its turn the first one (half). A
// hypothesis is fitted to the rest, and judged by its residual on the parts held out:
//
//   residual variance ratio      of the observer's missing torques and accelerations there, 1 = noise only, by what the noise is in its own machine (own_noise_fit.h)
//   relative closed-loop error   of the simulation from the operator's commands alone, where the controller is known
//
// against the nominal machine and against parameters alone. Of a hypothesis with stochastic effects the ratio is that of the mean residual of its
// draws to noise and what one draw adds. It must also predict the held-out part better than the same hypothesis in which what is stochastic is
// replaced by a power that nobody knows, learned in each third of an octave from the part that was fitted, in each channel or where one of its other
// effects acts. (A smooth power explains nearly any difference, so against the nominal machine alone it would always win.) Its closed loop is another
// draw's and is not compared. A size that the fitted part leaves open predicts as widely: sizes and parameters may move, at the cost of being
// elsewhere than the fitted part has them,
//
//   cost = min over x of (s |d(x)|^2 + x' C^-1 x) + ln det(1 + s D C D'),    C their covariance there, D = dd / dx
//
// which is -2 ln P(part held out | part fitted). The least is looked for from 0 and from where the fit of all records stands, the one held out among
// them. What is peculiar to the beginning of the held-out record (the load's swing, where the motors stand) is no property of the machine: it is
// fitted there, for every hypothesis alike.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

struct HeldOut {
  Point point;
  // Covariance of what the fitted part leaves open, in coordinates: the parameters of all records together, then those of the
  // effects that are not stochastic. Empty: nothing was fitted.
  Eigen::MatrixXd open;
  std::optional<Point> of_all;  // where a fit of all records stands, in the record held out, which is one of them; without what is stochastic
  std::string record;      // that it did not see: the last one, or of a single one the second half
  double from_time = 0.0;  // [s] from which it did not
  bool is_half = false;
};

// The last record that was judged, as the nominal machine follows it and as that of the first cause does, without its stochastic effects.
struct Followed {
  std::string record;
  bool begins_bent = false;  // so that nobody knows from where its run would be simulated
  double start_time = 0.0, step = 0.0;  // [s] of the grid on which it was judged
  Shadow nominal, explained;
};

// The residual of a hypothesis on the data held out.
struct ValidationError {
  double differences = 0.0;     // how many
  double residual_ratio = 0.0;
  double cost = 0.0;  // -2 ln P of the independent ones among the differences, given the fitted part, but for a constant
  std::optional<double> closed_loop;
};

struct Validation {
  ValidationError nominal, parameters, cause;
  std::optional<double> unknown_cost;  // of a power that nobody knows in the stochastic effects' place; nothing where the cause has none
  bool holds = false;  // the cause predicts better than either
  bool is_said_by_parameters = false;  // its effects are parameters grown beyond what they differ by
};

// Whether a simulation with the effect at its size is the machine's motion: not read off a record, not one draw of many.
bool has_fit(const common::EffectAbout& effect);

// The effects of a point that are stochastic, and the point without them.
std::vector<common::EffectInstance> stochastic_part(const common::EffectCatalogue& catalogue, const Point& point);
Point without_stochastic(const common::EffectCatalogue& catalogue, Point point);

// What of an answer's machine can be fitted again on other records; nothing where none of it can.
std::optional<Point> fitted_part(const common::EffectCatalogue& catalogue, const Point& answer);

// Times the error of another hypothesis in closed loop, up to which the true one may be further off; chosen.
inline constexpr double kWorse = 1.05;

// Whether the cause's residual falls by more than chance lets it, and its closed loop does not get worse.
bool is_better(const ValidationError& cause, const ValidationError& than);
// Whether it is better than the nominal machine and parameters alone, and than an unknown power. An effect that `is_said_by_parameters` as well, because it is
// one of them grown, predicts what they do, and is not asked to be better than these.
bool holds(const Validation& validation, bool is_said_by_parameters = false);

// Of two parts held out: the ratio over all differences, the sum of the costs, the root of the mean square of the closed loops.
ValidationError together(const ValidationError& one, const ValidationError& other);

enum class HeldOutPart { first, last };  // record, or half of a single one

// The records of a problem in two parts. The problem must outlive them.
class HeldOutData {
 public:
  HeldOutData(const Problem& problem, const WhiteningSettings& settings, HeldOutPart part);
  // The records of `problem`, and one that is none of them. Throws NotAdmitted as admit() does.
  HeldOutData(const Problem& problem, const WhiteningSettings& settings, Record unseen, std::vector<std::string>& remarks);

  // The hypothesis of `answer` fitted to what is not held out, from where `answer` stands; without nuisance parameters, from the nominal machine.
  HeldOut fit(const Point& answer);
  ValidationError error(const HeldOut& fitted, const std::optional<controller::ControllerSettings>& controller);
  // [Nm per motor] root of the mean square of the observer's missing torque where the part held out is judged, over the groups, of `fitted` without
  // its stochastic effects.
  double missing_torque(const HeldOut& fitted) const;
  // The cost of `point`, which has no stochastic effect, with a power beside it that nobody knows, as large as its residual on the fitted part: in
  // each channel on its own, or along the axes of one of its effects, as the residual of that effect's law would act. The least of them.
  double unknown_cost(const Point& point);

  std::int64_t simulations() const { return fitted_->simulations + predicted_->simulations; }
  std::int64_t simulation_time() const { return fitted_->simulation_time + predicted_->simulation_time; }  // [ns]

 private:
  HeldOut fit_with_stochastic(const Point& answer);
  Point at_held_out(const Point& point) const;
  std::optional<Point> of_all(const Point& answer) const;
  std::vector<double> without_held_out(std::vector<double> amounts) const;

  std::unique_ptr<Problem> fitted_, predicted_;
  double from_time_ = 0.0;  // [s]
  double free_of_impacts_ = 0.0;  // share of the record held out, all of it where it is a half
  bool is_half_ = false;
  // Of a point's nuisance parameters: the first and the one behind the last of the beginning of the record held out; both 0: it is none of those that
  // were fitted.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> beginning_{0, 0};
};

}  // namespace slewlab::diagnosis
