#include "diagnosis/chance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace slewlab::diagnosis {

namespace {

// With the power to which its power goes as its first parameter grows: amplitudes squared, a lost share as it is.
struct ByChance {
  std::string_view effect;
  double power;
};
constexpr std::array<ByChance, 2> kByChance{{{"command_jitter", 2.0}, {"command_loss", 1.0}}};

constexpr double kSmoothing = 0.2;  // of a frequency, over which S is smoothed either side
constexpr double kBand = 1.26;  // highest by lowest frequency of a third of an octave
constexpr double kLeastFound = 0.1;  // of the noise, below which nothing is above it
constexpr std::size_t kLeastBins = 6;
constexpr double kLowestScale = -9.0, kHighestScale = 9.0;  // ln a: a factor of 90 in size either way
constexpr int kScales = 37;

double cost_at(const Eigen::VectorXd& difference, const Eigen::VectorXd& profile, double scale) {
  const Eigen::ArrayXd variance = 1.0 + scale * profile.array();
  return (variance.log() + difference.array().square() / variance).sum();
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

bool is_mean_of_chance(std::string_view effect) {
  return effect == "command_delay" || effect == "dead_time" || effect == "torque_lag" || effect == "encoder_delay";
}

Eigen::VectorXd power_profile(const Problem& problem, std::span<const Eigen::VectorXd> changes) {
  Eigen::VectorXd profile(changes.front().size());
  std::vector<double> power;
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    const auto bins = static_cast<Eigen::Index>(whitening.bin_count);
    for (std::size_t c = 0; c < whitening.channels.size(); ++c, row += 2 * bins) {
      power.assign(whitening.bin_count, 0.0);
      for (const Eigen::VectorXd& change : changes) {
        for (Eigen::Index b = 0; b < bins; ++b) {
          power[static_cast<std::size_t>(b)] += 0.5 * change.segment<2>(row + 2 * b).squaredNorm() / static_cast<double>(changes.size());
        }
      }
      smooth(whitening, power, profile, row);
    }
  }
  return profile;
}

ChanceFit fit_chance(const Eigen::VectorXd& difference, const Eigen::VectorXd& profile) {
  ChanceFit best{0.0, difference.squaredNorm()};
  if (!profile.allFinite()) return best;
  const double step = (kHighestScale - kLowestScale) / (kScales - 1);
  const auto consider = [&](double logarithm) {
    const double scale = std::exp(logarithm);
    const double cost = cost_at(difference, profile, scale);
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

double logarithms(const Chance& chance) { return (1.0 + chance.scale * chance.profile.array()).log().sum(); }

Eigen::VectorXd divided(const Chance& chance, const Eigen::VectorXd& values) {
  return (values.array() / (1.0 + chance.scale * chance.profile.array()).sqrt()).matrix();
}

Eigen::VectorXd undivided(const Chance& chance, const Eigen::VectorXd& values) {
  return (values.array() * (1.0 + chance.scale * chance.profile.array()).sqrt()).matrix();
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

double above_free_power(const ChanceFit& fit, const FreePower& free, Eigen::Index count) {
  return (fit.cost - free.cost) / (free.cost - free.noise + kLeastFound * static_cast<double>(count));
}

common::EffectInstance with_power(common::EffectInstance effect, double scale) {
  const common::EffectParameter& size = about_effect(effect.name).parameters.front();
  const auto* const law =
      std::find_if(kByChance.begin(), kByChance.end(), [&](const ByChance& one) { return one.effect == effect.name; });
  effect.values[0] = std::clamp(effect.values[0] * std::pow(scale, 1.0 / law->power), size.lower, size.upper);
  return effect;
}

}  // namespace slewlab::diagnosis
