#include "diagnosis/chance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace slewlab::diagnosis {

namespace {

// With the power to which its power goes as its first parameter grows: amplitudes squared, a lost share as it is.
struct ByChance {
  std::string_view effect;
  double power;
};
constexpr std::array<ByChance, 3> kByChance{{{"command_jitter", 2.0}, {"command_loss", 1.0}, {"gusts", 2.0}}};

constexpr double kBeside = 0.02;  // share of a force's power that stands beside its direction in each other one: it turns with the crane
constexpr double kSmoothing = 0.2;  // of a frequency, over which S is smoothed either side
constexpr double kBand = 1.26;  // highest by lowest frequency of a third of an octave
constexpr double kNear = 0.2;       // share of what a free power leaves above the noise
constexpr double kNearForForce = 0.3;  // the same where its direction has to fit as well
constexpr double kNearEnoughToLook = 1.0;
constexpr double kLeastFound = 0.1;  // of the noise, below which nothing is above it
constexpr std::size_t kLeastBins = 6;
constexpr double kLowestScale = -9.0, kHighestScale = 9.0;  // ln a: a factor of 90 in size either way
constexpr int kScales = 37;

bool is_within(double share, const ChanceFit& fit, const FreePower& free, Eigen::Index count) {
  return fit.cost - free.cost < share * (free.cost - free.noise + kLeastFound * static_cast<double>(count));
}

// The cost's terms: n ln(1 + a S) + square / (1 + a S), and what does not depend on a.
struct Terms {
  Eigen::ArrayXd power, square, count;  // S, square, n
};

double cost_at(const Terms& terms, double scale) {
  const Eigen::ArrayXd variance = 1.0 + scale * terms.power;
  return (terms.count * variance.log() + terms.square / variance).sum();
}

// Calls see(first row, rows from channel to channel, channels) for every frequency of every record.
template <class See>
void for_each_frequency(const Problem& problem, const See& see) {
  Eigen::Index first = 0;
  for (const Whitening& whitening : problem.whitening) {
    const auto bins = static_cast<Eigen::Index>(whitening.bin_count);
    for (Eigen::Index b = 0; b < bins; ++b) see(first + 2 * b, 2 * bins, static_cast<Eigen::Index>(whitening.channels.size()));
    first += whitening.size();
  }
}

std::complex<double> at(const Eigen::VectorXd& values, Eigen::Index row) { return {values(row), values(row + 1)}; }

// h* d at one frequency.
std::complex<double> along(const Eigen::VectorXd& direction, const Eigen::VectorXd& values, Eigen::Index row, Eigen::Index stride,
                           Eigen::Index channels) {
  std::complex<double> sum = 0.0;
  for (Eigen::Index c = 0; c < channels; ++c) sum += std::conj(at(direction, row + c * stride)) * at(values, row + c * stride);
  return sum;
}

Terms terms_of(const Problem& problem, const Eigen::VectorXd& difference, const ChanceProfile& profile) {
  if (profile.direction.size() == 0) {
    return {profile.power.array(), difference.array().square(), Eigen::ArrayXd::Ones(difference.size())};
  }
  std::vector<double> power, square, count;
  for_each_frequency(problem, [&](Eigen::Index row, Eigen::Index stride, Eigen::Index channels) {
    double whole = 0.0;
    for (Eigen::Index c = 0; c < channels; ++c) whole += std::norm(at(difference, row + c * stride));
    const double part = std::norm(along(profile.direction, difference, row, stride, channels));
    power.insert(power.end(), {profile.power(row), kBeside * profile.power(row)});
    square.insert(square.end(), {part, whole - part});
    count.insert(count.end(), {2.0, 2.0 * static_cast<double>(channels - 1)});
  });
  const auto mapped = [](const std::vector<double>& values) {
    return Eigen::ArrayXd(Eigen::Map<const Eigen::ArrayXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  return {mapped(power), mapped(square), mapped(count)};
}

// Of one channel's powers, over kSmoothing of the frequency either side.
void smooth(const Whitening& whitening, std::span<const double> power, Eigen::VectorXd& profile, Eigen::Index first_row) {
  std::vector<double> sum(power.size() + 1, 0.0);
  for (std::size_t b = 0; b < power.size(); ++b) sum[b + 1] = sum[b] + power[b];
  for (std::size_t b = 0; b < power.size(); ++b) {
    const auto half = std::max(kLeastBins, static_cast<std::size_t>(kSmoothing * static_cast<double>(whitening.first_bin + b)));
    const std::size_t low = b > half ? b - half : 0, high = std::min(power.size(), b + half + 1);
    const Eigen::Index row = first_row + static_cast<Eigen::Index>(2 * b);
    profile(row) = profile(row + 1) = (sum[high] - sum[low]) / static_cast<double>(high - low);
  }
}

}  // namespace

bool comes_by_chance(std::string_view effect) {
  return std::any_of(kByChance.begin(), kByChance.end(), [&](const ByChance& one) { return one.effect == effect; });
}

bool is_one_force(std::string_view effect) { return effect == "gusts"; }

bool is_mean_of_chance(std::string_view effect) { return effect == "command_delay" || effect == "dead_time" || effect == "torque_lag"; }

ChanceProfile power_profile(const Problem& problem, std::span<const Eigen::VectorXd> changes) {
  ChanceProfile profile{Eigen::VectorXd(changes.front().size()), {}};
  std::vector<double> power;
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    const auto bins = static_cast<Eigen::Index>(whitening.bin_count);
    for (std::size_t c = 0; c < whitening.channels.size(); ++c, row += 2 * bins) {
      power.assign(whitening.bin_count, 0.0);
      for (const Eigen::VectorXd& change : changes) {
        for (Eigen::Index b = 0; b < bins; ++b) {
          power[static_cast<std::size_t>(b)] += 0.5 * std::norm(at(change, row + 2 * b)) / static_cast<double>(changes.size());
        }
      }
      smooth(whitening, power, profile.power, row);
    }
  }
  return profile;
}

ChanceProfile force_profile(const Problem& problem, std::span<const Eigen::VectorXd> changes) {
  const Eigen::Index size = changes.front().size();
  ChanceProfile profile{Eigen::VectorXd(size), Eigen::VectorXd(size)};
  std::vector<double> power;
  for_each_frequency(problem, [&](Eigen::Index row, Eigen::Index stride, Eigen::Index channels) {
    Eigen::MatrixXcd products = Eigen::MatrixXcd::Zero(channels, channels);
    Eigen::VectorXcd drawn(channels);
    for (const Eigen::VectorXd& change : changes) {
      for (Eigen::Index c = 0; c < channels; ++c) drawn(c) = at(change, row + c * stride);
      products += drawn * drawn.adjoint() / static_cast<double>(changes.size());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(products);
    const Eigen::VectorXcd along_it = solver.eigenvectors().col(channels - 1);
    for (Eigen::Index c = 0; c < channels; ++c) {
      profile.direction(row + c * stride) = along_it(c).real();
      profile.direction(row + c * stride + 1) = along_it(c).imag();
    }
    power.push_back(0.5 * std::max(0.0, solver.eigenvalues()(channels - 1)));
  });
  Eigen::Index first = 0;
  std::size_t from = 0;
  for (const Whitening& whitening : problem.whitening) {
    const auto stride = static_cast<Eigen::Index>(2 * whitening.bin_count);
    smooth(whitening, std::span(power).subspan(from, whitening.bin_count), profile.power, first);
    for (std::size_t c = 1; c < whitening.channels.size(); ++c) {
      profile.power.segment(first + static_cast<Eigen::Index>(c) * stride, stride) = profile.power.segment(first, stride);
    }
    first += whitening.size();
    from += whitening.bin_count;
  }
  return profile;
}

ChanceFit fit_chance(const Problem& problem, const Eigen::VectorXd& difference, const ChanceProfile& profile) {
  ChanceFit best{0.0, difference.squaredNorm()};
  if (!profile.power.allFinite() || !profile.direction.allFinite()) return best;
  const Terms terms = terms_of(problem, difference, profile);
  const double step = (kHighestScale - kLowestScale) / (kScales - 1);
  const auto consider = [&](double logarithm) {
    const double scale = std::exp(logarithm);
    const double cost = cost_at(terms, scale);
    if (cost < best.cost) best = {scale, cost};
  };
  for (int i = 0; i < kScales; ++i) consider(kLowestScale + step * i);
  if (best.scale > 0.0) {
    for (double width = 0.5 * step; width > 0.01; width *= 0.5) {
      const double middle = std::log(best.scale);
      consider(middle - width);
      consider(middle + width);
    }
  }
  return best;
}

double logarithms(const Problem& problem, const Chance& chance) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(chance.profile.power.size());
  return cost_at(terms_of(problem, none, chance.profile), chance.scale);
}

Eigen::VectorXd divided(const Problem& problem, const Chance& chance, const Eigen::VectorXd& values) {
  const ChanceProfile& profile = chance.profile;
  if (profile.direction.size() == 0) return (values.array() / (1.0 + chance.scale * profile.power.array()).sqrt()).matrix();
  Eigen::VectorXd result = values;
  for_each_frequency(problem, [&](Eigen::Index row, Eigen::Index stride, Eigen::Index channels) {
    const double power = chance.scale * profile.power(row), beside = 1.0 / std::sqrt(1.0 + kBeside * power);
    const std::complex<double> part =
        along(profile.direction, values, row, stride, channels) * (1.0 / std::sqrt(1.0 + power) - beside);
    for (Eigen::Index c = 0; c < channels; ++c) {
      const std::complex<double> value = beside * at(values, row + c * stride) + at(profile.direction, row + c * stride) * part;
      result(row + c * stride) = value.real();
      result(row + c * stride + 1) = value.imag();
    }
  });
  return result;
}

FreePower free_power(const Problem& problem, const Eigen::VectorXd& difference) {
  FreePower free;
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
      std::size_t b = 0;
      while (b < whitening.bin_count) {
        const auto last = static_cast<std::size_t>(kBand * static_cast<double>(whitening.first_bin + b));
        const std::size_t end = std::min(whitening.bin_count, std::max(b + 1, last - whitening.first_bin));
        const auto size = static_cast<Eigen::Index>(2 * (end - b));
        const double power = difference.segment(row, size).squaredNorm() / static_cast<double>(size);
        free.cost += static_cast<double>(size) * (power > 1.0 ? 1.0 + std::log(power) : power);
        free.noise += static_cast<double>(size) * std::min(1.0, power);
        row += size;
        b = end;
      }
    }
  }
  return free;
}

bool is_near_free_power(const ChanceFit& fit, const FreePower& free, Eigen::Index count, bool is_force) {
  return is_within(is_force ? kNearForForce : kNear, fit, free, count);
}

bool is_worth_a_look(const ChanceFit& fit, const FreePower& free, Eigen::Index count) {
  return is_within(kNearEnoughToLook, fit, free, count);
}

common::EffectInstance with_power(common::EffectInstance effect, double scale) {
  const common::EffectParameter& size = about_effect(effect.name).parameters.front();
  const auto* const law =
      std::find_if(kByChance.begin(), kByChance.end(), [&](const ByChance& one) { return one.effect == effect.name; });
  effect.values[0] = std::clamp(effect.values[0] * std::pow(scale, 1.0 / law->power), size.lower, size.upper);
  return effect;
}

}  // namespace slewlab::diagnosis
