// Fits a hypothesis (a set of effects) to records with all nuisances free under their priors.
//
//   cost = nu * mean(d^2) + sum(z^2) + sum(x^2)
//
// d are the whitened differences (1 is what a good model still misses), z the nuisances and x the effects'
// parameters, both in standard deviations of their priors. nu is the number of independent differences that
// the many correlated ones are worth (learned, docs/diagnosis.md). Gauss-Newton steps, shortened where the cost would
// rise; the columns are difference quotients, corrected after each step by what it showed.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/effect.h"
#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "diagnosis/whitening.h"
#include "sim/machine_settings.h"

namespace slewlab::diagnosis {

struct FitSettings {
  double independent_differences = 2000.0;  // nu
  int iterations = 4;      // per round, each round with fresh columns
  int rounds = 4;          // at most, for the nuisances alone
  double enough = 0.005;   // relative fall of the cost below which an iteration was the last of its round
  double settled = 0.05;   // relative fall of the cost below which a round was the last
};

// A point in the space of hypotheses.
struct Point {
  std::vector<double> nuisance;                 // in standard deviations
  std::vector<common::EffectInstance> effects;  // parameter values in SI
};

// The nominal machine moved to a point.
sim::MachineSettings machine_at(const sim::MachineSettings& nominal, const Point& point);

// Everything that stays the same over one diagnosis. Counts simulations; may be asked to stop.
struct Problem {
  sim::MachineSettings nominal;
  std::vector<Record> records;
  std::vector<Whitening> whitening;  // per record
  FitSettings settings;
  int threads = 1;
  std::atomic<std::int64_t> simulations{0};
  const std::atomic<bool>* stop = nullptr;  // set from outside: unwind with Interrupted
};

struct Interrupted {};

// The whitened differences of all records, one below the other.
Eigen::VectorXd differences(Problem& problem, const Point& point);

// The same for many points, on `threads` threads.
std::vector<Eigen::VectorXd> differences(Problem& problem, std::span<const Point> points);

// Where the hypotheses are compared: the point with nuisances alone fitted, and the columns there.
struct Base {
  Point point;
  Eigen::VectorXd difference;
  Eigen::MatrixXd nuisance_columns;  // d difference / d z
  double cost = 0.0;
  double nominal_mean_square = 0.0;  // of the differences before anything is fitted
};
Base fit_nuisances(Problem& problem);

struct FitResult {
  Point point;
  Eigen::VectorXd difference;
  double cost = 0.0;
  double mean_square = 0.0;          // of the differences
  std::vector<double> deviation;     // of each effect parameter in order, in its own unit; from the curvature
};

// Fits the effects of `start` and the nuisances, from there. The first round uses the base's nuisance columns,
// further ones take them anew.
FitResult fit(Problem& problem, const Base& base, const Point& start, int rounds);

// Coordinates of effect parameters in standard deviations of their priors.
double to_coordinate(const common::EffectParameter& parameter, double value);
double from_coordinate(const common::EffectParameter& parameter, double coordinate);

const common::EffectAbout& about_effect(const std::string& name);

}  // namespace slewlab::diagnosis
