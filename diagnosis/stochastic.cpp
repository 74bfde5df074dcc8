#include "diagnosis/stochastic.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

namespace slewlab::diagnosis {

namespace {

constexpr double kSmoothing = 0.2;  // of a frequency, over which S is smoothed either side
constexpr double kBand = 1.26;  // highest by lowest frequency of a third of an octave
constexpr double kLeastFound = 0.1;  // of the noise, below which nothing is above it
constexpr std::size_t kLeastBins = 6;
// Either side, that an axis is taken from: a draw's force has not all frequencies. Without the bin itself: along axes that follow what its draws happened to be, one would have too
// much of their power and the others too little.
constexpr Eigen::Index kNearestBins = 2;
constexpr double kLowestScale = -9.0, kHighestScale = 9.0;  // ln a: a factor of 90 in size either way
constexpr int kScales = 37;
constexpr std::uint64_t kDraws = 6;    // whose mean and power stand for all
constexpr double kFarthestScale = 4.0;  // [deviations] of a scale that is known from elsewhere
constexpr int kPredictedScales = 20;   // either side

using BinValues = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::ColMajor, kMostChannels, 1>;

Eigen::Map<ChannelMatrix> axes_at(ChannelAxes& record, Eigen::Index bin) {
  return {record.axes.data() + bin * record.channels * record.channels, record.channels, record.channels};
}
Eigen::Map<const ChannelMatrix> axes_at(const ChannelAxes& record, Eigen::Index bin) {
  return {record.axes.data() + bin * record.channels * record.channels, record.channels, record.channels};
}

// Where a channel's, or an axis's, real part of a bin stands among a record's differences; the imaginary part follows.
Eigen::Index row_of(const ChannelAxes& record, Eigen::Index channel, Eigen::Index bin) {
  return record.first_row + 2 * (channel * record.bins + bin);
}

// A record's bin across its channels.
BinValues across(const Eigen::VectorXd& values, const ChannelAxes& record, Eigen::Index bin) {
  BinValues result(record.channels);
  for (Eigen::Index c = 0; c < record.channels; ++c) {
    const Eigen::Index row = row_of(record, c, bin);
    result(c) = {values(row), values(row + 1)};
  }
  return result;
}

// Each bin turned, from channels to axes or back.
template <class Turn>
Eigen::VectorXd turned(const std::vector<ChannelAxes>& records, Eigen::VectorXd values, Turn turn) {
  for (const ChannelAxes& record : records) {
    for (Eigen::Index bin = 0; bin < record.bins; ++bin) {
      const BinValues result = turn(axes_at(record, bin), across(values, record, bin));
      for (Eigen::Index c = 0; c < record.channels; ++c) {
        const Eigen::Index row = row_of(record, c, bin);
        values(row) = result(c).real();
        values(row + 1) = result(c).imag();
      }
    }
  }
  return values;
}

Eigen::VectorXd along_channels(const std::vector<ChannelAxes>& records, Eigen::VectorXd values) {
  return turned(records, std::move(values), [](const auto& axes, const BinValues& bin) -> BinValues { return axes * bin; });
}

Eigen::ArrayXd variance_of(const Eigen::VectorXd& profile, double scale) { return 1.0 + scale * profile.array(); }

// Of a variance. Where real and imaginary part of every bin share theirs, each logarithm is taken once: they take most of the time of a fit.
Eigen::ArrayXd logarithms_of(const Eigen::ArrayXd& variance) {
  const Eigen::Index bins = variance.size() / 2;
  const auto is_shared = [&] {
    for (Eigen::Index b = 0; b < bins; ++b) {
      if (variance(2 * b) != variance(2 * b + 1)) return false;
    }
    return variance.size() % 2 == 0;
  };
  if (!is_shared()) return variance.log();
  // To an even number: no logarithm is taken alone, which may round otherwise than one among others.
  Eigen::ArrayXd of_bins = Eigen::ArrayXd::Ones(bins + bins % 2);
  for (Eigen::Index b = 0; b < bins; ++b) of_bins(b) = variance(2 * b);
  of_bins = of_bins.log().eval();
  Eigen::ArrayXd result(variance.size());
  for (Eigen::Index b = 0; b < bins; ++b) result(2 * b) = result(2 * b + 1) = of_bins(b);
  return result;
}

double cost_at(const Eigen::VectorXd& difference, const Eigen::ArrayXd& variance, const Eigen::ArrayXd& logarithms) {
  return (logarithms + difference.array().square() / variance).sum();
}

// ln a of the scales that are tried first.
constexpr double kStride = (kHighestScale - kLowestScale) / (kScales - 1);
constexpr int kHalvings = 5;  // of it about the least that was found: to 0.016
double scale_tried(int i) { return kLowestScale + kStride * i; }

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

bool is_stochastic(const common::EffectAbout& effect) { return effect.stochastic.has_value(); }

bool is_stochastic(const common::EffectCatalogue& catalogue, std::string_view effect) {
  const common::EffectAbout* const about = catalogue.find(effect);
  return about != nullptr && is_stochastic(*about);
}

bool is_stochastic_delay(const common::EffectAbout& effect) { return effect.stochastic && effect.acts_late; }

bool is_steady_delay(const common::EffectAbout& effect) { return !effect.stochastic && effect.acts_late; }

std::vector<ChannelAxes> axes_of(const Problem& problem, std::span<const Eigen::VectorXd> changes) {
  std::vector<ChannelAxes> records;
  Eigen::Index first_row = 0;
  for (const Whitening& whitening : problem.whitening) {
    const std::size_t channels = whitening.channels.size();
    ChannelAxes record{first_row, static_cast<Eigen::Index>(channels), static_cast<Eigen::Index>(whitening.bin_count),
                       std::vector<std::complex<double>>(channels * channels * whitening.bin_count)};
    for (const Eigen::VectorXd& change : changes) {
      for (Eigen::Index bin = 0; bin < record.bins; ++bin) {
        const BinValues values = across(change, record, bin);
        const ChannelMatrix product = values * values.adjoint();
        const Eigen::Index end = std::min(record.bins, bin + kNearestBins + 1);
        for (Eigen::Index near = std::max<Eigen::Index>(0, bin - kNearestBins); near < end; ++near) {
          if (near != bin) axes_at(record, near) += product;
        }
      }
    }
    for (Eigen::Index bin = 0; bin < record.bins; ++bin) {
      const ChannelMatrix product = axes_at(record, bin);
      axes_at(record, bin) = Eigen::SelfAdjointEigenSolver<ChannelMatrix>(product).eigenvectors();
    }
    first_row += whitening.size();
    records.push_back(std::move(record));
  }
  return records;
}

Eigen::VectorXd along_axes(const std::vector<ChannelAxes>& records, Eigen::VectorXd values) {
  return turned(records, std::move(values), [](const auto& axes, const BinValues& bin) -> BinValues { return axes.adjoint() * bin; });
}

Power power_of(const Problem& problem, std::span<const Eigen::VectorXd> changes) {
  Power result{Eigen::VectorXd::Zero(changes.front().size()), axes_of(problem, changes)};
  std::vector<Eigen::VectorXd> along;
  for (const Eigen::VectorXd& change : changes) along.push_back(along_axes(result.records, change));
  std::vector<double> power;
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    const auto bins = static_cast<Eigen::Index>(whitening.bin_count);
    for (std::size_t c = 0; c < whitening.channels.size(); ++c, row += 2 * bins) {
      power.assign(whitening.bin_count, 0.0);
      for (const Eigen::VectorXd& change : along) {
        for (Eigen::Index b = 0; b < bins; ++b) {
          power[static_cast<std::size_t>(b)] += 0.5 * change.segment<2>(row + 2 * b).squaredNorm() / static_cast<double>(changes.size());
        }
      }
      smooth(whitening, power, result.profile, row);
    }
    // Of the gears' places one power for all: a few parts of a record tell no more.
    const Eigen::Index flanks = whitening.flanks_size();
    double square = 0.0;
    for (const Eigen::VectorXd& change : changes) square += change.segment(row, flanks).squaredNorm();
    if (flanks > 0) result.profile.segment(row, flanks).setConstant(square / static_cast<double>(flanks * static_cast<Eigen::Index>(changes.size())));
    row += flanks;
  }
  return result;
}

PowerScales::PowerScales(const Power& power) : power_(power) {
  if (!power.profile.allFinite()) return;
  for (int i = 0; i < kScales; ++i) logarithms_.push_back(logarithms_of(variance_of(power.profile, std::exp(scale_tried(i)))));
}

PowerFit PowerScales::fit(const Eigen::VectorXd& difference) const {
  PowerFit best{0.0, difference.squaredNorm()};
  if (logarithms_.empty()) return best;
  const Eigen::VectorXd along = along_axes(power_.records, difference);
  const auto consider = [&](double logarithm, const Eigen::ArrayXd* known) {
    const double scale = std::exp(logarithm);
    const Eigen::ArrayXd variance = variance_of(power_.profile, scale);
    const double cost = known != nullptr ? cost_at(along, variance, *known) : cost_at(along, variance, logarithms_of(variance));
    if (cost < best.cost) best = {scale, cost};
  };
  for (int i = 0; i < kScales; ++i) consider(scale_tried(i), &logarithms_[static_cast<std::size_t>(i)]);
  if (best.scale > 0.0) {
    for (int halving = 1; halving <= kHalvings; ++halving) {
      const double width = std::ldexp(kStride, -halving);
      const double middle = std::log(best.scale);
      consider(middle - width, nullptr);
      consider(middle + width, nullptr);
    }
  }
  return best;
}

PowerFit power_at(const Eigen::VectorXd& difference, const Power& power, double scale) {
  const Eigen::ArrayXd variance = variance_of(power.profile, scale);
  return {scale, cost_at(along_axes(power.records, difference), variance, logarithms_of(variance))};
}

Drawn draw(Problem& problem, const Point& point) {
  std::vector<Point> points(kDraws, point);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].seed = i + 1;
  std::vector<Eigen::VectorXd> all = differences(problem, points);
  Drawn drawn{Eigen::VectorXd::Zero(all.front().size()), {}};
  for (const Eigen::VectorXd& one : all) drawn.mean += one / static_cast<double>(kDraws);
  // About a mean of their own, draws stand off too little; the mean itself by the share of one draw.
  const double count = static_cast<double>(kDraws);
  for (Eigen::VectorXd& one : all) one = (one - drawn.mean) * std::sqrt((count + 1.0) / (count - 1.0));
  drawn.power = power_of(problem, all);
  return drawn;
}

