#include "diagnosis/discrepancy.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "diagnosis/screen.h"
#include "sim/machine/scales.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kSegments = 8;                 // between knots
constexpr int kMostSegments = 64;            // of a function of the angle that is fine: what is set in the ring, in teeth and rollers, comes many times in a turn
constexpr double kFineness = 4.0;            // of those, passed in a characteristic time at the largest speed
constexpr double kLevelPrice = 0.1;          // of a coefficient beside its second differences
constexpr double kAmount = 0.01;             // of the rated torque: so little that no tooth parts
constexpr double kStandstill = 0.02;         // of the largest speed, in which the direction turns
constexpr double kRateTime = 0.125;          // [characteristic times] over which a torque's rate is taken: what lags by less is seen as a rate, and the sensors' noise moves the mean little
constexpr double kSmallTorque = 0.05;        // of the largest, within which a torque turns its sign
constexpr int kPointsInSegment = 5;          // of a curve
constexpr double kHighestFrequency = 1.0;    // [1 / characteristic time] that a smooth function of slow quantities is asked to explain
constexpr double kHeld = 1.0;  // [characteristic times] between the knots of what holds at standstill
constexpr std::size_t kSideBySide = 8;  // torques of one thread that are simulated at once

// B_j of v, on `segments` from `low` to `high`; 1 where there are none.
double spline(int j, double v, double low, double high, int segments) {
  if (segments == 0) return 1.0;
  const double u = std::fabs((v - low) / (high - low) * segments - static_cast<double>(j - 1));
  if (u >= 2.0) return 0.0;
  if (u >= 1.0) return (2.0 - u) * (2.0 - u) * (2.0 - u) / 6.0;
  return (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0;
}

// What a record's grid points have of each quantity.
struct Course {
  std::vector<double> speed, angle, time, direction;
  std::vector<double> load;                       // [Nm per motor] mean of the magnitudes
  std::vector<std::vector<double>> motor_torque;  // [Nm] each group's own
  std::vector<std::vector<double>> torque_rate;   // [Nm/s] of it
};
using OfCourse = std::function<double(const Course&, std::size_t point, std::size_t group)>;

// One s_i(t), with the segments of its f_i, which is a constant where there are none.
struct Part {
  const char* name;
  OfCourse factor;
  int segments = kSegments;
  OfCourse value{};  // where it is another one than the quantity's
  bool is_on_house = false;
  int splines() const { return segments > 0 ? segments + 3 : 1; }
};

struct Quantity {
  const char* name;
  const char* unit;
  OfCourse value;
  bool is_of_each_record;
  std::vector<Part> parts;
  // Which parts a law may have: the more, the more it costs, so each is weighed by itself and the best stands for the quantity.
  std::vector<std::vector<std::size_t>> alternatives;
  const OfCourse& value_of(const Part& part) const { return part.value ? part.value : value; }
};

double largest(const std::vector<std::vector<double>>& series) {
  double most = 0.0;
  for (const std::vector<double>& one : series) {
    for (const double value : one) most = std::max(most, std::fabs(value));
  }
  return most;
}

// Of a series, its change over so many of its points until each.
std::vector<double> rate_of(const std::vector<double>& series, std::size_t points, double step) {
  std::vector<double> rate(series.size());
  for (std::size_t n = 0; n < series.size(); ++n) rate[n] = (series[n] - series[n - std::min(n, points)]) / (step * static_cast<double>(points));
  return rate;
}

std::vector<Course> courses_of(const Problem& problem, double ratio) {
  std::vector<Course> courses;
  for (const Record& record : problem.records) {
    Course course;
    const auto groups = static_cast<std::size_t>(record.group_count);
    for (std::size_t n = 0; n < record.size(); ++n) {
      double speed = 0.0, angle = 0.0, load = 0.0;
      for (std::size_t g = 0; g < groups; ++g) {
        speed += record.position_rate[g].empty() ? record.shaft_speed[g][n] : record.position_rate[g][n];
        angle += record.shaft_position[g][n];
        load += std::fabs(record.motor_torque[g][n]);
      }
      const double shafts = ratio * static_cast<double>(groups);
      course.speed.push_back(speed / shafts);
      course.angle.push_back(angle / shafts);
      course.time.push_back(record.step * static_cast<double>(n));
      course.load.push_back(load / static_cast<double>(groups));
    }
    course.motor_torque.assign(record.motor_torque.begin(), record.motor_torque.begin() + static_cast<std::ptrdiff_t>(groups));
    const auto points = static_cast<std::size_t>(std::max(1.0, std::round(kRateTime * problem.thresholds.time / record.step)));
    for (const std::vector<double>& torque : course.motor_torque) course.torque_rate.push_back(rate_of(torque, points, record.step));
    courses.push_back(std::move(course));
  }
  std::vector<std::vector<double>> speeds;
  for (const Course& course : courses) speeds.push_back(course.speed);
  const double slow = std::max(kStandstill * largest(speeds), std::numeric_limits<double>::min());
  for (Course& course : courses) {
    for (const double speed : course.speed) course.direction.push_back(std::tanh(speed / slow));
  }
  return courses;
}

// As many as pass in a characteristic time at the largest speed, kFineness times.
int fine_segments(const std::vector<Course>& courses, double characteristic_time) {
  double low = std::numeric_limits<double>::infinity(), high = -low, fastest = std::numeric_limits<double>::min();
  for (const Course& course : courses) {
    for (const double angle : course.angle) low = std::min(low, angle), high = std::max(high, angle);
    for (const double speed : course.speed) fastest = std::max(fastest, std::fabs(speed));
  }
  return static_cast<int>(std::clamp(std::ceil(kFineness * (high - low) / (fastest * characteristic_time)), double{kSegments}, double{kMostSegments}));
}

std::vector<Quantity> quantities(double largest_torque, double largest_speed, int fine) {
  const auto of = [](std::vector<double> Course::* values) { return [values](const Course& c, std::size_t n, std::size_t) { return (c.*values)[n]; }; };
  const auto own_torque = [](const Course& c, std::size_t n, std::size_t g) { return c.motor_torque[g][n]; };
  const auto own_rate = [](const Course& c, std::size_t n, std::size_t g) { return c.torque_rate[g][n]; };
  const auto sign = [=](const Course& c, std::size_t n, std::size_t g) { return std::tanh(own_torque(c, n, g) / (kSmallTorque * largest_torque)); };
  const Part forward{"forward", [](const Course& c, std::size_t n, std::size_t) { return std::max(0.0, c.direction[n]); }};
  const Part backward{"backward", [](const Course& c, std::size_t n, std::size_t) { return std::max(0.0, -c.direction[n]); }};
  const Part along{"forward, constant", forward.factor, 0}, against{"backward, constant", backward.factor, 0};
  const Part both{"both ways", [](const Course&, std::size_t, std::size_t) { return 1.0; }};
  const Part with_torque{"with each motor's torque", [=](const Course& c, std::size_t n, std::size_t g) { return own_torque(c, n, g) / largest_torque; }};
  const Part own{"each motor's own", both.factor, kSegments, own_torque};
  const Part rising{"each motor's own", both.factor, kSegments, own_rate};
  const Part growing{"of each motor's magnitude", sign, kSegments, [=](const Course& c, std::size_t n, std::size_t g) { return sign(c, n, g) * own_rate(c, n, g); }};
  const Part with_speed{"with the speed", [=](const Course& c, std::size_t n, std::size_t) { return std::fabs(c.speed[n]) / largest_speed; }, kSegments, own_rate};
  const auto of_segments = [](Part part, int segments) { return part.segments = segments, part; };
  const auto on_house = [](Part part) { return part.is_on_house = true, part; };
  const auto cubic = [&](const Part& part) { return of_segments(part, 1); };
  return {{"speed", "rad/s", of(&Course::speed), false, {forward, backward, with_torque, along, against, on_house(cubic(forward)), on_house(cubic(backward))}, {{0, 1}, {2}, {3, 4}, {5, 6}}},
          {"angle", "rad", of(&Course::angle), false, {on_house(forward), on_house(backward), on_house(both), on_house(of_segments(both, fine)), on_house(cubic(both)), on_house(cubic(forward)), on_house(cubic(backward)), both, cubic(both)},
           {{0, 1}, {2}, {3}, {4}, {5, 6}, {7}, {8}}},
          {"time", "s", of(&Course::time), true, {forward, backward, with_torque, both, on_house(cubic(both))}, {{0, 1, 2}, {0, 1}, {2}, {3}, {4}}},
          {"torque", "Nm", of(&Course::load), false, {forward, backward, own, with_torque, cubic(own)}, {{0, 1}, {2}, {3}, {4}}},
          {"torque's rate", "Nm/s", own_rate, false, {rising, growing, with_speed, cubic(rising)}, {{0}, {1}, {2}, {3}}}};
}

// The least and the greatest value of a quantity where `factor` acts and the records are judged.
std::pair<double, double> range_of(const Problem& problem, const std::vector<Course>& courses, const Quantity& quantity, const Part& part) {
  constexpr double kActs = 0.1;  // of a factor's largest
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const OfCourse& value = quantity.value_of(part);
  for (std::size_t r = 0; r < courses.size(); ++r) {
    for (std::size_t n = 0; n < courses[r].time.size(); ++n) {
      if (!(problem.whitening[r].window[n] > 0.0)) continue;
      for (std::size_t g = 0; g < courses[r].motor_torque.size(); ++g) {
        if (std::fabs(part.factor(courses[r], n, g)) < kActs) continue;
        low = std::min(low, value(courses[r], n, g));
        high = std::max(high, value(courses[r], n, g));
      }
    }
  }
  return {low, high};
}

// A torque [amounts] as a function of record, grid point and group, and where it acts.
struct TorqueShape {
  std::function<double(std::size_t record, std::size_t point, std::size_t group)> torque;
  bool is_on_house = false;
};

// What such a torque is where the drives are enabled: their shares, per record and grid point.
using Enabled = std::vector<std::vector<double>>;
Enabled enabled_shares(Problem& problem) {
  Enabled enabled(problem.records.size());
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const DriveCourse& course = problem.stock.drives(problem.records[r], r, problem.nominal.drive_protection);
    for (std::size_t n = 0; n < problem.records[r].size(); ++n) enabled[r].push_back(enabled_share(course, n));
  }
  return enabled;
}

