#include "diagnosis/own_noise.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

#include "diagnosis/noise_response.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastVariance = 1e-3;  // what is rounded away

using BinRows = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostChannels, Eigen::Dynamic>;

// The values of all channels at a bin, one column each.
void take_bin(const Whitening& whitening, const Eigen::MatrixXd& values, Eigen::Index first_row, std::size_t bin, BinRows& rows) {
  const auto channels = static_cast<Eigen::Index>(whitening.channels.size());
  rows.resize(channels, values.cols());
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    for (Eigen::Index c = 0; c < channels; ++c) {
      const Eigen::Index row = first_row + 2 * (c * static_cast<Eigen::Index>(whitening.bin_count) + static_cast<Eigen::Index>(bin));
      rows(c, column) = {values(row, column), values(row + 1, column)};
    }
  }
}

// Calls visit(V with m = 1, what is more of it for another m, rows of the values) for every bin of the records, and flanks(rows) for the deviation of the gears' places, which is hardly noise.
template <typename Visit, typename Flanks>
void each_bin(const Problem& problem, const Point& point, const Eigen::MatrixXd& values, double discrepancy_count, Visit&& visit, Flanks&& flanks) {
  const sim::MachineSettings machine = machine_at(problem.nominal, problem.nuisances, point);
  Eigen::Index row = 0;
  BinRows rows;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Whitening& whitening = problem.whitening[r];
    const CommonNoise common(whitening, noise_response(machine, problem.records[r], problem.gains, whitening.transform_length, problem.force_steps, whitening.smear.size() / 2 + 1));
    for (std::size_t b = 0; b < whitening.bin_count; ++b) {
      ChannelMatrix noise = common.weighted(whitening, b), more = ChannelMatrix::Zero(noise.rows(), noise.cols());
      for (Eigen::Index c = 0; c < noise.rows(); ++c) {
        const auto channel = static_cast<std::size_t>(c);
        const auto bin = static_cast<Eigen::Index>(b);
        noise(c, c) += whitening.beside[channel](bin);
        more(c, c) = (discrepancy_count - 1.0) * whitening.missed[channel](bin);
      }
      const ChannelMatrix apart = apart_at(whitening, b);
      take_bin(whitening, values, row, b, rows);
      visit(ChannelMatrix(apart * noise * apart.adjoint()), ChannelMatrix(apart * more * apart.adjoint()), rows);
    }
    row += whitening.spectra_size();
    flanks(values.middleRows(row, whitening.flanks_size()));
    row += whitening.flanks_size();
  }
}

// K^-1 of the rows, K K* the covariance; where that was rounded away, as they are.
void divide(const ChannelMatrix& covariance, BinRows& rows) {
  const Eigen::LLT<ChannelMatrix> root(covariance);
  if (root.info() == Eigen::Success) root.matrixL().solveInPlace(rows);
}

}  // namespace

ByOwnNoise by_own_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns, double discrepancy_count) {
  Eigen::MatrixXd values(difference.size(), columns.cols() + 1);
  if (columns.cols() > 0) values.leftCols(columns.cols()) = columns;
  values.rightCols(1) = difference;
  // Of real numbers, a complex one being two.
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(values.cols(), values.cols());
  each_bin(
      problem, point, values, discrepancy_count,
      [&](const ChannelMatrix& covariance, const ChannelMatrix& more, BinRows& rows) {
        divide(covariance + more, rows);
        products += rows.real().transpose() * rows.real() + rows.imag().transpose() * rows.imag();
      },
      [&](const auto& rows) { products += rows.transpose() * rows; });
  return {products(columns.cols(), columns.cols()), products.topLeftCorner(columns.cols(), columns.cols()), products.topRightCorner(columns.cols(), 1)};
}

double square_by_less_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference, double discrepancy_count) {
  double square = 0.0;
  each_bin(
      problem, point, difference, discrepancy_count,
      [&](const ChannelMatrix& covariance, const ChannelMatrix& more, BinRows& rows) {
        const Eigen::SelfAdjointEigenSolver<ChannelMatrix> axes(covariance);
        const Eigen::VectorXd less = axes.eigenvalues().array().min(1.0).max(kLeastVariance).matrix();
        divide(axes.eigenvectors() * less.asDiagonal() * axes.eigenvectors().adjoint() + more, rows);
        square += rows.squaredNorm();
      },
      [&](const auto& rows) { square += rows.squaredNorm(); });
  return square;
}

}  // namespace slewlab::diagnosis
