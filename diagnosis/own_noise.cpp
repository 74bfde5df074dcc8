#include "diagnosis/own_noise.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "diagnosis/noise_response.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastVariance = 1e-3;  // what is rounded away

using BinRows = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostChannels, Eigen::Dynamic>;

// Where a channel's real part stands at a bin among the differences of a record from `first_row` on; the imaginary one follows.
Eigen::Index row_at(const Whitening& whitening, Eigen::Index first_row, Eigen::Index channel, std::size_t bin) {
  return first_row + 2 * (channel * static_cast<Eigen::Index>(whitening.bin_count) + static_cast<Eigen::Index>(bin));
}

// The values of all channels at a bin, one column each.
void take_bin(const Whitening& whitening, const Eigen::MatrixXd& values, Eigen::Index first_row, std::size_t bin, BinRows& rows) {
  const auto channels = static_cast<Eigen::Index>(whitening.channels.size());
  rows.resize(channels, values.cols());
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    for (Eigen::Index c = 0; c < channels; ++c) {
      const Eigen::Index row = row_at(whitening, first_row, c, bin);
      rows(c, column) = {values(row, column), values(row + 1, column)};
    }
  }
}

// The response of one machine for each record in turn; records of one length and grid, with the same sensors, have the same.
class Responses {
 public:
  Responses(const Problem& problem, const Point& point) : problem_(problem), machine_(machine_at(problem.nominal, problem.nuisances, point)) {}
  const NoiseResponse& operator()(std::size_t r) {
    if (!last_ || !is_alike(*last_, r)) {
      const Whitening& whitening = problem_.whitening[r];
      response_ = noise_response(machine_, problem_.records[r], problem_.gains, whitening.transform_length, problem_.force_steps, whitening.smear.size() / 2 + 1);
      last_ = r;
    }
    return response_;
  }

 private:
  bool is_alike(std::size_t a, std::size_t b) const {
    const Record &one = problem_.records[a], &other = problem_.records[b];
    for (std::size_t s = 0; s < kAccelerometerCount; ++s) {
      if (one.acceleration[s].empty() != other.acceleration[s].empty()) return false;
    }
    const Whitening &of_one = problem_.whitening[a], &of_other = problem_.whitening[b];
    return of_one.transform_length == of_other.transform_length && of_one.smear.size() == of_other.smear.size() && grid_of(one) == grid_of(other) &&
           reading_stride(one) == reading_stride(other) && one.group_count == other.group_count && (one.torque_noise > 0.0) == (other.torque_noise > 0.0);
  }

  const Problem& problem_;
  sim::MachineSettings machine_;
  std::optional<std::size_t> last_;
  NoiseResponse response_;
};

// Calls visit(bin, V with m = 1, what is more of it for another m) for every bin of a record.
template <typename Visit>
void each_covariance(const Problem& problem, const NoiseResponse& response, std::size_t r, double discrepancy_count, Visit&& visit) {
  const Whitening& whitening = problem.whitening[r];
  const CommonNoise common(whitening, response);
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    ChannelMatrix noise = common.weighted(whitening, b), more = ChannelMatrix::Zero(noise.rows(), noise.cols());
    for (Eigen::Index c = 0; c < noise.rows(); ++c) {
      const auto channel = static_cast<std::size_t>(c);
      const auto bin = static_cast<Eigen::Index>(b);
      noise(c, c) += whitening.beside[channel](bin);
      more(c, c) = (discrepancy_count - 1.0) * whitening.missed[channel](bin);
    }
    const ChannelMatrix apart = apart_at(whitening, b);
    visit(b, ChannelMatrix(apart * noise * apart.adjoint()), ChannelMatrix(apart * more * apart.adjoint()));
  }
}

// Calls visit(V with m = 1, what is more of it for another m, rows of the values) for every bin of the records, and flanks(rows) for the deviation of the gears' places, which is hardly noise.
template <typename Visit, typename Flanks>
void each_bin(const Problem& problem, const Point& point, const Eigen::MatrixXd& values, double discrepancy_count, Visit&& visit, Flanks&& flanks) {
  Responses response(problem, point);
  Eigen::Index row = 0;
  BinRows rows;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Whitening& whitening = problem.whitening[r];
    each_covariance(problem, response(r), r, discrepancy_count, [&](std::size_t b, const ChannelMatrix& covariance, const ChannelMatrix& more) {
      take_bin(whitening, values, row, b, rows);
      visit(covariance, more, rows);
    });
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

// The values of all channels at a bin, back to where take_bin() found them.
void put_bin(const Whitening& whitening, const BinRows& rows, Eigen::Index first_row, std::size_t bin, Eigen::MatrixXd& values) {
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    for (Eigen::Index c = 0; c < rows.rows(); ++c) {
      const Eigen::Index row = row_at(whitening, first_row, c, bin);
      values(row, column) = rows(c, column).real();
      values(row + 1, column) = rows(c, column).imag();
    }
  }
}

}  // namespace

Eigen::VectorXd divided_by_own_noise(const Problem& problem, const Point& point, const Eigen::VectorXd& difference) {
  Responses response(problem, point);
  Eigen::MatrixXd values = difference;
  Eigen::Index row = 0;
  BinRows rows;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Whitening& whitening = problem.whitening[r];
    each_covariance(problem, response(r), r, 1.0, [&](std::size_t b, const ChannelMatrix& covariance, const ChannelMatrix&) {
      take_bin(whitening, values, row, b, rows);
      divide(covariance, rows);
      put_bin(whitening, rows, row, b, values);
    });
    row += whitening.size();
  }
  return values;
}

double mean_square_of_noise(const Problem& problem, const Point& point) {
  Responses response(problem, point);
  double sum = 0.0, count = 0.0;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    each_covariance(problem, response(r), r, 1.0, [&](std::size_t, const ChannelMatrix& covariance, const ChannelMatrix&) {
      sum += covariance.trace().real();
      count += static_cast<double>(covariance.rows());
    });
  }
  return sum / count;
}

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
  if (!products.allFinite()) return {difference.squaredNorm(), columns.transpose() * columns, columns.transpose() * difference};
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
  return std::isfinite(square) ? square : difference.squaredNorm();
}

}  // namespace slewlab::diagnosis