std::vector<MoreTorques> torques_of(const Problem& problem, const Enabled& enabled, double amount, const TorqueShape& shape) {
  std::vector<MoreTorques> torques(problem.records.size());
  for (std::size_t r = 0; r < torques.size(); ++r) {
    torques[r].is_on_house = shape.is_on_house;
    for (std::size_t g = 0; g < static_cast<std::size_t>(problem.records[r].group_count); ++g) {
      std::vector<double>& torque = torques[r].of_group[g];
      torque.resize(problem.records[r].size());
      for (std::size_t n = 0; n < torque.size(); ++n) torque[n] = enabled[r][n] == 0.0 ? 0.0 : enabled[r][n] * amount * shape.torque(r, n, g);
    }
  }
  return torques;
}

// The change of the differences by each of some torques.
std::vector<Eigen::VectorXd> traces(Problem& problem, const Point& point, const Eigen::VectorXd& difference, double amount, const Enabled& enabled, const std::vector<TorqueShape>& shapes) {
  // Those of an hour at 1 kHz are gigabytes: so many at a time as are simulated side by side.
  const std::size_t together = kSideBySide * static_cast<std::size_t>(std::max(1, problem.threads));
  const ColumnBase base = column_base(problem, point, difference);
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t first = 0; first < shapes.size(); first += together) {
    std::vector<std::vector<MoreTorques>> torques(std::min(together, shapes.size() - first));
    share_out(problem, torques.size(), [&](std::size_t i) { torques[i] = torques_of(problem, enabled, amount, shapes[first + i]); });
    for (Eigen::VectorXd& changed : changes(problem, base, std::vector<Point>(torques.size(), point), torques)) columns.push_back(std::move(changed));
  }
  return columns;
}

