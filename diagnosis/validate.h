// Prediction of data that were not fitted. The last record, or of a single one its second half, is held out; a hypothesis is fitted to
// the rest from the nominal machine, and judged by what it leaves of the part held out:
//
//   residual variance ratio      of the observer's missing torques and accelerations there, 1 = noise only
//   relative closed-loop error   of the simulation from the operator's commands alone, where the controller is known
//
// against the nominal machine and against parameters alone. What is peculiar to the beginning of the held-out record (the load's swing, where
// the motors stand) is no property of the machine: it is fitted there, for every hypothesis alike.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "controller/controller.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

struct HeldOut {
  Point point;
  std::string record;      // that it did not see: the last one, or of a single one the second half
  double from_time = 0.0;  // [s] from which it did not
  bool is_half = false;
};

// The last record that was judged, as the nominal machine follows it and as that of the first cause does, without its stochastic effects.
struct Followed {
  std::string record;
  Shadow nominal, explained;
};

// What a hypothesis leaves of the data held out.
struct ValidationError {
  double residual_ratio = 0.0;
  std::optional<double> closed_loop;
};

struct Validation {
  ValidationError nominal, parameters, cause;
  bool holds = false;  // the cause predicts better than either
};

// Whether the effect's sizes come from a fit that can be repeated on other records: not read off a record, not stochastic.
bool has_fit(const common::EffectAbout& effect);

// The records of a problem in two parts.
class HeldOutData {
 public:
  // `follower` is the nominal machine's shadow of the last record.
  HeldOutData(const Problem& problem, const WhiteningSettings& settings, const Shadow& follower);

  // The hypothesis of `answer` fitted from the nominal machine to what is not held out.
  HeldOut fit(const Point& answer);
  ValidationError error(const Point& point, const std::optional<controller::ControllerSettings>& controller);
  // Whether the cause's residual falls by more than chance lets it, and its closed loop does not get worse.
  bool is_better(const ValidationError& cause, const ValidationError& than) const;

  std::int64_t simulations() const { return fitted_->simulations + predicted_->simulations; }
  std::int64_t simulation_time() const { return fitted_->simulation_time + predicted_->simulation_time; }  // [ns]

 private:
  std::unique_ptr<Problem> fitted_, predicted_;
  double from_time_ = 0.0;  // [s]
  bool is_half_ = false;
};

}  // namespace slewlab::diagnosis
