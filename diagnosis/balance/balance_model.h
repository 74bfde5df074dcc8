// A model of an axis: its inertia and laws with their sizes, and its residual r on a record.
//
//   r = F - J q'' - tau dF/dt - sum over laws of size * law(q', q, t)                                 (1)
//
// tau: skew between the channels of the recorder [s]. All series of (1) have passed the balance's filter (balance_record.h).
// Units: those of the axis (balance_laws.h).
#pragma once

#include <string>
#include <vector>

#include "diagnosis/balance/balance_laws.h"

namespace slewlab::diagnosis {

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
  // The terms, each a law of its own: a constant torque beside a load over the position says where that rests, which is seldom the middle of the range.
  std::vector<BalanceTerm> named() const;
  std::string words() const;        // of these: "dry friction and viscous friction"
  std::vector<BalanceTerm> acting() const;  // terms and details
};

// What the residual follows.
struct Remainder {
  std::string variable;  // "speed", "position", "time", "torque" and what else balance_unknown.cpp tries; empty: none
  std::string words;     // "follows the speed"
  double share = 0.0;    // of the residual's mean square, on left-out blocks
};

// The shape that a term has among the laws. Throws std::invalid_argument where they have none.
const LawShape& shape_of(const std::vector<BalanceLaw>& laws, const BalanceTerm& term);

// Equation (1) on a record that was not fitted, at its samples faster than `resolved_speed`. Throws std::invalid_argument where `laws` lack one of
// the model's.
std::vector<double> balance_residual(const BalanceRecord& record, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                                     double resolved_speed);

// RMS of that part of (1) that goes together over more than the filter does, samples that do not move being 0:
//
//   sqrt(max(0, max over lags of |rho| - 2 s)) rms(r),   s^2 = (1 + 2 sum of rho_j^2) / n              (2)
//
// lags from one to two lengths of the filter; rho_j below them. White noise has none of it, and s is by how much chance makes it seem so
// (Bartlett 1946, Supplement to the Journal of the Royal Statistical Society 8, p. 27).
double correlated_rms(const BalanceRecord& record, const std::vector<BalanceLaw>& laws, const BalanceModel& model, double resolved_speed);

}  // namespace slewlab::diagnosis
