// Which laws close the torque balance of an axis, decided by data that were not fitted.
//
//   F - (nominal load) = J q'' + sum over laws of size * law(q', q, t)
//
// Sizes by linear least squares; shapes (a Stribeck speed, a warming time, a lag) from a grid. Two kinds of validation judge: blocks of every
// record that were left out, each of several stretches spread over it, and whole records that were left out. Candidates are no law, each law
// alone, each pair, and what grows from them one law at a time while the mean fall of the squared residual over the left-out blocks is more
// than kSignificance of its standard errors and no left-out record gets worse by more than it gains elsewhere. A law whose size has a sign
// that its physics forbids (friction that pushes) is no candidate.
//
// Part of every fit, under priors of their own: the inertia about the file's, a skew between the channels of the recorder, and viscous
// friction's difference of the directions. So records in which an axis hardly changes its speed leave the inertia where the file has it. The
// answer's sizes are fitted beside those ordinary laws that are not named (`details`), where none is named too: every machine has a little of
// them, and what predicts must not do worse than least squares with all of them.
//
// Samples slower than the speed that the positions resolve are left out: what dry friction holds at rest is not determined.
//
// Probabilities: with x_b the logarithm of the ratio of what two models leave of block b, both above (kLawDiscrepancy of the gap's
// amplitude)^2, m its mean over n blocks and s its standard error, kRatioDeviation added,
//   ln odds = -(n / 2) ln(1 + (m / s)^2 / (n - 1)) sign(m),
// each law more at its prior. The answer is the model of the laws that are likelier there than not. So what counts is whether a law helps
// everywhere, not how often its help was sampled. "Unknown" is a smooth function of speed and position under the same validation.
//
// All sizes are in units of the axis; every threshold is a share of the record's own or the machine's scales.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/balance/balance_record.h"

namespace slewlab::diagnosis {

enum class LawFamily { friction, load, drive };

struct LawMoment {
  double time = 0.0, position = 0.0, speed = 0.0;
  double effort_rate = 0.0;  // per second
  const double* late = nullptr;  // BalanceMotion::late
  bool is_exact = false;         // the speed is no measured one: dry friction changes its side at 0 and holds there
};

// One law in one shape: size * value(moment), for each of its sizes.
struct LawShape {
  double shape = 0.0;  // 0 where the law has none
  std::vector<std::function<double(const LawMoment&)>> columns;
  double largest = std::numeric_limits<double>::infinity();  // that the first size can be
  bool is_leaning = false;                                   // the second size is half a difference of the directions: no more than the first;
                                                             // it has a prior of its own, so records need not tell it
};

struct BalanceLaw {
  std::string name;
  LawFamily family = LawFamily::friction;
  std::string words;                 // "dry friction"
  std::vector<LawShape> shapes;      // of which one is chosen
  bool is_dissipative = false;       // its first size cannot be negative
  std::string needs;                 // name of the law of which this is a detail; empty: stands alone
  bool is_ordinary = false;          // nearly every machine has it: tried before the others, which bend what these leave
};

// The laws that a torque balance knows. `resolved_speed`: below it the direction of motion is not known.
struct BalanceScales {
  double top_speed = 0.0;       // of the axis
  double resolved_speed = 0.0;
  double duration = 0.0;        // [s] of the longest record
  double middle_position = 0.0, half_range = 0.0;
  bool is_rotary = true;
  std::vector<double> late_times;  // [s] of lags that are tried
};
std::vector<BalanceLaw> balance_laws(const BalanceScales& scales);
// Names of all of them, whatever the axis.
std::vector<std::string> balance_law_names();

// Amplitude by which laws of real machines are known no better, as a share of what they are about; chosen.
inline constexpr double kLawDiscrepancy = 0.02;

// What the records of one diagnosis share: one window, the speed from which friction is judged, the laws in its units.
struct Balance {
  std::size_t half_window = 0;
  double resolved_speed = 0.0;
  std::vector<double> late_times;
  std::vector<BalanceLaw> laws;
};
// `inertia` and `top_speed` are the nominal axis's. Throws std::invalid_argument where a record is too short.
Balance balance_of(const std::vector<AxisRecord>& records, double inertia, double top_speed, bool is_rotary);
std::vector<BalanceRecord> smoothed(const std::vector<AxisRecord>& records, const Balance& balance);

struct BalanceTerm {
  std::string law, words;
  LawFamily family = LawFamily::friction;
  double shape = 0.0;
  bool is_dissipative = false;  // its first size cannot be negative
  std::vector<double> size, deviation;
  double share = 0.0;  // of the gap, that is lost on validation data without this term
  double probability = 0.0;  // of its law, alone or beside any others
};

struct BalanceModel {
  double inertia = 0.0, inertia_deviation = 0.0;
  double skew = 0.0;                // [s] by which the torque is recorded ahead of the motion; a recorder's channels are never quite at one time
  std::vector<BalanceTerm> terms;   // what is named
  std::vector<BalanceTerm> details; // ordinary laws that are not sure to be there, and with which left-out data are predicted better
  double validation = 0.0;          // mean square of the residual on blocks and records that were left out
  double probability = 0.0;
  std::string words() const;        // "dry friction and viscous friction"
  std::vector<BalanceTerm> acting() const;  // terms and details
};

// What the residual follows, of what is left.
struct Remainder {
  std::string variable;  // "speed", "position", "time", "torque"; empty: none
  double share = 0.0;    // of the remaining mean square, on left-out blocks
};

struct LawProbability {
  std::string law, words;
  LawFamily family = LawFamily::friction;
  double probability = 0.0;  // that it is there, alone or beside any others
};

struct BalanceAnswer {
  double nominal = 0.0;              // mean square of the residual with the nominal inertia
  double parameters = 0.0;           // validation with the inertia alone
  BalanceModel best;
  std::vector<BalanceModel> models;  // falling probability; the first is best, its sizes as they are stated
  double probability_unknown = 0.0;
  double explained = 0.0;            // share of the gap that the best model explains on left-out data
  Remainder remainder;
  double independent_count = 0.0;    // N
  double judged_share = 0.0;         // of all samples
  std::vector<LawProbability> laws;  // of all that were tried
};

// That any law of a family is there: what may be sure where the members are not.
struct FamilyProbability {
  LawFamily family = LawFamily::friction;
  double probability = 0.0;
};
std::vector<FamilyProbability> family_probabilities(const BalanceAnswer& answer);
std::string words_of(LawFamily family);
// Falling, the answer's own laws as its terms say.
std::vector<LawProbability> law_probabilities(const BalanceAnswer& answer);

// Throws std::invalid_argument where the records do not move enough for a balance.
BalanceAnswer fit_balance(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia,
                          double resolved_speed);

// Sizes of the same laws: beside their details, with which the axis is predicted; and as they are stated, without details, known no better than these
// move them.
struct FittedSizes {
  BalanceModel best, stated;
  bool is_physical = true;  // no size has a sign that its law cannot have, and the records determine all of them
};
// The same laws in the same shapes, their sizes fitted to other records.
FittedSizes refitted(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                      double nominal_inertia, double resolved_speed);

// The shape that a term has among the laws. Throws std::invalid_argument where they have none.
const LawShape& shape_of(const std::vector<BalanceLaw>& laws, const BalanceTerm& term);

// Residual of a model on a record that was not fitted: effort minus the model's, where the axis moves fast enough.
std::vector<double> balance_residual(const BalanceRecord& record, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                                     double resolved_speed);

}  // namespace slewlab::diagnosis
