#include "diagnosis/balance/balance_regression.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace slewlab::diagnosis {

namespace {

constexpr double kFewestJudged = 50.0;  // samples that must move
constexpr double kRidge = 1e-10;        // [-] parallel columns share a size instead of running away
constexpr double kMostNoise = 0.5;      // of a column's square, from which it tells more of the noise than of the axis; chosen

void add_column(const std::vector<double>& series, const std::vector<std::size_t>& judged, Eigen::MatrixXd& values, Eigen::Index column) {
  for (std::size_t i = 0; i < judged.size(); ++i) values(static_cast<Eigen::Index>(i), column) = series[judged[i]];
}

// Which lag's column each column is; -1: none.
std::vector<int> lags_of(const Regression& regression, const std::vector<BalanceLaw>& laws) {
  std::vector<int> lags;
  for (const RegressionColumn& column : regression.columns) {
    lags.push_back(column.law < 0 ? -1 : laws[static_cast<std::size_t>(column.law)].shapes[column.shape].late);
  }
  return lags;
}

// What noise of the efforts makes of a block's sums goes.
void take_out_noise(const std::vector<double>& noise_products, const std::vector<int>& lags, RegressionBlock& block) {
  if (noise_products.empty()) return;
  const auto size = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(noise_products.size()))));
  const auto product = [&](int row, int column) { return block.count * noise_products[static_cast<std::size_t>(row + 1) * size + static_cast<std::size_t>(column + 1)]; };
  for (std::size_t i = 0; i < lags.size(); ++i) {
    if (lags[i] < 0) continue;
    const auto row = static_cast<Eigen::Index>(i);
    block.with_effort(row) -= product(lags[i], -1);
    for (std::size_t j = 0; j < lags.size(); ++j) {
      if (lags[j] >= 0) block.products(row, static_cast<Eigen::Index>(j)) -= product(lags[i], lags[j]);
    }
  }
}

void mark_noise(Regression& regression) {
  for (std::size_t c = 0; c < regression.columns.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    double square = 0.0, left = 0.0;
    for (const Eigen::MatrixXd& values : regression.values) square += values.col(column).squaredNorm();
    for (const RegressionBlock& block : regression.blocks) left += block.products(column, column);
    regression.columns[c].is_noise = left < (1.0 - kMostNoise) * square;
  }
}

}  // namespace

std::vector<std::pair<Eigen::Index, Eigen::Index>> stretches_of(int block, Eigen::Index rows) {
  constexpr Eigen::Index kStretches = kBlocksPerRecord * kStretchesPerBlock;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> stretches;
  for (Eigen::Index s = block; s < kStretches; s += kBlocksPerRecord) {
    const Eigen::Index first = rows * s / kStretches, last = rows * (s + 1) / kStretches;
    if (last > first) stretches.emplace_back(first, last - first);
  }
  return stretches;
}

Regression make_regression(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double resolved_speed) {
  Regression regression;
  regression.columns.push_back({});
  regression.columns.push_back({kSkew});
  for (const BalanceLaw& law : laws) regression.acts_late.push_back(law.family == LawFamily::drive);
  for (std::size_t l = 0; l < laws.size(); ++l) {
    for (std::size_t s = 0; s < laws[l].shapes.size(); ++s) {
      for (std::size_t c = 0; c < laws[l].shapes[s].columns.size(); ++c) regression.columns.push_back({static_cast<int>(l), s});
    }
  }
  const std::vector<int> lags = lags_of(regression, laws);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const BalanceRecord& record = records[r];
    const std::vector<std::size_t> judged = moving_samples(record, resolved_speed);
    Eigen::MatrixXd values(static_cast<Eigen::Index>(judged.size()), static_cast<Eigen::Index>(regression.columns.size()));
    add_column(record.acceleration, judged, values, 0);
    add_column(law_column(record, [](const LawMoment& m) { return m.effort_rate; }), judged, values, 1);
    Eigen::Index column = 2;
    for (const BalanceLaw& law : laws) {
      for (const LawShape& shape : law.shapes) {
        for (const auto& value : shape.columns) add_column(law_column(record, value), judged, values, column++);
      }
    }
    Eigen::VectorXd effort(values.rows());
    for (std::size_t i = 0; i < judged.size(); ++i) effort(static_cast<Eigen::Index>(i)) = record.effort[judged[i]];
    for (int b = 0; b < kBlocksPerRecord; ++b) {
      RegressionBlock block{r, 0.0, 0.0, Eigen::MatrixXd::Zero(values.cols(), values.cols()), Eigen::VectorXd::Zero(values.cols())};
      for (const auto& [first, count] : stretches_of(b, values.rows())) {
        const auto rows = values.middleRows(first, count);
        const auto targets = effort.segment(first, count);
        block.count += static_cast<double>(count);
        block.square += targets.squaredNorm();
        block.products += rows.transpose() * rows;
        block.with_effort += rows.transpose() * targets;
      }
      take_out_noise(record.noise_products, lags, block);
      if (block.count > 0.0) regression.blocks.push_back(std::move(block));
    }
    regression.count += static_cast<double>(judged.size());
    regression.all += static_cast<double>(record.speed.size());
    regression.values.push_back(std::move(values));
    regression.efforts.push_back(std::move(effort));
    regression.judged.push_back(judged);
  }
  if (regression.count < kFewestJudged) {
    throw std::invalid_argument("the records hold no motion that the positions resolve; a torque balance needs moves at several speeds");
  }
  mark_noise(regression);
  regression.ridge = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(regression.columns.size()));
  return regression;
}