double predictive_cost(const Eigen::VectorXd& difference, const Power& power, double deviation) {
  const Eigen::VectorXd along = along_axes(power.records, difference);
  double best = std::numeric_limits<double>::infinity();
  for (int i = -kPredictedScales; i <= kPredictedScales; ++i) {
    const double off = kFarthestScale * static_cast<double>(i) / kPredictedScales;  // [deviations]
    const Eigen::ArrayXd variance = variance_of(power.profile, std::exp(off * deviation));
    best = std::min(best, cost_at(along, variance, logarithms_of(variance)) + off * off);
  }
  return best;
}

Power unknown_power(const Problem& seen, const std::vector<ChannelAxes>& seen_axes, const Eigen::VectorXd& difference, const Problem& unseen,
                    std::vector<ChannelAxes> unseen_axes) {
  using Key = std::tuple<bool, int, int>;  // channel, or place of the axis, and band
  constexpr Key kOfFlanks{true, -1, 0};    // of the gears' places
  const bool has_axes = !seen_axes.empty();
  const auto each_bin = [&](const Problem& problem, const auto& visit) {
    Eigen::Index row = 0;
    for (const Whitening& whitening : problem.whitening) {
      for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
        const Channel channel = has_axes ? Channel{false, static_cast<int>(c)} : whitening.channels[c];
        for (std::size_t b = 0; b < whitening.bin_count; ++b, row += 2) {
          const double frequency = whitening.bin_width * static_cast<double>(whitening.first_bin + b);
          visit(Key{channel.is_torque, channel.index, static_cast<int>(std::floor(std::log(frequency) / std::log(kBand)))}, row);
        }
      }
      const Eigen::Index end = row + whitening.flanks_size();
      for (; row < end; row += 2) visit(kOfFlanks, row);
    }
  };
  struct Sum {
    double square = 0.0, count = 0.0;
  };
  std::map<Key, Sum> sums;
  const Eigen::VectorXd along = along_axes(seen_axes, difference);
  each_bin(seen, [&](const Key& key, Eigen::Index row) {
    Sum& sum = sums[key];
    sum.square += along.segment<2>(row).squaredNorm();
    sum.count += 2.0;
  });
  Power power{Eigen::VectorXd::Zero(difference_count(unseen)), std::move(unseen_axes)};
  each_bin(unseen, [&](const Key& key, Eigen::Index row) {
    const auto sum = sums.find(key);
    if (sum != sums.end()) power.profile.segment<2>(row).setConstant(std::max(0.0, sum->second.square / sum->second.count - 1.0));
  });
  return power;
}

