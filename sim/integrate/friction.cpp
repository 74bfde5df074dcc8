#include "sim/integrate/friction.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slewlab::sim {
namespace {

constexpr double kRounding = 1e-12;  // [-] of the bounds and of the free speeds, by which nobody disobeys

// Of each friction: at its lowest, between, at its highest.
enum class Status { lowest, sticking, highest };

// Gives the sticking bodies the frictions that hold them, all others their bounds. False where the system is singular.
bool take_frictions(const FrictionProblem& problem, const Status* status, double* friction) {
  int rows[kMaximumFrictions];
  int count = 0;
  for (int i = 0; i < problem.count; ++i) {
    if (status[i] == Status::sticking) {
      rows[count++] = i;
    } else {
      friction[i] = status[i] == Status::lowest ? problem.lowest[i] : problem.highest[i];
    }
  }
  double system[kMaximumFrictions][kMaximumFrictions + 1];
  for (int r = 0; r < count; ++r) {
    double right = -problem.free_speed[rows[r]];
    for (int j = 0; j < problem.count; ++j) {
      if (status[j] != Status::sticking) right -= problem.mobility[rows[r]][j] * friction[j];
    }
    for (int c = 0; c < count; ++c) system[r][c] = problem.mobility[rows[r]][rows[c]];
    system[r][count] = right;
  }
  // Gauss with row pivots.
  for (int k = 0; k < count; ++k) {
    int best = k;
    for (int r = k + 1; r < count; ++r) {
      if (std::fabs(system[r][k]) > std::fabs(system[best][k])) best = r;
    }
    if (!(std::fabs(system[best][k]) > 0.0)) return false;
    if (best != k) std::swap(system[best], system[k]);
    for (int r = k + 1; r < count; ++r) {
      const double share = system[r][k] / system[k][k];
      for (int c = k; c <= count; ++c) system[r][c] -= share * system[k][c];
    }
  }
  for (int k = count - 1; k >= 0; --k) {
    double value = system[k][count];
    for (int c = k + 1; c < count; ++c) value -= system[k][c] * friction[rows[c]];
    friction[rows[k]] = value / system[k][k];
  }
  return true;
}

}  // namespace

FrictionEnd solve_frictions(const FrictionProblem& problem, double* friction) {
  Status status[kMaximumFrictions];
  double speed_rounding = 0.0;
  for (int i = 0; i < problem.count; ++i) {
    status[i] = friction[i] <= problem.lowest[i]    ? Status::lowest
                : friction[i] >= problem.highest[i] ? Status::highest
                                                    : Status::sticking;
    speed_rounding = std::max(speed_rounding, kRounding * std::fabs(problem.free_speed[i]));
  }
  FrictionEnd end = FrictionEnd::too_many_pivots;
  for (int pivot = 0; pivot < kMostFrictionPivots; ++pivot) {
    if (!take_frictions(problem, status, friction)) {
      end = FrictionEnd::singular;
      break;
    }
    int first = 0;
    for (; first < problem.count; ++first) {
      const double range = problem.highest[first] - problem.lowest[first];
      if (range <= 0.0) continue;
      if (status[first] == Status::sticking) {
        if (friction[first] < problem.lowest[first] - kRounding * range) {
          status[first] = Status::lowest;
          break;
        }
        if (friction[first] > problem.highest[first] + kRounding * range) {
          status[first] = Status::highest;
          break;
        }
        continue;
      }
      double speed = problem.free_speed[first];
      for (int j = 0; j < problem.count; ++j) speed += problem.mobility[first][j] * friction[j];
      if (status[first] == Status::lowest ? speed < -speed_rounding : speed > speed_rounding) {
        status[first] = Status::sticking;
        break;
      }
    }
    if (first == problem.count) {
      end = FrictionEnd::solved;
      break;
    }
  }
  for (int i = 0; i < problem.count; ++i) friction[i] = std::clamp(friction[i], problem.lowest[i], problem.highest[i]);
  return end;
}

}  // namespace slewlab::sim
