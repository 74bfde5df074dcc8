// Sums over blocks against the samples that they stand for; sizes against those that were put in; correlation against its closed form.
#include "diagnosis/balance/balance_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

TEST(BalanceRegression, TheStretchesOfAllBlocksAreEverySampleOnce) {
  for (const Eigen::Index rows : {1, 7, 39, 40, 41, 1000, 1234}) {
    std::vector<int> taken(static_cast<std::size_t>(rows), 0);
    for (int block = 0; block < kBlocksPerRecord; ++block) {
      for (const auto& [first, count] : stretches_of(block, rows)) {
        for (Eigen::Index n = first; n < first + count; ++n) ++taken.at(static_cast<std::size_t>(n));
      }
    }
    EXPECT_EQ(taken, std::vector<int>(taken.size(), 1)) << rows;
  }
}

TEST(BalanceRegression, SumsOverBlocksAreSumsOverSamples) {
  const Regression regression = prepared_axis({.resistance = usual_friction, .noise = 2e-6}).regression;
  const std::vector<Eigen::Index> all = [&] {
    std::vector<Eigen::Index> columns(regression.columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = static_cast<Eigen::Index>(c);
    return columns;
  }();
  Eigen::MatrixXd products = regression.ridge.asDiagonal();
  double square = 0.0;
  for (std::size_t r = 0; r < regression.values.size(); ++r) {
    products += regression.values[r].transpose() * regression.values[r];
    square += regression.efforts[r].squaredNorm();
  }
  const RegressionSums sums = sums_of(regression, all);
  EXPECT_LT((sums.products - products).norm(), 1e-9 * products.norm());
  double of_blocks = 0.0;
  for (const RegressionBlock& block : regression.blocks) of_blocks += squared_error(block, all, Eigen::VectorXd::Zero(products.cols()));
  EXPECT_NEAR(of_blocks, square, 1e-9 * square);
}

TEST(BalanceRegression, SizesAreThoseThatWerePutIn) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const std::vector<Eigen::Index> columns = columns_of(axis.regression, choice_of(axis.balance.laws, {"dry", "viscous"}));
  ASSERT_EQ(columns.size(), 5u);  // inertia, skew, dry friction, viscous friction and half the difference of its directions
  const Eigen::VectorXd sizes = solve(sums_of(axis.regression, columns));
  EXPECT_NEAR(sizes(0), 2.0, 0.02);
  EXPECT_NEAR(sizes(1), 0.5 * 0.01, 0.01) << "[s]: a skew of half a sample at most";
  EXPECT_NEAR(sizes(2), 1.2, 0.05);
  EXPECT_NEAR(sizes(3), 0.8, 0.04);
  EXPECT_NEAR(sizes(4), 0.0, 0.04);
}

TEST(BalanceRegression, ParallelColumnsAreNotDetermined) {
  RegressionSums sums{Eigen::MatrixXd{{4.0, 2e-3}, {2e-3, 1e-6}}, Eigen::VectorXd{{6.0, 3e-3}}};  // the second is 5e-4 of the first
  EXPECT_NEAR(least_determined(sums), 0.0, 1e-12);
  EXPECT_LT(solve(sums).norm(), 1e6) << "they share a size";
  sums.products(0, 1) = sums.products(1, 0) = 0.0;
  EXPECT_NEAR(least_determined(sums), 1.0, 1e-12);
}

// Of a first-order autoregression x_n = a x_(n-1) + noise the sum of the autocorrelation over both sides is (1 + a) / (1 - a).
TEST(BalanceRegression, CorrelationLengthIsThatOfAnAutoregression) {
  constexpr double kMemory = 0.8;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  Regression regression;
  regression.columns.push_back({});
  regression.values.emplace_back(Eigen::MatrixXd::Zero(40000, 1));
  regression.efforts.emplace_back(40000);
  double last = 0.0;
  for (Eigen::Index n = 0; n < regression.efforts[0].size(); ++n) regression.efforts[0](n) = last = kMemory * last + normal(generator);
  EXPECT_NEAR(correlation_length(regression, {{}, Eigen::VectorXd::Zero(1)}), (1.0 + kMemory) / (1.0 - kMemory), 1.5);
}