std::optional<std::pair<int, std::size_t>> chosen_law(const std::vector<BalanceLaw>& laws, std::string_view name) {
  const auto found = std::find_if(laws.begin(), laws.end(), [name](const BalanceLaw& law) { return law.name == name; });
  if (found == laws.end()) return std::nullopt;
  return std::pair(static_cast<int>(found - laws.begin()), std::size_t{0});
}

std::vector<Eigen::Index> columns_of(const Regression& regression, const LawChoice& choice) {
  // A drive that acts late shows as a skew does: one of them only.
  const bool is_skewed = regression.is_skewed && std::none_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) {
                           return regression.acts_late[static_cast<std::size_t>(law.first)];
                         });
  std::vector<Eigen::Index> chosen;
  for (std::size_t c = 0; c < regression.columns.size(); ++c) {
    const RegressionColumn& column = regression.columns[c];
    const bool is_chosen = column.law == kAcceleration || (column.law == kSkew && is_skewed) || std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) {
                             return law.first == column.law && law.second == column.shape;
                           });
    if (is_chosen) chosen.push_back(static_cast<Eigen::Index>(c));
  }
  return chosen;
}

RegressionSums sums_of(const Regression& regression, const std::vector<Eigen::Index>& columns, const std::function<bool(const RegressionBlock&)>& is_in) {
  const auto size = static_cast<Eigen::Index>(columns.size());
  RegressionSums sums{regression.ridge(columns).asDiagonal(), Eigen::VectorXd::Zero(size)};
  if (columns.front() == 0) sums.with_effort(0) = regression.ridge(0) * regression.nominal_inertia;
  for (const RegressionBlock& block : regression.blocks) {
    if (!is_in(block)) continue;
    sums.products += block.products(columns, columns);
    sums.with_effort += block.with_effort(columns);
  }
  return sums;
}

RegressionSums sums_of(const Regression& regression, const std::vector<Eigen::Index>& columns) {
  return sums_of(regression, columns, [](const RegressionBlock&) { return true; });
}

Eigen::VectorXd solve(const RegressionSums& sums) {
  const Eigen::VectorXd scale = sums.products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * sums.products * scale.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += kRidge;
  return scale.cwiseInverse().asDiagonal() * scaled.ldlt().solve(scale.cwiseInverse().asDiagonal() * sums.with_effort);
}

double least_determined(const RegressionSums& sums) {
  const Eigen::VectorXd scale = sums.products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * sums.products * scale.cwiseInverse().asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

double least_share(const RegressionSums& part, const RegressionSums& whole) {
  const Eigen::VectorXd scale = whole.products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * whole.products * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * part.products * scale.asDiagonal(), scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

double squared_error(const RegressionBlock& block, const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& sizes) {
  return block.square - 2.0 * sizes.dot(block.with_effort(columns)) + sizes.dot(block.products(columns, columns) * sizes);
}

Eigen::VectorXd residual_of(const Regression& regression, const FittedChoice& model, std::size_t record) {
  const std::vector<Eigen::Index> columns = columns_of(regression, model.choice);
  return regression.efforts[record] - regression.values[record](Eigen::all, columns) * model.sizes;
}

double correlation_length(const Regression& regression, const FittedChoice& model) {
  double longest = 1.0;
  for (std::size_t r = 0; r < regression.values.size(); ++r) {
    const Eigen::VectorXd residual = residual_of(regression, model, r);
    const double square = residual.squaredNorm();
    if (!(square > 0.0)) continue;
    double length = 1.0;
    const Eigen::Index count = residual.size();
    for (Eigen::Index lag = 1; lag < count / 4; ++lag) {
      const double together = residual.head(count - lag).dot(residual.tail(count - lag)) / square;
      if (together <= 0.0) break;
      length += 2.0 * together;
    }
    longest = std::max(longest, length);
  }
  return longest;
}

}  // namespace slewlab::diagnosis
