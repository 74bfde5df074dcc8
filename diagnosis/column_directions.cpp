#include "diagnosis/column_directions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

// Axes of a block as columns, unit vectors, and how far `deviations` lead along each.
struct Axes {
  Eigen::MatrixXd axis;
  Eigen::VectorXd length;
};
Axes axes_of(const Eigen::MatrixXd& block, double deviations) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(block);
  return {solver.eigenvectors(), deviations * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseInverse()};
}

// By how much a change must be shortened so that no coordinate goes too far.
double shortened(const Eigen::VectorXd& change, const Eigen::VectorXd& longest) {
  double share = 1.0;
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    if (std::fabs(change(i)) > longest(i)) share = std::min(share, longest(i) / std::fabs(change(i)));
  }
  return share;
}

}  // namespace

ColumnDirections column_directions(const Eigen::MatrixXd& curvature, const CoordinateBlocks& blocks, const Eigen::VectorXd& longest, double deviations) {
  const auto commons = static_cast<Eigen::Index>(blocks.common.size());
  const auto owns = static_cast<Eigen::Index>(blocks.own.empty() ? 0 : blocks.own.front().size());
  ColumnDirections directions{Eigen::MatrixXd::Zero(curvature.rows(), owns), Eigen::MatrixXd::Zero(curvature.rows(), commons)};
  // What an infinite length would be is the longest that the coordinates allow.
  const auto change_along = [](const Eigen::VectorXd& axis, double length, const Eigen::VectorXd& limits) -> Eigen::VectorXd {
    if (!std::isfinite(length)) length = limits.maxCoeff() / axis.cwiseAbs().maxCoeff();
    const Eigen::VectorXd change = length * axis;
    return shortened(change, limits) * change;
  };
  Eigen::MatrixXd left = curvature(blocks.common, blocks.common);
  Eigen::MatrixXd along = Eigen::MatrixXd::Zero(curvature.rows(), commons);  // of each common coordinate: itself, and what goes along
  for (Eigen::Index i = 0; i < commons; ++i) along(blocks.common[static_cast<std::size_t>(i)], i) = 1.0;
  for (const std::vector<Eigen::Index>& own : blocks.own) {
    const Eigen::MatrixXd block = curvature(own, own), across = curvature(own, blocks.common);
    const Axes axes = axes_of(block, deviations);
    for (Eigen::Index i = 0; i < owns; ++i) {
      directions.own(own, i) = change_along(axes.axis.col(i), axes.length(i), longest(own));
    }
    const Eigen::MatrixXd goes_along = block.ldlt().solve(across);
    left -= across.transpose() * goes_along;
    along(own, Eigen::all) = -goes_along;
  }
  const Axes axes = axes_of(left, deviations);
  for (Eigen::Index i = 0; i < commons; ++i) {
    const Eigen::VectorXd change = along * axes.axis.col(i);
    directions.common.col(i) = change_along(change, axes.length(i), longest);
  }
  return directions;
}

void columns_along(const ColumnDirections& directions, const CoordinateBlocks& blocks, std::span<const Eigen::VectorXd> changes, std::span<const Eigen::Index> first_row, Eigen::MatrixXd& columns) {
  const auto owns = directions.own.cols(), commons = directions.common.cols();
  const auto rows = columns.rows();
  for (std::size_t r = 0; r < blocks.own.size(); ++r) {
    const Eigen::Index from = first_row[r], count = first_row[r + 1] - from;
    Eigen::MatrixXd changed(count, owns);
    for (Eigen::Index i = 0; i < owns; ++i) changed.col(i) = changes[static_cast<std::size_t>(i)].segment(from, count);
    const Eigen::MatrixXd moves = directions.own(blocks.own[r], Eigen::all);
    const Eigen::MatrixXd of_own = moves.transpose().partialPivLu().solve(changed.transpose()).transpose();
    for (Eigen::Index i = 0; i < owns; ++i) {
      columns.col(blocks.own[r][static_cast<std::size_t>(i)]).setZero();
      columns.col(blocks.own[r][static_cast<std::size_t>(i)]).segment(from, count) = of_own.col(i);
    }
  }
  Eigen::MatrixXd changed(rows, commons);
  for (Eigen::Index i = 0; i < commons; ++i) changed.col(i) = changes[static_cast<std::size_t>(owns + i)];
  for (const std::vector<Eigen::Index>& own : blocks.own) {
    for (const Eigen::Index k : own) changed -= columns.col(k) * directions.common.row(k);
  }
  const Eigen::MatrixXd moves = directions.common(blocks.common, Eigen::all);
  const Eigen::MatrixXd of_common = moves.transpose().partialPivLu().solve(changed.transpose()).transpose();
  for (Eigen::Index i = 0; i < commons; ++i) columns.col(blocks.common[static_cast<std::size_t>(i)]) = of_common.col(i);
}

}  // namespace slewlab::diagnosis
