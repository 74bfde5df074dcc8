// Causes as a person reads them: effects with their sizes, and which other causes the records cannot tell from them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/screen.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

struct Size {
  std::string parameter;
  std::string unit;
  double value = 0.0;
  double deviation = 0.0;  // one standard deviation
  double low = 0.0, high = 0.0;  // 90 % interval
  bool may_be_none = false;      // of an effect's size: the records tell it from where the effect is absent by less than half of such an interval, laws aside
};

// Another cause that the records cannot tell from one.
struct Alike {
  std::string name;
  double apart = 0.0;  // share of the one's signature by which this one's differs
};

struct Cause {
  std::vector<std::string> effects;   // one or two; none: only parameters are off
  double probability = 0.0;
  double with_unknown_law = 0.0;      // share of it that is of the effect with a law beside it that is in no catalogue (unknown_law.h)
  double explained = 0.0;             // share of the gap explained, counted down to the residual of the best of all fits
  double mean_square = 0.0;
  double residual_power = 0.0, prior = 0.0;    // as in evidence.h
  Eigen::VectorXd information;         // as in evidence.h
  double prior_chance = 1.0;           // that machines of one make lie so far from their nominal values
  Ending ending = Ending::settled;     // why its fit ended
  std::vector<Size> sizes;            // of all effects' parameters
  Point point;                                              // the machine's part
  std::vector<AmountInterval> parameter_intervals;          // of its nuisance parameters
  std::vector<common::EffectInstance> controller_effects;  // the controller's part
  std::vector<Alike> group;
  std::vector<std::vector<std::string>> also;  // effects that move the machine just as its own do: one answer
  std::optional<Validation> validation;  // nothing where it was not asked for, or its sizes do not come from a fit
};

// "a", "a with b" or "only parameters are off".
std::string name_of(const std::vector<std::string>& effects);
std::string name_of(const Cause& cause);
// The same with what else it may be called: "a or b".
std::string told_name(const Cause& cause);

// Of all parameters of the effects, with their deviations by the curvature in the same order: 90 % intervals, as wide as laws differ. `catalogue` has the effects in the machine's units.
std::vector<Size> sizes_of(const common::EffectCatalogue& catalogue, const std::vector<common::EffectInstance>& effects, const std::vector<double>& deviations);

// `catalogue` as for sizes_of().
Cause make_cause(const common::EffectCatalogue& catalogue, const FitResult& result);

// Causes whose signatures, as fitted, cannot be told apart: single ones by all that they do, pairs that share an effect by what
// the other one does beside it. Probabilities and causes stand in the order of the fits.
void find_groups(const Problem& problem, const FitResult& base, const Projector& project, const std::vector<FitResult>& fits,
                 std::span<const double> probability, std::span<Cause> causes);

}  // namespace slewlab::diagnosis
