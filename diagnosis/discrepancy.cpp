#include "diagnosis/discrepancy.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "diagnosis/screen.h"
#include "sim/machine/scales.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kSegments = 8;                 // between knots
constexpr int kSplines = kSegments + 3;
constexpr double kLevelPrice = 0.1;          // of a coefficient beside its second differences
constexpr double kAmount = 0.01;             // of the rated torque: so little that no tooth parts
constexpr double kStandstill = 0.02;         // of the largest speed, in which the direction turns
constexpr double kLowest = -9.0, kHighest = 9.0;  // ln rho, in squares of the amount: from a ten-thousandth to the rated torque
constexpr int kScales = 25;
constexpr int kCurvePoints = 41;
constexpr double kHighestFrequency = 1.0;    // [1 / characteristic time] that a smooth function of slow quantities is asked to explain
constexpr double kHeld = 1.0;  // [characteristic times] between the knots of what holds at standstill

// B_j of v, on knots from `low` to `high`.
double spline(int j, double v, double low, double high) {
  const double u = std::fabs((v - low) / (high - low) * kSegments - static_cast<double>(j - 1));
  if (u >= 2.0) return 0.0;
  if (u >= 1.0) return (2.0 - u) * (2.0 - u) * (2.0 - u) / 6.0;
  return (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0;
}

// What a record's grid points have of each quantity.
struct Course {
  std::vector<double> speed, angle, time, direction;
  std::vector<double> net_torque, load;  // [Nm per motor] mean, and mean of the amounts
};

struct Quantity {
  const char* name;
  const char* unit;
  std::vector<double> Course::* values;
  bool is_of_each_record;
  struct Part {
    const char* name;
    std::function<double(const Course&, std::size_t)> factor;
  };
  std::vector<Part> parts;
};

double largest(const std::vector<std::vector<double>>& series) {
  double most = 0.0;
  for (const std::vector<double>& one : series) {
    for (const double value : one) most = std::max(most, std::fabs(value));
  }
  return most;
}

std::vector<Course> courses_of(const Problem& problem, double ratio) {
  std::vector<Course> courses;
  for (const Record& record : problem.records) {
    Course course;
    const auto groups = static_cast<std::size_t>(record.group_count);
    for (std::size_t n = 0; n < record.size(); ++n) {
      double speed = 0.0, angle = 0.0, torque = 0.0, load = 0.0;
      for (std::size_t g = 0; g < groups; ++g) {
        speed += record.position_rate[g].empty() ? record.shaft_speed[g][n] : record.position_rate[g][n];
        angle += record.shaft_position[g][n];
        torque += record.motor_torque[g][n];
        load += std::fabs(record.motor_torque[g][n]);
      }
      const double shafts = ratio * static_cast<double>(groups);
      course.speed.push_back(speed / shafts);
      course.angle.push_back(angle / shafts);
      course.time.push_back(record.step * static_cast<double>(n));
      course.net_torque.push_back(torque / static_cast<double>(groups));
      course.load.push_back(load / static_cast<double>(groups));
    }
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

std::vector<Quantity> quantities(double largest_torque) {
  const Quantity::Part forward{"forward", [](const Course& c, std::size_t n) { return std::max(0.0, c.direction[n]); }};
  const Quantity::Part backward{"backward", [](const Course& c, std::size_t n) { return std::max(0.0, -c.direction[n]); }};
  const Quantity::Part with_torque{"with the torque", [largest_torque](const Course& c, std::size_t n) { return c.net_torque[n] / largest_torque; }};
  return {{"speed", "rad/s", &Course::speed, false, {forward, backward}},
          {"angle", "rad", &Course::angle, false, {forward, backward}},
          {"time", "s", &Course::time, true, {forward, backward, with_torque}},
          {"torque", "Nm", &Course::load, false, {forward, backward}}};
}

// The least and the greatest value of a quantity where `factor` acts and the records are judged.
std::pair<double, double> range_of(const Problem& problem, const std::vector<Course>& courses, const Quantity& quantity, const Quantity::Part& part) {
  constexpr double kActs = 0.1;  // of a factor's largest
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t r = 0; r < courses.size(); ++r) {
    const std::vector<double>& values = courses[r].*quantity.values;
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (!(problem.whitening[r].window[n] > 0.0) || std::fabs(part.factor(courses[r], n)) < kActs) continue;
      low = std::min(low, values[n]);
      high = std::max(high, values[n]);
    }
  }
  return {low, high};
}

// The change of the differences by torques at the motors [amounts], one function of record and grid point each.
using TorqueShape = std::function<double(std::size_t record, std::size_t point)>;
std::vector<Eigen::VectorXd> traces(Problem& problem, const Point& point, const Eigen::VectorXd& difference, double amount,
                                    const std::vector<TorqueShape>& shapes) {
  std::vector<Eigen::VectorXd> columns(shapes.size());
  share_out(problem, shapes.size(), [&](std::size_t i) {
    std::vector<DriveCourse> drives;
    for (std::size_t r = 0; r < problem.records.size(); ++r) {
      DriveCourse course = problem.stock.drives(problem.records[r], r, problem.nominal.drive_protection);
      for (std::size_t g = 0; g < static_cast<std::size_t>(problem.records[r].group_count); ++g) {
        std::vector<double>& torque = course.motor_torque[g];
        for (std::size_t n = 0; n < torque.size(); ++n) torque[n] += amount * shapes[i](r, n / course.per_point);
      }
      hold_on_grid(course);
      drives.push_back(std::move(course));
    }
    columns[i] = differences(problem, point, drives) - difference;
  });
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

// A function of one quantity, ready to be weighed.
struct Columns {
  const Quantity* quantity;
  struct Block {
    std::size_t part, record;  // of all records: 0
    double low, high;
  };
  std::vector<Block> blocks;  // kSplines columns each
  Eigen::MatrixXd columns;    // what parameters, hypothesis and a constant torque leave of the traces
};

struct Weighed {
  double evidence = 0.0;
  double left = 0.0;               // sum of squares
  Eigen::VectorXd mean;            // [amounts]
  Eigen::MatrixXd covariance;      // [amounts^2]
};

double penalty(double mean_square) { return mean_square > 1.0 ? std::log(mean_square) : mean_square - 1.0; }

// P of one block.
Eigen::MatrixXd roughness() {
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(kSplines - 2, kSplines);
  for (int i = 0; i + 2 < kSplines; ++i) second.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
  return second.transpose() * second + kLevelPrice * Eigen::MatrixXd::Identity(kSplines, kSplines);
}

Weighed weigh(const Eigen::MatrixXd& columns, const Eigen::VectorXd& gap, double independent_share, double count) {
  const Eigen::Index size = columns.cols();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index b = 0; b < size; b += kSplines) precision.block(b, b, kSplines, kSplines) = roughness();
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
  for (int k = 0; k < kScales; ++k) {
    const double rho = std::exp(kLowest + (kHighest - kLowest) * k / (kScales - 1));
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

std::vector<DiscrepancyCurve> curves_of(const Columns& function, const Weighed& weighed, double amount, std::size_t records) {
  std::vector<DiscrepancyCurve> curves;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    const Columns::Block& block = function.blocks[b];
    DiscrepancyCurve curve;
    curve.part = function.quantity->parts[block.part].name;
    if (function.quantity->is_of_each_record && records > 1) curve.part += ", record " + std::to_string(block.record + 1);
    const auto first = static_cast<Eigen::Index>(b) * kSplines;
    for (int i = 0; i < kCurvePoints; ++i) {
      const double v = block.low + (block.high - block.low) * i / (kCurvePoints - 1);
      Eigen::VectorXd values(kSplines);
      for (int j = 0; j < kSplines; ++j) values(j) = spline(j, v, block.low, block.high);
      curve.at.push_back(v);
      curve.torque.push_back(amount * values.dot(weighed.mean.segment(first, kSplines)));
      const double variance = values.dot(weighed.covariance.block(first, first, kSplines, kSplines) * values);
      curve.deviation.push_back(amount * std::sqrt(std::max(0.0, variance)));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace

std::vector<Discrepancy> discrepancies(Problem& problem, const FitResult& fit) {
  const std::vector<Eigen::Index> slow = slow_rows(problem, kHighestFrequency / problem.thresholds.time);
  const double count = static_cast<double>(slow.size());
  const Eigen::VectorXd slow_difference = fit.difference(slow);
  if (mean_square(slow_difference) <= 1.0) return {};
  const sim::Scales scales = sim::scales_of(problem.nominal.crane);
  const std::vector<Course> courses = courses_of(problem, scales.ratio);
  std::vector<std::vector<double>> torques;
  for (const Course& course : courses) torques.push_back(course.net_torque);
  const std::vector<Quantity> all = quantities(std::max(largest(torques), std::numeric_limits<double>::min()));
  const double amount = kAmount * scales.motor_torque;
  const Projector project(fit.columns(slow, Eigen::indexing::all), prior_rows(problem, fit.point), data_weight(slow_difference, problem.settings));

  // One simulation moves a function of all records' times at once: each record's rows tell its own. First what is no discrepancy of any
  // variable: a constant, and whatever holds the machine at standstill, which no law of motion tells.
  std::vector<TorqueShape> shapes{[](std::size_t, std::size_t) { return 1.0; }};
  const double knots = kHeld * problem.thresholds.time;
  const auto held = static_cast<std::size_t>(std::ceil(longest_record(problem) / knots)) + 1;
  for (std::size_t k = 0; k < held; ++k) {
    const auto hat = [&courses, knots, k](std::size_t r, std::size_t n) {
      const double at_rest = 1.0 - std::fabs(courses[r].direction[n]);
      return at_rest * std::max(0.0, 1.0 - std::fabs(courses[r].time[n] / knots - static_cast<double>(k)));
    };
    bool acts = false;
    for (std::size_t r = 0; r < courses.size() && !acts; ++r) {
      for (std::size_t n = 0; n < courses[r].time.size() && !acts; ++n) acts = hat(r, n) > 0.5;
    }
    if (acts) shapes.emplace_back(hat);
  }
  const std::size_t common_shapes = shapes.size();
  std::vector<Columns> functions;
  for (const Quantity& quantity : all) {
    Columns& function = functions.emplace_back(Columns{&quantity, {}, {}});
    for (std::size_t p = 0; p < quantity.parts.size(); ++p) {
      const auto [low, high] = range_of(problem, courses, quantity, quantity.parts[p]);
      if (!(high > low)) continue;
      const std::size_t copies = quantity.is_of_each_record ? courses.size() : 1;
      for (std::size_t r = 0; r < copies; ++r) function.blocks.push_back({p, r, low, high});
      for (int j = 0; j < kSplines; ++j) {
        shapes.emplace_back([&courses, &quantity, p, j, low = low, high = high](std::size_t r, std::size_t n) {
          return quantity.parts[p].factor(courses[r], n) * spline(j, std::clamp((courses[r].*quantity.values)[n], low, high), low, high);
        });
      }
    }
  }
  const std::vector<Eigen::VectorXd> traced = traces(problem, fit.point, fit.difference, amount, shapes);

  const std::vector<Eigen::Index> rows = first_rows(problem);
  const auto of_record = [&](const Eigen::VectorXd& trace, std::size_t record) {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(trace.size());
    own.segment(rows[record], rows[record + 1] - rows[record]) = trace.segment(rows[record], rows[record + 1] - rows[record]);
    return own;
  };
  std::vector<Eigen::VectorXd> holding;
  for (std::size_t i = 1; i < common_shapes; ++i) {
    for (std::size_t r = 0; r < courses.size(); ++r) holding.push_back(project(of_record(traced[i], r)(slow)));
  }
  const Orthonormal at_rest(holding);
  Eigen::VectorXd gap = at_rest.without(project.gap(slow_difference));
  const double at_first = gap.squaredNorm();
  const Orthonormal constant({at_rest.without(project(traced.front()(slow)))});
  gap = constant.without(gap);
  const double above_noise = std::max(at_first - count, std::numeric_limits<double>::min());
  const auto share = [&](double from, double to) { return std::clamp((from - to) / above_noise, 0.0, 1.0); };
  const double nu = problem.settings.independent_share * count;
  const auto evidence = [&](double square) { return -0.5 * nu * penalty(problem.settings.independent_share * square / nu); };
  std::vector<Discrepancy> found{{"constant", "", share(at_first, gap.squaredNorm()), evidence(gap.squaredNorm()) - evidence(at_first), {}}};

  std::size_t shape = common_shapes;
  for (Columns& function : functions) {
    const auto blocks = static_cast<Eigen::Index>(function.blocks.size());
    function.columns.resize(gap.size(), blocks * kSplines);
    std::size_t first_shape = shape;
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const Columns::Block& block = function.blocks[static_cast<std::size_t>(b)];
      if (block.record == 0 && b > 0) first_shape += kSplines;  // the next part's
      for (int j = 0; j < kSplines; ++j) {
        const Eigen::VectorXd& trace = traced[first_shape + static_cast<std::size_t>(j)];
        const Eigen::VectorXd column = project((function.quantity->is_of_each_record ? of_record(trace, block.record) : trace)(slow));
        function.columns.col(b * kSplines + j) = -constant.without(at_rest.without(column));  // the machine's torque, the model's missing
      }
    }
    if (blocks == 0) continue;
    shape = first_shape + kSplines;
    const Weighed weighed = weigh(function.columns, gap, problem.settings.independent_share, count);
    found.push_back({function.quantity->name, function.quantity->unit, share(gap.squaredNorm(), weighed.left), weighed.evidence,
                     curves_of(function, weighed, amount, courses.size())});
  }
  std::stable_sort(found.begin(), found.end(), [](const Discrepancy& a, const Discrepancy& b) { return a.evidence > b.evidence; });
  return found;
}

std::vector<std::string> followed_variables(const std::vector<Discrepancy>& discrepancies) {
  std::vector<std::string> names;
  for (const Discrepancy& one : discrepancies) {
    if (one.share >= kFollowed && one.evidence >= discrepancies.front().evidence - kFollowsAsWell) names.push_back(one.variable);
  }
  return names;
}

}  // namespace slewlab::diagnosis
