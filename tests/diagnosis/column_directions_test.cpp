#include "diagnosis/column_directions.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace slewlab::diagnosis {
namespace {

constexpr double kDeviations = 1.5;

// Two records of seven differences each, three coordinates of both, two of each record's own, one that nothing is asked of. Columns of its own change no other record.
struct Example {
  CoordinateBlocks blocks{{0, 1, 7}, {{2, 3}, {4, 5}}};
  std::array<Eigen::Index, 3> first_row{0, 7, 14};
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(14, 8);
  Eigen::MatrixXd curvature;
  Eigen::VectorXd longest = Eigen::VectorXd::Constant(8, 1e9);

  Example() {
    std::mt19937_64 generator(7);
    std::normal_distribution<double> normal;
    const auto fill = [&](Eigen::Index column, Eigen::Index from, Eigen::Index count) {
      for (Eigen::Index row = from; row < from + count; ++row) columns(row, column) = normal(generator);
    };
    for (const Eigen::Index k : blocks.common) fill(k, 0, 14);
    for (std::size_t r = 0; r < 2; ++r) {
      for (const Eigen::Index k : blocks.own[r]) fill(k, first_row[r], 7);
    }
    // A narrow valley: two coordinates that do nearly the same, of all records and beside one's own.
    columns.col(1) = columns.col(0) + 1e-3 * columns.col(1);
    columns.col(2).head(7) = columns.col(0).head(7) + 1e-2 * columns.col(2).head(7);
    curvature = columns.transpose() * columns;
    curvature.diagonal().array() += 1e-8;
  }
};

std::vector<Eigen::VectorXd> changes_along(const Example& example, const ColumnDirections& directions) {
  std::vector<Eigen::VectorXd> changes;
  for (const Eigen::MatrixXd* some : {&directions.own, &directions.common}) {
    for (Eigen::Index i = 0; i < some->cols(); ++i) changes.emplace_back(example.columns * some->col(i));
  }
  return changes;
}

// v_i^T H v_j = h^2 where i = j, else 0: of the common ones against each other and against each record's own, and within each record.
TEST(ColumnDirections, AreAxesOfTheCurvature) {
  const Example example;
  const ColumnDirections directions = column_directions(example.curvature, example.blocks, example.longest, kDeviations);
  ASSERT_EQ(directions.own.cols(), 2);
  ASSERT_EQ(directions.common.cols(), 3);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(8, 7);
  for (std::size_t r = 0; r < 2; ++r) {
    for (const Eigen::Index k : example.blocks.own[r]) all.block(k, static_cast<Eigen::Index>(2 * r), 1, 2) = directions.own.row(k);
  }
  all.rightCols(3) = directions.common;
  const Eigen::MatrixXd products = all.transpose() * example.curvature * all;
  EXPECT_TRUE(products.isApprox(kDeviations * kDeviations * Eigen::MatrixXd::Identity(7, 7), 1e-6)) << products;
  EXPECT_TRUE(all.row(6).isZero(0.0));
}

TEST(ColumnDirections, GoNoFartherThanCoordinatesMay) {
  Example example;
  example.longest = Eigen::VectorXd::LinSpaced(8, 0.01, 0.08);
  example.curvature(7, 7) = 0.0;  // nothing tells of it
  example.curvature.row(7).head(7).setZero();
  example.curvature.col(7).head(7).setZero();
  const ColumnDirections directions = column_directions(example.curvature, example.blocks, example.longest, kDeviations);
  for (const Eigen::MatrixXd* some : {&directions.own, &directions.common}) {
    for (Eigen::Index i = 0; i < some->cols(); ++i) {
      EXPECT_TRUE((some->col(i).cwiseAbs().array() <= example.longest.array() * (1.0 + 1e-12)).all());
      EXPECT_GT(some->col(i).cwiseAbs().maxCoeff(), 0.0);
    }
  }
  EXPECT_NEAR(directions.common.row(7).cwiseAbs().maxCoeff(), example.longest(7), 1e-12);
}

// Of a linear law the columns come out as they are, whatever the directions; those that no block has stay.
TEST(ColumnDirections, GiveTheColumnsBack) {
  Example example;
  for (const double longest : {1e9, 0.03}) {
    example.longest.setConstant(longest);
    const ColumnDirections directions = column_directions(example.curvature, example.blocks, example.longest, kDeviations);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Constant(14, 8, 3.0);
    columns_along(directions, example.blocks, changes_along(example, directions), example.first_row, columns);
    EXPECT_TRUE(columns.leftCols(6).isApprox(example.columns.leftCols(6), 1e-6));
    EXPECT_TRUE(columns.col(7).isApprox(example.columns.col(7), 1e-6));
    EXPECT_TRUE((columns.col(6).array() == 3.0).all());
  }
}

// No record has anything of its own: the coordinates' axes alone.
TEST(ColumnDirections, NeedNoCoordinatesOfARecord) {
  const Example example;
  const CoordinateBlocks blocks{{0, 1}, {}};
  const ColumnDirections directions = column_directions(example.curvature, blocks, example.longest, kDeviations);
  EXPECT_EQ(directions.own.cols(), 0);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(14, 8);
  columns_along(directions, blocks, changes_along(example, directions), example.first_row, columns);
  EXPECT_TRUE(columns.leftCols(2).isApprox(example.columns.leftCols(2), 1e-6));
}

}  // namespace
}  // namespace slewlab::diagnosis
