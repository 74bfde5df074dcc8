// The residual of a hypothesis, as a torque that is a smooth function of one variable v and of the direction of motion:
//
//   T(t) = sum over i of s_i(t) f_i(v(t)),    f_i(v) = sum over j of a_ij B_j(v),    a ~ N(0, rho P^-1)
//
// v is the speed or the angle of the axis, the time since a record's beginning, the magnitude of the motors' torque, mean over the groups, or the rate of each motor's torque over an
// eighth of the characteristic time: a drive that answers otherwise the one way than the other, or to a quick change than to a slow one. The s_i
// are one of several sets, that with the largest evidence: the two directions of motion; of angle and time none (s = 1); of speed, time and torque
// each motor's torque over the largest; of the torque also none, v being each motor's own; of the rate none, the sign of the motor's torque with v the rate of its magnitude, or the speed. B_j are cubic B-splines on even knots, eight segments or
// one (a cubic, which a law of few numbers needs no more than); of the angle also as many as the axis passes at its largest speed in a quarter of the
// characteristic time each (64 at most: what is set in a ring comes many times in a turn); of the speed also the constant. The torque acts at the
// motors; what follows the angle also on the house, where it winds no gear up, and cubics of speed and time there too. P = D'D + 0.1 with D the second differences (Eilers, Marx 1996: P-splines).
// Parameters, what the hypothesis has, a constant torque, and whatever holds the machine at standstill are projected out, so that the function stands
// for none of them. rho is that of the largest evidence,
//
//   ln E(rho) = -1/2 sum ln(1 + rho lambda) - nu / 2 h(Q(rho) / nu),    h(q) = ln q where q > 1, else q - 1,
//
// lambda the eigenvalues of the columns' products in P's coordinates, nu the independent differences, Q the sum of squares of the residual beside
// them together with a' P a / rho: a noise of unknown size, but not below the sensors'. Only differences that are slower than the machine's
// characteristic time T count: faster ones show how laws begin and end, and the modes of the structure. Where the functions take away a smaller share
// of the whole residual than the usual misfit of a law (r in evidence.h), nothing is said: that share may come from the faster differences.
// Assumption: the torque is small beside what moves the machine, so that its traces add up.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

// f_i over the values that the records have of v.
struct DiscrepancyCurve {
  std::string part;               // forward, backward, with the torque; where it acts on the house; of the time with the record's number
  std::vector<double> at;         // in the variable's unit
  std::vector<double> torque;     // [Nm per motor] that the machine has and the model has not
  std::vector<double> deviation;  // [Nm per motor] one standard deviation
};

struct Discrepancy {
  std::string variable;  // constant, speed, angle, time, torque, torque's rate
  std::string unit;
  double share = 0.0;     // of the residual above the noise, that the function with its constant takes away
  double evidence = 0.0;  // ln E(rho) - ln E(0), the constant's with it
  std::vector<DiscrepancyCurve> curves;  // none of the constant
};

// Below this share nothing is said to be followed: it is not the most of it.
inline constexpr double kFollowed = 0.5;
// A variable whose evidence is within so much of the first one's cannot be told from it, nor one from none: odds of one to ten, tempered as those of causes are (evidence.h).
inline constexpr double kFollowsAsWell = 6.9;

// One of the sets that the s_i f_i of a variable may be.
struct SmoothFunction {
  std::string variable;
  std::vector<std::size_t> blocks;  // SmoothTorques'
};

// What such torques do to the differences, simulated at one fit's machine: two to three hundred simulations.
class SmoothTorques {
 public:
  SmoothTorques(Problem& problem, const FitResult& fit);  // throws Interrupted
  ~SmoothTorques();
  // Of that fit's residual, or of another one's of the same problem whose machine moves alike; largest evidence first; empty where they take next to nothing away.
  // `law_share`: EvidenceSettings'.
  std::vector<Discrepancy> of_residual(const Problem& problem, const FitResult& fit, double law_share) const;
  std::vector<SmoothFunction> functions_of(const std::string& variable) const;
  // What a function does to all differences, by its coefficients in standard deviations of their prior for rho = 1; and with some coefficients the torques themselves, of each record.
  Eigen::MatrixXd columns(const Problem& problem, const SmoothFunction& function) const;
  std::vector<MoreTorques> torques(const Problem& problem, const SmoothFunction& function, const Eigen::VectorXd& coefficients) const;
  // The values that rho may have, evenly in ln rho: squares of a hundredth of the rated torque, so that the function is from a ten-thousandth of that torque to all of it.
  static std::vector<double> scales();

 private:
  struct Traced;
  std::unique_ptr<const Traced> traced_;
};

// Whether the fit's slow differences are more than noise.
bool has_slow_gap(const Problem& problem, const FitResult& fit);

// The discrepancies that are told of a fit's residual: as of_residual(), empty also where the fit has no slow gap.
std::vector<Discrepancy> discrepancies(const Problem& problem, const FitResult& fit, const SmoothTorques& smooth, double law_share);

// The names of those that the residual follows, the first one and what cannot be told from it; the constant alone where that is among them; empty: none.
std::vector<std::string> followed_variables(const std::vector<Discrepancy>& discrepancies);

}  // namespace slewlab::diagnosis
