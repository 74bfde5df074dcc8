// Directions along which the difference quotients of a fit's columns are taken: the axes of the curvature H of its cost,
//
//   v_i^T H v_j = 0 for i != j,  v_i^T H v_i = h^2,
//
// so that each of them changes the cost by as little as the others: h standard deviations of what the records leave open along it. A coordinate alone,
// moved by what the records leave open of it, leaves a narrow valley, and its quotient is that of the valley's wall.
//
// What belongs to one record alone (its beginning) changes no other one, so the directions are of two kinds, and one simulation of all records serves a
// direction of each: within a record's own coordinates, by the axes of that block D_r of H; and of the coordinates that all records share, by the axes
// of what is left of theirs when each record's own go along (Schur complement A - sum(B_r D_r^-1 B_r^T), with -D_r^-1 B_r^T v as what goes along).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace slewlab::diagnosis {

// Which coordinates belong together.
struct CoordinateBlocks {
  std::vector<Eigen::Index> common;            // of all records
  std::vector<std::vector<Eigen::Index>> own;  // of each record, as many of each
};

// Each column is a change of all coordinates: first one for each of the records' own, of all records together, then one for each common coordinate.
// No coordinate changes by more than `longest` has.
struct ColumnDirections {
  Eigen::MatrixXd own, common;
};
ColumnDirections column_directions(const Eigen::MatrixXd& curvature, const CoordinateBlocks& blocks, const Eigen::VectorXd& longest, double deviations);

// The columns d difference / d coordinate of the blocks' coordinates, from what the differences changed by along the directions, own first.
// `first_row`: where each record's differences begin, and where the last ones end. Other columns stay as they are.
void columns_along(const ColumnDirections& directions, const CoordinateBlocks& blocks, std::span<const Eigen::VectorXd> changes, std::span<const Eigen::Index> first_row, Eigen::MatrixXd& columns);

}  // namespace slewlab::diagnosis