// The rows of slow changes: up to `highest` [Hz] of every channel.
std::vector<Eigen::Index> slow_rows(const Problem& problem, double highest) {
  std::vector<Eigen::Index> rows;
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    for (std::size_t channel = 0; channel < whitening.channels.size(); ++channel) {
      for (std::size_t b = 0; b < whitening.bin_count; ++b, row += 2) {
        if (static_cast<double>(whitening.first_bin + b) * whitening.bin_width > highest) continue;
        rows.push_back(row);
        rows.push_back(row + 1);
      }
    }
    row += whitening.flanks_size();
  }
  return rows;
}

// What of a trace lies in one record's rows.
Eigen::VectorXd of_record(const Eigen::VectorXd& trace, const std::vector<Eigen::Index>& rows, std::size_t record) {
  Eigen::VectorXd own = Eigen::VectorXd::Zero(trace.size());
  own.segment(rows[record], rows[record + 1] - rows[record]) = trace.segment(rows[record], rows[record + 1] - rows[record]);
  return own;
}

// The space of some vectors, to be left out of others.
class Orthonormal {
 public:
  explicit Orthonormal(const std::vector<Eigen::VectorXd>& vectors) {
    for (const Eigen::VectorXd& vector : vectors) {
      constexpr double kIndependent = 1e-6;  // of a vector's length
      Eigen::VectorXd own = without(without(vector));
      const double length = own.norm();
      if (length > kIndependent * vector.norm()) axes_.push_back(own / length);
    }
  }
  Eigen::VectorXd without(Eigen::VectorXd vector) const {
    for (const Eigen::VectorXd& axis : axes_) vector -= axis * axis.dot(vector);
    return vector;
  }

