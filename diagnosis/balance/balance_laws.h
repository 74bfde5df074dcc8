// The laws that a torque balance knows: functions of an axis's motion whose sizes are fitted.
//
//   F - (nominal load) = J q'' + sum over laws of size * law(q', q, t)                                (1)
//
// Dry friction sign(q'), viscous friction q' with half a difference of the directions |q'|, a constant; friction with a breakaway value
// (Stribeck) sign(q') exp(-(q' / v)^2), rising friction sign(q') (1 - exp(-|q'| / v)); drag q' |q'|; friction and load over the position;
// gravity sin q, cos q; friction that falls as exp(-t / T); what a first-order lag, or a delay, withholds of the effort. Shapes (v, T, the lateness) stand
// on grids of shares of the axis's top speed, of the records' duration and of the motion's time.
//
// Records of one direction tell no difference of directions, and a constant against the motion is dry friction there: one law of two names. A constant
// beside it is one that helps the motion, and then no friction.
//
// Units: those of the axis; [rad, Nm, kg m^2] of a rotary, [m, N, kg] of a linear one. Assumption: one inertia.
// Source: Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30, p. 1083.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "diagnosis/balance/balance_record.h"

namespace slewlab::diagnosis {

// Amplitude by which laws of real machines are known no better, as a share of what they are about; chosen.
inline constexpr double kLawDiscrepancy = 0.02;

enum class LawFamily { friction, load, drive };
std::string words_of(LawFamily family);  // "a load"

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
  int late = -1;                                             // its column is what this lateness withholds (BalanceScales::lateness); -1: none
  double least = -std::numeric_limits<double>::infinity();   // that the first size can be, of a law that is not dissipative
};

struct BalanceLaw {
  std::string name;
  LawFamily family = LawFamily::friction;
  std::string words;                 // "dry friction"
  std::vector<LawShape> shapes;      // of which one is chosen
  bool is_dissipative = false;       // its first size cannot be negative
  std::string needs;                 // name of the law of which this is a detail; empty: stands alone
  bool is_ordinary = false;          // nearly every machine has it: tried before the others, which bend the residual of these
  std::string instead_of = {};       // name of the law that is the same motion in these records: no answer has both; empty: none is
};

// What the laws are scaled by. `resolved_speed`: below it the direction of motion is not known.
struct BalanceScales {
  double top_speed = 0.0;       // of the axis
  double resolved_speed = 0.0;
  double duration = 0.0;        // [s] of the longest record
  double middle_position = 0.0, half_range = 0.0;
  bool is_rotary = true;
  int direction = 0;            // 1, -1: all records move this way alone; 0: both ways
  std::vector<Lateness> lateness = {};  // that is tried
};
std::vector<BalanceLaw> balance_laws(const BalanceScales& scales);
// Names of all of them, whatever the axis.
std::vector<std::string> balance_law_names();

// A law along the record's motion under the balance's filter: one value for each of its samples.
std::vector<double> law_column(const BalanceRecord& record, const std::function<double(const LawMoment&)>& value);

}  // namespace slewlab::diagnosis
