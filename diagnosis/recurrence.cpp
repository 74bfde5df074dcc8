#include "diagnosis/recurrence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/machine/scales.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kMoves = 0.05;        // of the largest speed, from which on the direction is sure
constexpr std::size_t kPoints = 1500;  // of a record that has so many, and fewer than twice as many
constexpr double kFineness = 4.0;      // orders tried in what the angle that is passed tells apart
constexpr int kRefinements = 4;        // thirds of a step: to the hundredth part of one
constexpr double kShortest = 10.0;     // points over which the axis passes a length at its largest speed, at least

struct Place {
  double angle, direction, torque;  // [rad], [-], [Nm per motor] against the motion
};

struct Places {
  std::vector<Place> all;
  double farthest_step = 0.0;  // [rad] that the axis passes between two of them
};

double mean_of_groups(const Record& record, const std::array<std::vector<double>, sim::kMaximumGroupCount>& series, std::size_t n) {
  double sum = 0.0;
  for (int g = 0; g < record.group_count; ++g) sum += series[static_cast<std::size_t>(g)][n];
  return sum / record.group_count;
}

Places places_of(const Problem& problem, const Point& point) {
  const double ratio = sim::scales_of(problem.nominal.crane).ratio;
  double fastest = 0.0;
  for (const Record& record : problem.records) {
    for (std::size_t n = 0; n < record.size(); ++n) fastest = std::max(fastest, std::fabs(mean_of_groups(record, record.shaft_speed, n)));
  }
  Places places;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Record& record = problem.records[r];
    const Shadow follower = shadow_at(problem, point, r);
    const std::size_t stride = std::max<std::size_t>(1, record.size() / kPoints);
    places.farthest_step = std::max(places.farthest_step, fastest / ratio * record.step * static_cast<double>(stride));
    for (std::size_t n = 0; n < record.size(); n += stride) {
      const double speed = mean_of_groups(record, record.shaft_speed, n);
      if (!(problem.whitening[r].window[n] > 0.0) || std::fabs(speed) <= kMoves * fastest) continue;
      const double direction = speed > 0.0 ? 1.0 : -1.0;
      places.all.push_back({mean_of_groups(record, record.shaft_position, n) / ratio, direction, direction * mean_of_groups(record, follower.missing_torque, n)});
    }
  }
  return places;
}

// What the functions of both directions take away of the sum of squares.
double taken_at(const std::vector<Place>& places, double order) {
  double taken = 0.0;
  for (const double direction : {1.0, -1.0}) {
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::Vector3d with_torque = Eigen::Vector3d::Zero();
    for (const Place& place : places) {
      if (place.direction != direction) continue;
      const double turn = 2.0 * std::numbers::pi * order * place.angle;
      const Eigen::Vector3d functions(1.0, std::cos(turn), std::sin(turn));
      products += functions * functions.transpose();
      with_torque += place.torque * functions;
    }
    if (products(0, 0) > 0.0) taken += with_torque.dot(products.ldlt().solve(with_torque));
  }
  return taken;
}

// The order beside `order`, nearer than `step`, at which most is taken away: by thirds of the remaining distance.
double refined(const std::vector<Place>& places, double order, double step) {
  for (int round = 0; round < kRefinements; ++round) {
    step /= 3.0;
    const double before = taken_at(places, order - step), here = taken_at(places, order), behind = taken_at(places, order + step);
    if (before > here && before >= behind) order -= step;
    if (behind > here && behind > before) order += step;
  }
  return order;
}

}  // namespace

std::vector<double> recurring_lengths(const Problem& problem, const Point& point, std::size_t most) {
  const Places places = places_of(problem, point);
  if (places.all.empty()) return {};
  const auto [low, high] = std::minmax_element(places.all.begin(), places.all.end(), [](const Place& a, const Place& b) { return a.angle < b.angle; });
  const double travel = high->angle - low->angle;  // [rad]
  const double shortest = kShortest * places.farthest_step;
  if (!(travel > 2.0 * shortest)) return {};
  struct Tried {
    double order, taken;
  };
  std::vector<Tried> tried;
  const auto most_turns = static_cast<int>(kFineness * travel / shortest);
  for (int k = static_cast<int>(kFineness); k <= most_turns; ++k) {
    const double order = k / (kFineness * travel);
    tried.push_back({order, taken_at(places.all, order)});
  }
  std::stable_sort(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) { return a.taken > b.taken; });
  std::vector<double> lengths;
  for (const Tried& one : tried) {
    if (lengths.size() == most) break;
    const bool is_apart = std::all_of(lengths.begin(), lengths.end(), [&](double length) { return std::fabs(one.order - 1.0 / length) * travel > 1.0; });
    if (is_apart) lengths.push_back(1.0 / refined(places.all, one.order, 1.0 / (kFineness * travel)));
  }
  return lengths;
}

}  // namespace slewlab::diagnosis
