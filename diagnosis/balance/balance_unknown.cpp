#include "diagnosis/balance/balance_unknown.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slewlab::diagnosis {

namespace {

constexpr int kBumps = 20;            // of a smooth function of one variable
constexpr double kSmoothness = 1e-6;  // ridge, as a share of the columns' own square

// Bumps over the range of one variable, as functions of it.
Eigen::MatrixXd bumps(const Eigen::VectorXd& variable, double low, double high) {
  Eigen::MatrixXd values(variable.size(), kBumps);
  const double width = (high - low) / (kBumps - 1);
  for (Eigen::Index n = 0; n < variable.size(); ++n) {
    for (int b = 0; b < kBumps; ++b) {
      const double x = (variable(n) - (low + width * b)) / width;
      values(n, b) = std::exp(-0.5 * x * x);
    }
  }
  return values;
}

// The residual of targets on columns, each record having its own: errors on blocks and records that were left out.
LeftOutError left_out_error(const std::vector<Eigen::MatrixXd>& values, const std::vector<Eigen::VectorXd>& targets) {
  const Eigen::Index size = values.front().cols();
  struct Part {
    Eigen::MatrixXd products;
    Eigen::VectorXd with;
    double square, count;
    std::size_t record;
  };
  std::vector<Part> parts;
  Part sum{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, 0};
  for (std::size_t r = 0; r < targets.size(); ++r) {
    for (int b = 0; b < kBlocksPerRecord; ++b) {
      Part part{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, r};
      for (const auto& [first, count] : stretches_of(b, values[r].rows())) {
        const auto rows = values[r].middleRows(first, count);
        const auto target = targets[r].segment(first, count);
        part.products += rows.transpose() * rows;
        part.with += rows.transpose() * target;
        part.square += target.squaredNorm();
        part.count += static_cast<double>(count);
      }
      if (part.count == 0.0) continue;
      parts.push_back(std::move(part));
      sum.products += parts.back().products;
      sum.with += parts.back().with;
    }
  }
  // Of one part, from all that are fitted.
  const auto error_of = [](const Part& part, Eigen::MatrixXd products, const Eigen::VectorXd& with) {
    const Eigen::VectorXd scale = products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
    products = scale.cwiseInverse().asDiagonal() * products * scale.cwiseInverse().asDiagonal();
    products.diagonal().array() += kSmoothness;
    const Eigen::VectorXd fit = scale.cwiseInverse().asDiagonal() * products.ldlt().solve(scale.cwiseInverse().asDiagonal() * with);
    return std::max(0.0, part.square - 2.0 * fit.dot(part.with) + fit.dot(part.products * fit)) / part.count;
  };
  LeftOutError left;
  for (const Part& part : parts) {
    left.block_error.push_back(error_of(part, sum.products - part.products, sum.with - part.with));
    if (targets.size() < 2) continue;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd with = Eigen::VectorXd::Zero(size);
    for (const Part& other : parts) {
      if (other.record == part.record) continue;
      products += other.products;
      with += other.with;
    }
    left.record_block_error.push_back(error_of(part, std::move(products), with));
  }
  return left;
}

using Series = std::vector<Eigen::VectorXd>;  // per record, at the judged samples
using Columns = std::vector<Eigen::MatrixXd>;

Series variable_of(const std::vector<BalanceRecord>& records, const Regression& regression, std::vector<double> BalanceRecord::* series) {
  Series values;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Eigen::VectorXd one(static_cast<Eigen::Index>(regression.judged[r].size()));
    for (std::size_t i = 0; i < regression.judged[r].size(); ++i) one(static_cast<Eigen::Index>(i)) = (records[r].*series)[regression.judged[r][i]];
    values.push_back(std::move(one));
  }
  return values;
}

// A smooth function of a variable.
Columns smooth(const Series& variable) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::VectorXd& one : variable) {
    if (one.size() == 0) continue;
    low = std::min(low, one.minCoeff());
    high = std::max(high, one.maxCoeff());
  }
  Columns columns;
  for (const Eigen::VectorXd& one : variable) columns.push_back(bumps(one, low, high));
  return columns;
}

Columns times(const Columns& columns, const Series& factor) {
  Columns product;
  for (std::size_t r = 0; r < columns.size(); ++r) product.push_back(factor[r].asDiagonal() * columns[r]);
  return product;
}

Columns beside(const Columns& one, const Columns& other) {
  Columns both;
  for (std::size_t r = 0; r < one.size(); ++r) {
    Eigen::MatrixXd all(one[r].rows(), one[r].cols() + other[r].cols());
    all << one[r], other[r];
    both.push_back(std::move(all));
  }
  return both;
}

// A size of its own in each record.
Columns own_in_each(const Series& variable) {
  Columns columns;
  for (std::size_t r = 0; r < variable.size(); ++r) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(variable[r].size(), static_cast<Eigen::Index>(variable.size()));
    all.col(static_cast<Eigen::Index>(r)) = variable[r];
    columns.push_back(std::move(all));
  }
  return columns;
}