 private:
  std::vector<Eigen::VectorXd> axes_;
};

// One part of a function, of one record or of all, ready to be weighed.
struct Block {
  std::size_t part, record;  // of all records: 0
  double low, high;
  int splines;
  std::size_t first_shape;
  Eigen::MatrixXd columns;   // traces, with parameters, hypothesis and a constant torque projected out
};

struct Weighed {
  double evidence = 0.0;
  double left = 0.0;               // sum of squares of the residual
  Eigen::VectorXd mean;            // [amounts]
  Eigen::MatrixXd covariance;      // [amounts^2]
};

double penalty(double mean_square) { return mean_square > 1.0 ? std::log(mean_square) : mean_square - 1.0; }

// P of one block.
Eigen::MatrixXd roughness(Eigen::Index splines) {
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(std::max(Eigen::Index{0}, splines - 2), splines);
  for (Eigen::Index i = 0; i < second.rows(); ++i) second.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
  return second.transpose() * second + kLevelPrice * Eigen::MatrixXd::Identity(splines, splines);
}

Weighed weigh(const std::vector<const Block*>& blocks, const Eigen::VectorXd& gap, double independent_share, double count) {
  Eigen::Index size = 0;
  for (const Block* block : blocks) size += block->splines;
  Eigen::MatrixXd columns(gap.size(), size), precision = Eigen::MatrixXd::Zero(size, size);
  Eigen::Index first = 0;
  for (const Block* block : blocks) {
    columns.middleCols(first, block->splines) = block->columns;
    precision.block(first, first, block->splines, block->splines) = roughness(block->splines);
    first += block->splines;
  }
  const Eigen::LLT<Eigen::MatrixXd> root(precision);  // P = L L'
  // In the coordinates L' a the prior is the unit ball.
  const Eigen::MatrixXd white = root.matrixL().solve(columns.transpose()).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(independent_share * white.transpose() * white);
  const Eigen::VectorXd lambda = eigen.eigenvalues().cwiseMax(0.0);
  const Eigen::VectorXd target = independent_share * (eigen.eigenvectors().transpose() * (white.transpose() * gap));
  const double all = independent_share * gap.squaredNorm(), nu = independent_share * count;
  Weighed best;
  best.left = gap.squaredNorm();
  best.mean = Eigen::VectorXd::Zero(size);
  best.covariance = Eigen::MatrixXd::Zero(size, size);
  const double none = -0.5 * nu * penalty(all / nu);
  for (const double rho : SmoothTorques::scales()) {
    const Eigen::ArrayXd shrunk = rho / (1.0 + rho * lambda.array());
    const double left = all - (shrunk * target.array().square()).sum();
    const double evidence = -0.5 * (1.0 + rho * lambda.array()).log().sum() - 0.5 * nu * penalty(left / nu) - none;
    if (evidence <= best.evidence) continue;
    best.evidence = evidence;
    const Eigen::MatrixXd back = root.matrixU().solve(eigen.eigenvectors());
    best.mean = back * (shrunk * target.array()).matrix();
    best.left = (gap - columns * best.mean).squaredNorm();
    best.covariance = std::max(1.0, left / nu) * back * shrunk.matrix().asDiagonal() * back.transpose();
  }
  return best;
}