PowerFit fit_power(const Eigen::VectorXd& difference, const Power& power) { return PowerScales(power).fit(difference); }

double logarithms(const AddedPower& added) { return variance_of(added.power.profile, added.scale).log().sum(); }

Eigen::VectorXd divided(const AddedPower& added, const Eigen::VectorXd& values) {
  const std::vector<ChannelAxes>& records = added.power.records;
  const Eigen::ArrayXd deviation = variance_of(added.power.profile, added.scale).sqrt();
  return along_channels(records, along_axes(records, values).cwiseQuotient(deviation.matrix()));
}

Eigen::VectorXd undivided(const AddedPower& added, const Eigen::VectorXd& values) {
  const std::vector<ChannelAxes>& records = added.power.records;
  const Eigen::ArrayXd deviation = variance_of(added.power.profile, added.scale).sqrt();
  return along_channels(records, along_axes(records, values).cwiseProduct(deviation.matrix()));
}

FreePower free_power(const Problem& problem, const Eigen::VectorXd& difference) {
  FreePower free;
  const auto add_free = [&](const auto& together) {
    if (together.size() == 0) return;
    const double size = static_cast<double>(together.size()), power = together.squaredNorm() / size;
    free.cost += size * (power > 1.0 ? 1.0 + std::log(power) : power);
    free.noise += size * std::min(1.0, power);
    if (power > 1.0) free.chance += 1.0 / problem.settings.independent_share;  // of one free number among so many independent ones
  };
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
      std::size_t b = 0;
      while (b < whitening.bin_count) {
        const auto last = static_cast<std::size_t>(kBand * static_cast<double>(whitening.first_bin + b));
        const std::size_t end = std::min(whitening.bin_count, std::max(b + 1, last - whitening.first_bin));
        const auto size = static_cast<Eigen::Index>(2 * (end - b));
        add_free(difference.segment(row, size));
        row += size;
        b = end;
      }
    }
    add_free(difference.segment(row, whitening.flanks_size()));
    row += whitening.flanks_size();
  }
  return free;
}

double above_free_power(const PowerFit& fit, const FreePower& free, Eigen::Index count) {
  return (fit.cost - free.cost - free.chance) / (free.cost - free.noise + kLeastFound * static_cast<double>(count));
}

double largest_scale(const common::EffectAbout& about, const common::EffectInstance& effect) {
  return std::pow(about.parameters[common::kSize].upper / effect.values[common::kSize], about.stochastic->power_exponent);
}

common::EffectInstance with_power(const common::EffectAbout& about, common::EffectInstance effect, double scale) {
  const common::EffectParameter& bounds = about.parameters[common::kSize];
  double& size = effect.values[common::kSize];
  size = std::clamp(size * std::pow(scale, 1.0 / about.stochastic->power_exponent), bounds.lower, bounds.upper);
  return effect;
}

}  // namespace slewlab::diagnosis