// Waves of the motor's angle, as the balance's filter leaves them.
Columns sines(const std::vector<BalanceRecord>& records, const Regression& regression, double motor_angle) {
  constexpr int kWaves = 12;  // per turn of the motor, chosen: slots times poles of small motors, whose lowest cogging is slower
  Columns columns;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(regression.judged[r].size()), 2 * kWaves);
    for (int wave = 1; wave <= kWaves; ++wave) {
      const double turns = wave * motor_angle;
      const std::vector<double> sine = law_column(records[r], [turns](const LawMoment& m) { return std::sin(turns * m.position); });
      const std::vector<double> cosine = law_column(records[r], [turns](const LawMoment& m) { return std::cos(turns * m.position); });
      for (std::size_t i = 0; i < regression.judged[r].size(); ++i) {
        all(static_cast<Eigen::Index>(i), 2 * wave - 2) = sine[regression.judged[r][i]];
        all(static_cast<Eigen::Index>(i), 2 * wave - 1) = cosine[regression.judged[r][i]];
      }
    }
    columns.push_back(std::move(all));
  }
  return columns;
}

struct Variable {
  const char *name, *words;
  Columns columns;
};

// What a residual may follow. `asked`: the torque that the model asks for.
std::vector<Variable> variables_of(const std::vector<BalanceRecord>& records, const Regression& regression, const Series& asked, double motor_angle) {
  const Series speed = variable_of(records, regression, &BalanceRecord::speed), position = variable_of(records, regression, &BalanceRecord::position);
  const Series acceleration = variable_of(records, regression, &BalanceRecord::acceleration);
  const Series time = variable_of(records, regression, &BalanceRecord::time);
  Series direction, size, one;
  for (std::size_t r = 0; r < records.size(); ++r) {
    direction.push_back(speed[r].cwiseSign());
    size.push_back(asked[r].cwiseAbs());
    one.push_back(Eigen::VectorXd::Ones(speed[r].size()));
  }
  std::vector<Variable> variables{
      {"speed", "follows the speed", smooth(speed)},
      {"position", "follows the position", smooth(position)},
      {"time", "follows the time", smooth(time)},
      {"torque", "follows the torque", smooth(asked)},
      {"position and direction", "follows the position, against the motion (a tight spot?)", times(smooth(position), direction)},
      {"time and direction", "follows the time, against the motion (friction that changes as it warms?)", times(smooth(time), direction)},
      {"torque and direction", "grows with the torque, against the motion (losses of a gear?)", times(smooth(size), direction)}};
  if (motor_angle > 0.0) {
    const Columns waves = sines(records, regression, motor_angle);
    variables.push_back({"angle of the motor", "follows the angle of the motor (cogging?)", waves});
    variables.push_back({"torque and angle of the motor", "follows the torque over each turn of the motor (a ripple?)", times(waves, asked)});
  }
  if (records.size() < 2) return variables;
  variables.push_back({"record, as a constant torque", "differs from record to record as a constant torque does (another load, a zero that drifts?)", own_in_each(one)});
  variables.push_back({"record, as a friction", "differs from record to record as a friction does (cold and warm?)", own_in_each(direction)});
  variables.push_back({"record, as an inertia", "differs from record to record as an inertia does (another payload?)", own_in_each(acceleration)});
  return variables;
}

// Over all samples, of what the blocks have each.
double mean_over(const Regression& regression, const std::vector<double>& block_error) {
  double sum = 0.0;
  for (std::size_t b = 0; b < block_error.size(); ++b) sum += block_error[b] * regression.blocks[b].count;
  return sum / regression.count;
}

}  // namespace

LeftOutError unknown_validation(const std::vector<BalanceRecord>& records, const Regression& regression) {
  Columns inertia;
  for (const Eigen::MatrixXd& values : regression.values) inertia.push_back(values.leftCols(1));
  const Columns speed = smooth(variable_of(records, regression, &BalanceRecord::speed)), position = smooth(variable_of(records, regression, &BalanceRecord::position));
  return left_out_error(beside(beside(speed, position), inertia), regression.efforts);
}

Remainder find_remainder(const std::vector<BalanceRecord>& records, const Regression& regression, const FittedChoice& best, double motor_angle) {
  Series residuals, asked;
  double square = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.push_back(residual_of(regression, best, r));
    asked.push_back(regression.efforts[r] - residuals.back());
    square += residuals.back().squaredNorm();
  }
  const double mean = square / regression.count;
  Remainder remainder;
  if (!(mean > 0.0)) return remainder;
  for (const Variable& one : variables_of(records, regression, asked, motor_angle)) {
    const double share = 1.0 - mean_over(regression, left_out_error(one.columns, residuals).block_error) / mean;
    if (share > remainder.share) remainder = {one.name, one.words, share};
  }
  constexpr double kWorthAWord = 0.1;  // share of the residual's mean square
  return remainder.share > kWorthAWord ? remainder : Remainder{};
}

}  // namespace slewlab::diagnosis