// What acts late and a skew are the same to first order of the lag.
TEST(BalanceRegression, ADriveThatActsLateTakesTheSkewsPlace) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const std::vector<Eigen::Index> columns = columns_of(axis.regression, choice_of(axis.balance.laws, {"lag"}));
  ASSERT_EQ(columns.size(), 2u);
  EXPECT_EQ(columns[0], 0);
  EXPECT_NE(columns[1], kSkewColumn);
}

// Noise of a measured torque is in what a lag withholds of it as well. Least squares take it for a lag; with its part taken out none is there, and the
// lag gains nothing by it.
TEST(BalanceRegression, NoiseOfTheTorqueIsNoLag) {
  std::vector<AxisRecord> records = two_records({.noise = 2e-6});
  std::mt19937_64 generator(2);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (AxisRecord& record : records) {
    for (double& effort : record.effort) effort += noise(generator);
  }
  const Balance balance = balance_of(records, 2.0, 8.0, true);
  const Regression regression = prepared_regression(smoothed(records, balance), balance.laws, 2.0, balance.resolved_speed);
  const std::vector<Eigen::Index> columns = columns_of(regression, choice_of(balance.laws, {"lag"})), alone{0};
  RegressionSums plain{Eigen::MatrixXd::Zero(2, 2), Eigen::VectorXd::Zero(2)};
  double square = 0.0, without = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    plain.products += regression.values[r](Eigen::all, columns).transpose() * regression.values[r](Eigen::all, columns);
    plain.with_effort += regression.values[r](Eigen::all, columns).transpose() * regression.efforts[r];
  }
  const Eigen::VectorXd sizes = solve(sums_of(regression, columns)), inertia = solve(sums_of(regression, alone));
  for (const RegressionBlock& block : regression.blocks) {
    square += squared_error(block, columns, sizes);
    without += squared_error(block, alone, inertia);
  }
  const double lag = balance.laws[static_cast<std::size_t>(regression.columns[static_cast<std::size_t>(columns[1])].law)].shapes[0].shape;
  EXPECT_GT(solve(plain)(1), 0.3 * lag) << "or this tests nothing";
  EXPECT_LT(std::fabs(sizes(1)), 0.1 * solve(plain)(1));
  EXPECT_NEAR(square, without, 0.01 * without);
}

// Of two columns of squares 10 and 4 a part tells 5 and 1: a quarter of the second, in whatever units.
TEST(BalanceRegression, APartTellsTheLeastShareOfTheSizes) {
  for (const double unit : {1.0, 1e3}) {
    const auto sums = [unit](double first, double second) {
      Eigen::MatrixXd products = Eigen::Vector2d(first, second * unit * unit).asDiagonal();
      return RegressionSums{products, Eigen::VectorXd::Zero(2)};
    };
    EXPECT_NEAR(least_share(sums(5.0, 1.0), sums(10.0, 4.0)), 0.25, 1e-6);
    EXPECT_NEAR(least_share(sums(10.0, 4.0), sums(10.0, 4.0)), 1.0, 1e-6);
    EXPECT_NEAR(least_share(sums(5.0, 0.0), sums(10.0, 4.0)), 0.0, 1e-6);
  }
}

TEST(BalanceRegression, RecordsThatStandAreRefused) {
  const AxisRecord record{"standing", 0.01, std::vector<double>(2000, 1.0), std::vector<double>(2000, 0.5)};
  EXPECT_THROW(make_regression({make_balance_record(record, 5)}, balance_laws({1.0, 1e-3, 20.0, 0.0, 0.0, true, {}}), 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