std::vector<DiscrepancyCurve> curves_of(const Quantity& quantity, const std::vector<const Block*>& blocks, const Weighed& weighed, double amount, std::size_t records) {
  std::vector<DiscrepancyCurve> curves;
  Eigen::Index first = 0;
  for (const Block* block : blocks) {
    DiscrepancyCurve curve;
    curve.part = quantity.parts[block->part].name;
    if (quantity.parts[block->part].is_on_house) curve.part += ", on the house";
    if (quantity.is_of_each_record && records > 1) curve.part += ", record " + std::to_string(block->record + 1);
    const int segments = quantity.parts[block->part].segments;
    const int steps = kPointsInSegment * std::max(1, segments);
    for (int i = 0; i <= steps; ++i) {
      const double v = block->low + (block->high - block->low) * i / steps;
      Eigen::VectorXd values(block->splines);
      for (int j = 0; j < block->splines; ++j) values(j) = spline(j, v, block->low, block->high, segments);
      curve.at.push_back(v);
      curve.torque.push_back(amount * values.dot(weighed.mean.segment(first, block->splines)));
      const double variance = values.dot(weighed.covariance.block(first, first, block->splines, block->splines) * values);
      curve.deviation.push_back(amount * std::sqrt(std::max(0.0, variance)));
    }
    first += block->splines;
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace

struct SmoothTorques::Traced {
  std::vector<Eigen::Index> slow;
  double amount = 0.0;
  std::vector<Quantity> all;
  std::vector<std::vector<Block>> functions;  // of each quantity
  std::size_t common_shapes = 0;              // the constant, then what holds at standstill
  std::vector<Course> courses;
  Enabled enabled;
  std::vector<TorqueShape> shapes;
  std::vector<Eigen::VectorXd> traces;

  const Quantity& quantity(const std::string& name) const {
    return *std::find_if(all.begin(), all.end(), [&](const Quantity& one) { return one.name == name; });
  }
  // The blocks of which a function is made.
  std::vector<const Block*> blocks(const SmoothFunction& function) const {
    std::vector<const Block*> result;
    for (const std::size_t index : function.blocks) result.push_back(&of_variable(function.variable)[index]);
    return result;
  }
  const std::vector<Block>& of_variable(const std::string& name) const { return functions[static_cast<std::size_t>(&quantity(name) - all.data())]; }
};

SmoothTorques::~SmoothTorques() = default;

std::vector<double> SmoothTorques::scales() {
  constexpr double kLowest = -9.0, kHighest = 9.0;  // ln rho
  constexpr int kCount = 25;
  std::vector<double> scales;
  for (int k = 0; k < kCount; ++k) scales.push_back(std::exp(kLowest + (kHighest - kLowest) * k / (kCount - 1)));
  return scales;
}

SmoothTorques::SmoothTorques(Problem& problem, const FitResult& fit) {
  auto own = std::make_unique<Traced>();
  own->slow = slow_rows(problem, kHighestFrequency / problem.thresholds.time);
  const sim::Scales scales = sim::scales_of(problem.nominal.crane);
  own->courses = courses_of(problem, scales.ratio);
  const std::vector<Course>& courses = own->courses;
  double largest_torque = std::numeric_limits<double>::min(), largest_speed = largest_torque;
  for (const Course& course : courses) {
    largest_torque = std::max(largest_torque, largest(course.motor_torque));
    largest_speed = std::max(largest_speed, largest({course.speed}));
  }
  own->all = quantities(largest_torque, largest_speed, fine_segments(courses, problem.thresholds.time));
  own->amount = kAmount * scales.motor_torque;

  // One simulation moves a function of all records' times at once: each record's rows tell its own. First what is no discrepancy of any
  // variable: a constant, and whatever holds the machine at standstill, which no law of motion tells.
  std::vector<TorqueShape>& shapes = own->shapes;
  shapes.push_back({[](std::size_t, std::size_t, std::size_t) { return 1.0; }});
  const double knots = kHeld * problem.thresholds.time;
  const auto held = static_cast<std::size_t>(std::ceil(longest_record(problem) / knots)) + 1;
  for (std::size_t k = 0; k < held; ++k) {
    const auto hat = [&courses, knots, k](std::size_t r, std::size_t n, std::size_t) {
      const double at_rest = 1.0 - std::fabs(courses[r].direction[n]);
      return at_rest * std::max(0.0, 1.0 - std::fabs(courses[r].time[n] / knots - static_cast<double>(k)));
    };
    bool acts = false;
    for (std::size_t r = 0; r < courses.size() && !acts; ++r) {
      for (std::size_t n = 0; n < courses[r].time.size() && !acts; ++n) acts = hat(r, n, 0) > 0.5;
    }
    if (acts) shapes.push_back({hat});
  }
  own->common_shapes = shapes.size();
  own->functions.resize(own->all.size());
  for (std::size_t q = 0; q < own->all.size(); ++q) {
    const Quantity& quantity = own->all[q];
    for (std::size_t p = 0; p < quantity.parts.size(); ++p) {
      const auto [low, high] = range_of(problem, courses, quantity, quantity.parts[p]);
      if (!(high > low)) continue;
      const std::size_t copies = quantity.is_of_each_record ? courses.size() : 1;
      for (std::size_t r = 0; r < copies; ++r) own->functions[q].push_back({p, r, low, high, quantity.parts[p].splines(), shapes.size(), {}});
      for (int j = 0; j < quantity.parts[p].splines(); ++j) {
        const auto torque = [&courses, &quantity, &part = quantity.parts[p], j, low = low, high = high](std::size_t r, std::size_t n, std::size_t g) {
          return part.factor(courses[r], n, g) * spline(j, std::clamp(quantity.value_of(part)(courses[r], n, g), low, high), low, high, part.segments);
        };
        shapes.push_back({torque, quantity.parts[p].is_on_house});
      }
    }
  }
  own->enabled = enabled_shares(problem);
  own->traces = traces(problem, fit.point, fit.difference, own->amount, own->enabled, shapes);
  traced_ = std::move(own);
}

std::vector<Discrepancy> SmoothTorques::of_residual(const Problem& problem, const FitResult& fit, double law_share) const {
  const auto& [slow, amount, all, functions, common_shapes, courses, enabled, shapes, traced] = *traced_;
  const double count = static_cast<double>(slow.size());
  const Eigen::VectorXd slow_difference = fit.difference(slow);
  const Projector project(fit.columns(slow, Eigen::indexing::all), prior_rows(problem, fit.point), data_weight(slow_difference, problem.settings));

  const std::vector<Eigen::Index> rows = first_rows(problem);
  std::vector<Eigen::VectorXd> holding;
  for (std::size_t i = 1; i < common_shapes; ++i) {
    for (std::size_t r = 0; r + 1 < rows.size(); ++r) holding.push_back(project(of_record(traced[i], rows, r)(slow)));
  }
  const Orthonormal at_rest(holding);
  Eigen::VectorXd gap = at_rest.without(project.gap(slow_difference));
  const double at_first = gap.squaredNorm();
  const double allowed = law_share * (fit.difference.squaredNorm() - static_cast<double>(fit.difference.size()));
  const Orthonormal constant({at_rest.without(project(traced.front()(slow)))});
  gap = constant.without(gap);
  const double above_noise = std::max(at_first - count, std::numeric_limits<double>::min());
  const auto share = [&](double from, double to) { return std::clamp((from - to) / above_noise, 0.0, 1.0); };
  const double nu = problem.settings.independent_share * count;
  const auto evidence = [&](double square) { return -0.5 * nu * penalty(problem.settings.independent_share * square / nu); };
  double least = gap.squaredNorm();
  std::vector<Discrepancy> found{{"constant", "", share(at_first, gap.squaredNorm()), evidence(gap.squaredNorm()) - evidence(at_first), {}}};

  for (std::size_t q = 0; q < all.size(); ++q) {
    std::vector<Block> of_fit = functions[q];
    for (Block& block : of_fit) {
      block.columns.resize(gap.size(), block.splines);
      for (int j = 0; j < block.splines; ++j) {
        const Eigen::VectorXd& trace = traced[block.first_shape + static_cast<std::size_t>(j)];
        const Eigen::VectorXd column = project((all[q].is_of_each_record ? of_record(trace, rows, block.record) : trace)(slow));
        block.columns.col(j) = -constant.without(at_rest.without(column));  // the machine's torque, the model's missing
      }
    }
    std::optional<Weighed> best;
    std::vector<const Block*> of_best;
    for (const SmoothFunction& function : functions_of(all[q].name)) {
      std::vector<const Block*> blocks;
      for (const std::size_t index : function.blocks) blocks.push_back(&of_fit[index]);
      Weighed weighed = weigh(blocks, gap, problem.settings.independent_share, count);
      if (best && weighed.evidence <= best->evidence) continue;
      best = std::move(weighed);
      of_best = std::move(blocks);
    }
    if (!best) continue;
    least = std::min(least, best->left);
    // Of the function and the constant together.
    found.push_back({all[q].name, all[q].unit, share(at_first, best->left), found.front().evidence + best->evidence, curves_of(all[q], of_best, *best, amount, rows.size() - 1)});
  }
  std::stable_sort(found.begin(), found.end(), [](const Discrepancy& a, const Discrepancy& b) { return a.evidence > b.evidence; });
  if (at_first - least <= allowed) return {};
  return found;
}

std::vector<SmoothFunction> SmoothTorques::functions_of(const std::string& variable) const {
  std::vector<SmoothFunction> result;
  const std::vector<Block>& blocks = traced_->of_variable(variable);
  for (const std::vector<std::size_t>& parts : traced_->quantity(variable).alternatives) {
    SmoothFunction function{variable, {}};
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (std::find(parts.begin(), parts.end(), blocks[b].part) != parts.end()) function.blocks.push_back(b);
    }
    if (!function.blocks.empty()) result.push_back(std::move(function));
  }
  return result;
}

Eigen::MatrixXd SmoothTorques::columns(const Problem& problem, const SmoothFunction& function) const {
  const std::vector<Eigen::Index> rows = first_rows(problem);
  const bool is_of_each_record = traced_->quantity(function.variable).is_of_each_record;
  const std::vector<const Block*> blocks = traced_->blocks(function);
  Eigen::Index count = 0;
  for (const Block* block : blocks) count += block->splines;
  Eigen::MatrixXd columns(rows.back(), count);
  Eigen::Index first = 0;
  for (const Block* block : blocks) {
    Eigen::MatrixXd of_block(rows.back(), block->splines);
    for (int j = 0; j < block->splines; ++j) {
      const Eigen::VectorXd& trace = traced_->traces[block->first_shape + static_cast<std::size_t>(j)];
      of_block.col(j) = is_of_each_record ? of_record(trace, rows, block->record) : trace;
    }
    const Eigen::LLT<Eigen::MatrixXd> root(roughness(block->splines));
    columns.middleCols(first, block->splines) = root.matrixL().solve(of_block.transpose()).transpose();
    first += block->splines;
  }
  return columns;
}

std::vector<MoreTorques> SmoothTorques::torques(const Problem& problem, const SmoothFunction& function, const Eigen::VectorXd& coefficients) const {
  const bool is_of_each_record = traced_->quantity(function.variable).is_of_each_record;
  const std::vector<const Block*> blocks = traced_->blocks(function);
  std::vector<Eigen::VectorXd> of_splines;
  Eigen::Index first = 0;
  for (const Block* block : blocks) {
    const Eigen::LLT<Eigen::MatrixXd> root(roughness(block->splines));
    of_splines.emplace_back(root.matrixU().solve(coefficients.segment(first, block->splines)));
    first += block->splines;
  }
  const auto shape = [&](std::size_t r, std::size_t n, std::size_t g) {
    double torque = 0.0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (is_of_each_record && blocks[b]->record != r) continue;
      for (int j = 0; j < blocks[b]->splines; ++j) torque += of_splines[b](j) * traced_->shapes[blocks[b]->first_shape + static_cast<std::size_t>(j)].torque(r, n, g);
    }
    return torque;
  };
  return torques_of(problem, traced_->enabled, traced_->amount, {shape, !blocks.empty() && traced_->shapes[blocks.front()->first_shape].is_on_house});
}

bool has_slow_gap(const Problem& problem, const FitResult& fit) {
  return mean_square(fit.difference(slow_rows(problem, kHighestFrequency / problem.thresholds.time))) > 1.0;
}

std::vector<Discrepancy> discrepancies(const Problem& problem, const FitResult& fit, const SmoothTorques& smooth, double law_share) {
  if (!has_slow_gap(problem, fit)) return {};
  return smooth.of_residual(problem, fit, law_share);
}

std::vector<std::string> followed_variables(const std::vector<Discrepancy>& discrepancies) {
  std::vector<std::string> names;
  if (discrepancies.empty() || discrepancies.front().evidence <= kFollowsAsWell) return names;
  const double as_well = discrepancies.front().evidence - kFollowsAsWell;
  for (const Discrepancy& one : discrepancies) {
    if (one.share < kFollowed || one.evidence < as_well) continue;
    if (one.variable == "constant") return {one.variable};  // the simplest of them
    names.push_back(one.variable);
  }
  return names;
}

}  // namespace slewlab::diagnosis
