#include "diagnosis/whitening.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "diagnosis/sensor_noise.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeastNoise = 0.02;   // of the noise that counts may make
constexpr std::size_t kCornerBins = 40;  // at least, from whose mean power a corner is told
constexpr double kCornerDeviations = 2.0;  // above that, or the least of several would be too low
// Of 1/f where differences of sixth order, the least that sensor_noise() takes, see noise, times the highest frequency: the mean of pi / w under
// sin(w / 2)^12.
constexpr double kRiseInDifferences = 1.186;
constexpr double kLeastWhite = 0.1;  // of what the differences show; chosen
constexpr double kTellsARise = 3.0;  // times as much as there 1/f must be in a band, before it tells of a rise; chosen
constexpr std::size_t kCountBins = 8;    // either side, over which the power of the counting error is smoothed
constexpr int kCountPlaces = 4;          // between two counts, at which a motion may have begun
constexpr double kLeastBeside = 0.01;  // of a channel's variance, that no other channel tells; chosen, above what the window smears
constexpr double kTaper = 0.02;  // share of the record over which the window rises and falls

// Many series of one record, one after the other.
class Transform {
 public:
  explicit Transform(const Whitening& whitening) : window_(whitening.window), padded_(whitening.transform_length, 0.0) {
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  }
  // One value per grid point. Valid until the next call.
  const std::vector<std::complex<double>>& operator()(const std::vector<double>& values) {
    for (std::size_t n = 0; n < values.size(); ++n) padded_[n] = values[n] * window_[n];
    fft_.fwd(spectrum_, padded_);
    return spectrum_;
  }

 private:
  const std::vector<double>& window_;
  Eigen::FFT<double> fft_;
  std::vector<double> padded_;
  std::vector<std::complex<double>> spectrum_;
};

// Under the window. An accelerometer's own offset says nothing of the crane, and would leak into the lowest frequencies.
double mean_under(const Whitening& whitening, const std::vector<double>& values) {
  double sum = 0.0;
  for (std::size_t n = 0; n < values.size(); ++n) sum += whitening.window[n] * values[n];
  return whitening.window_sum > 0.0 ? sum / whitening.window_sum : 0.0;
}

double window_energy(const std::vector<double>& window) {
  double energy = 0.0;
  for (const double w : window) energy += w * w;
  return energy;
}

// What a series would be off by if it were rounded to a quantum as its smooth course is: its running mean, so that its place between two counts is any; `place` [counts] is added to it.
std::vector<double> rounding_error(const std::vector<double>& rounded, double quantum, double place, std::ptrdiff_t half) {
  const auto count = static_cast<std::ptrdiff_t>(rounded.size());
  std::vector<double> running(rounded.size() + 1, 0.0), error(rounded.size());
  for (std::size_t n = 0; n < rounded.size(); ++n) running[n + 1] = running[n] + rounded[n];
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const std::ptrdiff_t low = std::max<std::ptrdiff_t>(0, n - half), high = std::min(count, n + half + 1);
    const double course = (running[static_cast<std::size_t>(high)] - running[static_cast<std::size_t>(low)]) / (static_cast<double>(high - low) * quantum) + place;
    error[static_cast<std::size_t>(n)] = quantum * (std::floor(course) + 0.5 - course);
  }
  return error;
}

// Power of that error, where steps are so coarse that it is not white: what is slow stays between two counts for long. What only its changes say (`from_start`) is off by none at first.
std::vector<double> rounding_error_power(const std::vector<double>& rounded, double quantum, bool from_start, const Record& record, const Whitening& whitening, double smoothing) {
  std::vector<double> power(whitening.transform_length / 2 + 1, 0.0);
  Transform transform(whitening);
  for (int part = 0; part < kCountPlaces; ++part) {
    std::vector<double> error = rounding_error(rounded, quantum, (part + 0.5) / kCountPlaces, static_cast<std::ptrdiff_t>(smoothing / record.step));
    const double start = from_start ? error[0] : 0.0;
    for (double& e : error) e -= start;
    const auto& spectrum = transform(error);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::norm(spectrum[k]) / kCountPlaces;
  }
  return power;
}

// Running sums of the mean power of some signals: they give its mean over any band at once.
std::vector<double> running_power(const std::vector<const std::vector<double>*>& signals, const Whitening& whitening) {
  std::vector<double> sum(whitening.transform_length / 2 + 2, 0.0);
  const auto count = static_cast<double>(signals.size());
  Transform transform(whitening);
  for (const std::vector<double>* signal : signals) {
    const auto& spectrum = transform(*signal);
    double running = 0.0;
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      running += std::norm(spectrum[k]) / count;
      sum[k + 1] += running;
    }
  }
  return sum;
}

// Mean of running sums over so many values either side of one of them, the first left out.
double mean_around(const std::vector<double>& sum, std::size_t k, std::size_t half) {
  const std::size_t low = k > half ? k - half : 1, high = std::min(k + half + 1, sum.size() - 1);
  return (sum[high] - sum[low]) / static_cast<double>(high - low);
}

// Of a channel that stands at zero, or as its numbers are rounded.
double rounding_power(const std::vector<double>& sum, double least, const Whitening& whitening) {
  return 1e-9 * sum.back() / static_cast<double>(sum.size() - 1) + least * least * window_energy(whitening.window);
}

// How much of their counts' noise the encoders have.
using EncoderShares = std::array<double, sim::kMaximumGroupCount>;

// What comes into a channel from the encoders, each of its own power, from the tip's accelerometer and from what the torques were rounded by, at one bin of the transform, added
// to a noise of its own.
template <typename EncoderPower, typename TorquePower>
double add_noise_through(const NoiseResponse& response, const Channel& channel, std::size_t bin, std::size_t groups, EncoderPower&& encoder_power, double tip_power,
                         TorquePower&& torque_power, double noise) {
  const auto i = static_cast<std::size_t>(channel.index);
  const auto of = [&](const SourceResponse& source) { return std::norm(channel.is_torque ? source.torque[i][bin] : source.acceleration[i][bin]); };
  for (std::size_t g = 0; g < groups; ++g) noise += encoder_power(g) * of(response.encoder[g]);
  if (tip_power > 0.0) noise += tip_power * of(response.tip);
  for (std::size_t g = 0; g < groups; ++g) {
    const double power = torque_power(g);
    if (power > 0.0) noise += power * of(response.torque[g]);
  }
  return noise;
}

// The power at each bin that the sensors' noise has in a channel.
class NoisePowers {
 public:
  NoisePowers(const Record& record, const Whitening& whitening, const NoiseResponse& response, const WhiteningSettings& settings)
      : response_(response), bin_width_(whitening.bin_width),
        rise_in_differences_(kRiseInDifferences * 2.0 * (record.sampled_at.empty() ? command_step(record) : record.sensor_period)), groups_(static_cast<std::size_t>(record.group_count)) {
    const double energy = window_energy(whitening.window), stride = static_cast<double>(reading_stride(record));
    const bool is_coarse = record.encoder_quantum >= kCoarseCount;
    const SensorNoise variance = record.noise ? *record.noise : sensor_noise(record);
    for (std::size_t g = 0; g < groups_; ++g) {
      encoder_[g].assign(whitening.transform_length / 2 + 1, variance.encoder[g] * energy / stride);
      if (is_coarse) raise(encoder_[g], rounding_error_power(record.shaft_position[g], record.encoder_quantum, true, record, whitening, settings.count_smoothing), 1.0 / stride);
      torque_[g].assign(whitening.transform_length / 2 + 1, variance.torque * energy);
      if (record.torque_rounding.is_slow) raise(torque_[g], rounding_error_power(record.motor_torque[g], record.torque_rounding.step, false, record, whitening, settings.count_smoothing), 1.0);
    }
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
      // A data sheet's is that of the noise as the differences show it.
      corner_[a] = settings.noise_corner / std::max(kLeastWhite, 1.0 - settings.noise_corner * rise_in_differences_);
      if (record.acceleration[a].empty()) continue;
      accelerometer_[a] = variance.accelerometer[a] * energy;
      if (!record.acceleration_rounding[a].is_slow) continue;
      rounding_[a].assign(whitening.transform_length / 2 + 1, 0.0);
      raise(rounding_[a], rounding_error_power(record.acceleration[a], record.acceleration_rounding[a].step, false, record, whitening, settings.count_smoothing), 1.0);
    }
  }
  // A data sheet says how noise may rise; a sensor that is sampled slowly, or a better one, is white from a lower frequency on. The residual of the
  // nominal machine is noise and more, so in no band may there be more noise.
  void lower_corners(const Whitening& whitening, const Shadow& nominal, const EncoderShares& shares, double from) {
    Transform transform(whitening);
    for (const Channel& channel : whitening.channels) {
      const auto i = static_cast<std::size_t>(channel.index);
      if (channel.is_torque || accelerometer_[i] == 0.0) continue;
      std::vector<double> left = nominal.acceleration_difference[i];
      const double mean = mean_under(whitening, left);
      for (double& value : left) value -= mean;
      const auto& spectrum = transform(left);
      const bool is_own = i == kTip;  // which leads the observer, so that its own noise answers as well
      const std::size_t end = whitening.first_bin + whitening.bin_count;
      for (std::size_t low = std::max(whitening.first_bin, static_cast<std::size_t>(from / bin_width_)), high; low < end; low = high) {
        high = std::min(end, low + std::max(kCornerBins, low / 4));
        if (high - low < kCornerBins) break;
        // What the bins hold is (white + corner rise) / (1 + corner d) besides what other sensors add, d the rise where the differences see it.
        double residual = 0.0, white = 0.0, rise = 0.0, square = 0.0;
        for (std::size_t k = low; k < high; ++k) {
          const double own_white = accelerometer_[i] * (is_own ? std::norm(response_.tip.acceleration[i][k]) : 1.0), frequency = static_cast<double>(k) * bin_width_;
          residual += std::norm(spectrum[k]) - (at(channel, k, shares) - own_white * rising(i, frequency));
          white += own_white;
          rise += own_white / frequency;
          square += std::norm(spectrum[k]) * std::norm(spectrum[k]);
        }
        // Power in a bin of noise deviates by its mean, whose square is half of the mean square.
        const double most = residual + kCornerDeviations * std::sqrt(0.5 * square);
        const double per_corner = rise - most * rise_in_differences_;
        if (rise > kTellsARise * rise_in_differences_ * white && per_corner > 0.0) corner_[i] = std::min(corner_[i], std::max(0.0, (most - white) / per_corner));
      }
    }
  }
  double at(const Channel& channel, std::size_t k, const EncoderShares& shares) const {
    return add_noise_through(response_, channel, k, groups_, [&](std::size_t g) { return shares[g] * encoder_[g][k]; }, flicker(kTip, k),
                             [&](std::size_t g) { return torque_[g][k]; }, own(channel, k));
  }
  // Of what comes into a channel from nothing else.
  double own(const Channel& channel, std::size_t k) const { return channel.is_torque || channel.index == static_cast<int>(kTip) ? 0.0 : flicker(static_cast<std::size_t>(channel.index), k); }
  // Into the whitening: the sources, at so many frequencies.
  void tell_sources(const EncoderShares& shares, std::size_t count, Whitening& whitening) const {
    whitening.encoder_power.assign(groups_, std::vector<double>(count));
    whitening.torque_power = whitening.encoder_power;
    if (accelerometer_[kTip] > 0.0) whitening.tip_power.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t g = 0; g < groups_; ++g) {
        whitening.encoder_power[g][k] = shares[g] * encoder_[g][k];
        whitening.torque_power[g][k] = torque_[g][k];
      }
      if (!whitening.tip_power.empty()) whitening.tip_power[k] = flicker(kTip, std::max<std::size_t>(k, 1));
    }
  }

 private:
  // Of a source, to the mean around each bin of another power of it.
  static void raise(std::vector<double>& power, const std::vector<double>& other, double share) {
    std::vector<double> sum{0.0};
    for (const double value : other) sum.push_back(sum.back() + share * value);
    for (std::size_t k = 1; k < power.size(); ++k) power[k] = std::max(power[k], mean_around(sum, k, kCountBins));
  }
  // The power of an accelerometer's noise at a bin; none where it is not measured.
  double flicker(std::size_t a, std::size_t k) const {
    const double rounding = rounding_[a].empty() ? 0.0 : rounding_[a][k];
    return accelerometer_[a] > 0.0 ? rounding + accelerometer_[a] * rising(a, static_cast<double>(k) * bin_width_) : 0.0;
  }
  // The same at a frequency, over what its fastest differences show.
  double rising(std::size_t a, double frequency) const { return (1.0 + corner_[a] / frequency) / (1.0 + corner_[a] * rise_in_differences_); }

  const NoiseResponse& response_;
  double bin_width_;  // [Hz]
  double rise_in_differences_;  // [1/Hz]
  std::size_t groups_;
  std::array<std::vector<double>, sim::kMaximumGroupCount> encoder_;   // [rad^2] per reading
  std::array<std::vector<double>, sim::kMaximumGroupCount> torque_;    // [Nm^2]; 0: not rounded
  std::array<std::vector<double>, kAccelerometerCount> rounding_;      // [(m/s^2)^2] of accelerometers that were; empty: not
  std::array<double, kAccelerometerCount> accelerometer_{}, corner_{};  // [(m/s^2)^2], [Hz]
};

}  // namespace

CommonNoise::CommonNoise(const Whitening& whitening, const NoiseResponse& response) : in_bin_(whitening.channels_apart()), lower_(whitening.bin_count * in_bin_) {
  std::vector<std::complex<double>> power(whitening.smear.size() / 2 + 1);
  std::vector<double> over_time;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  const auto answer = [&](std::size_t c, const SourceResponse& source) -> const std::vector<std::complex<double>>& {
    const auto i = static_cast<std::size_t>(whitening.channels[c].index);
    return whitening.channels[c].is_torque ? source.torque[i] : source.acceleration[i];
  };
  std::size_t place = 0;
  for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
    for (std::size_t d = 0; d <= c; ++d, ++place) {
      std::fill(power.begin(), power.end(), 0.0);
      const auto add = [&](const SourceResponse& source, const std::vector<double>& of_source) {
        const std::vector<std::complex<double>>&one = answer(c, source), &other = answer(d, source);
        if (one.empty()) return;  // a source that the record has not
        for (std::size_t k = 0; k < power.size(); ++k) power[k] += of_source[k] * one[k] * std::conj(other[k]);
      };
      for (std::size_t g = 0; g < whitening.encoder_power.size(); ++g) {
        add(response.encoder[g], whitening.encoder_power[g]);
        add(response.torque[g], whitening.torque_power[g]);
      }
      if (!whitening.tip_power.empty()) add(response.tip, whitening.tip_power);
      fft.inv(over_time, power);
      for (std::size_t n = 0; n < over_time.size(); ++n) over_time[n] *= whitening.smear[n];
      fft.fwd(power, over_time);
      for (std::size_t b = 0; b < whitening.bin_count; ++b) lower_[b * in_bin_ + place] = power[whitening.first_bin + b];
    }
  }
}

double CommonNoise::power(std::size_t channel, std::size_t bin) const { return std::max(0.0, lower_[bin * in_bin_ + channel * (channel + 3) / 2].real()); }

ChannelMatrix CommonNoise::weighted(const Whitening& whitening, std::size_t bin) const {
  const std::size_t count = whitening.channels.size();
  ChannelMatrix noise(count, count);
  const std::complex<double>* next = lower_.data() + bin * in_bin_;
  const auto weight = [&](std::size_t c) { return whitening.weight[c](static_cast<Eigen::Index>(bin)); };
  for (std::size_t c = 0; c < count; ++c) {
    for (std::size_t d = 0; d < c; ++d) {
      const std::complex<double> value = 0.5 * weight(c) * weight(d) * *next++;
      noise(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d)) = value;
      noise(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(c)) = std::conj(value);
    }
    noise(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(c)) = 0.5 * weight(c) * weight(c) * power(c, bin);
    ++next;
  }
  return noise;
}

ChannelMatrix apart_at(const Whitening& whitening, std::size_t bin) {
  const auto count = static_cast<Eigen::Index>(whitening.channels.size());
  ChannelMatrix apart = ChannelMatrix::Zero(count, count);
  const std::complex<double>* next = whitening.apart.data() + bin * whitening.channels_apart();
  for (Eigen::Index c = 0; c < count; ++c) {
    for (Eigen::Index d = 0; d <= c; ++d) apart(c, d) = *next++;
  }
  return apart;
}

double log_stretch(const Whitening& whitening) {
  double sum = 0.0;
  for (std::size_t bin = 0; bin < whitening.bin_count; ++bin) {
    const ChannelMatrix apart = apart_at(whitening, bin);
    for (Eigen::Index c = 0; c < apart.rows(); ++c) sum += 4.0 * std::log(whitening.weight[static_cast<std::size_t>(c)](static_cast<Eigen::Index>(bin)) * apart(c, c).real());
  }
  return sum;
}

std::size_t transform_length(std::size_t count) {
  for (;; ++count) {
    std::size_t rest = count;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1 && count % 2 == 0) return count;
  }
}

std::vector<bool> trusted_stretches(const Record& record, const Shadow& shadow, const WhiteningSettings& settings) {
  const std::size_t count = record.size();
  std::vector<bool> trusted(count, true);
  const auto before = static_cast<std::size_t>(settings.before_impact / record.step);
  const auto after = static_cast<std::size_t>(settings.after_impact / record.step);
  for (std::size_t n = 0; n < count; ++n) {
    if (!shadow.contact_lost[n]) continue;
    const std::size_t from = n > before ? n - before : 0;
    const std::size_t to = std::min(count, n + after);
    std::fill(trusted.begin() + static_cast<std::ptrdiff_t>(from), trusted.begin() + static_cast<std::ptrdiff_t>(to), false);
  }
  if (record.begins_bent) {
    // How a machine began that was bent is known as little as an impact.
    std::fill(trusted.begin(), trusted.begin() + static_cast<std::ptrdiff_t>(std::min(count, after)), false);
    // How it swings is known by fits alone, and no fit finds it through a moment in which nothing holds the house.
    const auto let_go = std::find(shadow.house_let_go.begin(), shadow.house_let_go.end(), true);
    std::fill(trusted.begin() + (let_go - shadow.house_let_go.begin()), trusted.end(), false);
  }
  return trusted;
}

namespace {

// How a window smears over so many bins of its transform.
std::vector<double> smear_of(const Whitening& whitening, std::size_t length) {
  Eigen::FFT<double> fft;
  std::vector<double> padded(whitening.transform_length, 0.0);
  std::copy(whitening.window.begin(), whitening.window.end(), padded.begin());
  std::vector<std::complex<double>> spectrum;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  fft.fwd(spectrum, padded);
  const double all = window_energy(whitening.window) * static_cast<double>(whitening.transform_length);
  std::vector<std::complex<double>> power(length / 2 + 1);
  for (std::size_t k = 0; k < power.size(); ++k) power[k] = std::norm(spectrum[k]) / std::max(all, std::numeric_limits<double>::min());
  std::vector<double> over_time;
  fft.inv(over_time, power);
  for (double& value : over_time) value *= static_cast<double>(length);
  return over_time;
}

// What the channels have in common is the sensors' noise.
void take_apart(const CommonNoise& common, Whitening& whitening) {
  const auto count = static_cast<Eigen::Index>(whitening.channels.size());
  whitening.beside.assign(whitening.channels.size(), Eigen::VectorXd(static_cast<Eigen::Index>(whitening.bin_count)));
  whitening.apart.reserve(whitening.bin_count * whitening.channels_apart());
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    ChannelMatrix together = common.weighted(whitening, b);
    for (Eigen::Index c = 0; c < count; ++c) {
      const double beside = std::max(kLeastBeside, 1.0 - together(c, c).real());
      whitening.beside[static_cast<std::size_t>(c)](static_cast<Eigen::Index>(b)) = beside;
      together(c, c) += beside;
    }
    // Where a response is so small that its products are what was rounded, nothing is in common.
    const Eigen::LLT<ChannelMatrix> root(together);
    ChannelMatrix apart = ChannelMatrix::Identity(count, count);
    if (root.info() == Eigen::Success) root.matrixL().solveInPlace(apart);
    for (Eigen::Index c = 0; c < count; ++c) {
      for (Eigen::Index d = 0; d <= c; ++d) whitening.apart.push_back(apart(c, d));
    }
  }
}

}  // namespace

Whitening make_whitening(const Record& record, const std::vector<bool>& trusted, const NoiseResponse& response,
                         const Shadow& nominal, const WhiteningSettings& settings) {
  Whitening whitening;
  const std::size_t count = record.size();
  whitening.transform_length = transform_length(count);
  whitening.bin_width = 1.0 / (record.step * static_cast<double>(whitening.transform_length));
  whitening.first_bin =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(settings.lowest_frequency / whitening.bin_width)));
  const double highest = std::min(settings.highest_frequency, 0.4 / record.encoder_period);
  const auto last_bin = static_cast<std::size_t>(highest / whitening.bin_width);
  if (last_bin <= whitening.first_bin) {
    throw NotAdmitted(fmt::format("{}: {:.3g} s of encoders read every {:.3g} ms hold none of the machine's frequencies from {:.3g} to {:.3g} Hz; record longer, "
                                  "or read them faster", record.name, record.step * static_cast<double>(count), 1e3 * record.encoder_period,
                                  settings.lowest_frequency, settings.highest_frequency));
  }
  whitening.bin_count = last_bin - whitening.first_bin;
  whitening.window.assign(count, 1.0);
  const auto edge = static_cast<std::size_t>(kTaper * static_cast<double>(count));
  for (std::size_t n = 0; n < edge; ++n) {
    const double rise = 0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(n) + 0.5) / static_cast<double>(edge));
    whitening.window[n] = rise;
    whitening.window[count - 1 - n] = rise;
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!trusted[n]) whitening.window[n] = 0.0;
  }
  // Edges of what was taken out, softened by a running mean, so that they leak little into other frequencies.
  const auto soft = std::max<std::size_t>(1, static_cast<std::size_t>(settings.soft_edge / record.step));
  std::vector<double> mean(count, 0.0);
  double running = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    running += whitening.window[n];
    if (n >= soft) running -= whitening.window[n - soft];
    mean[n] = running / static_cast<double>(soft);
  }
  for (std::size_t n = 0; n < count; ++n) {
    const double centred = mean[std::min(count - 1, n + soft / 2)];
    whitening.window[n] = trusted[n] ? std::min(whitening.window[n], std::max(0.0, 2.0 * centred - 1.0)) : 0.0;
  }
  whitening.window_sum = std::accumulate(whitening.window.begin(), whitening.window.end(), 0.0);
  for (int g = 0; g < record.group_count; ++g) whitening.channels.push_back({true, g});
  for (int a = 0; a < kAccelerometerCount; ++a) {
    if (!record.acceleration[static_cast<std::size_t>(a)].empty()) whitening.channels.push_back({false, a});
  }
  NoisePowers noise(record, whitening, response, settings);
  // What a model misses at one motor goes with what all of them carry, so torque channels share their mean power.
  std::vector<const std::vector<double>*> torques;
  for (int g = 0; g < record.group_count; ++g) torques.push_back(&record.motor_torque[static_cast<std::size_t>(g)]);
  const std::vector<double> torque_power = running_power(torques, whitening);
  EncoderShares shares;
  shares.fill(1.0);
  EncoderShares shown = shares;
  Transform transform(whitening);
  for (int g = 0; g < record.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    const auto& missing = transform(nominal.missing_torque[i]);
    std::vector<double> ratios;
    for (std::size_t k = whitening.first_bin; k < whitening.first_bin + whitening.bin_count; ++k) {
      if (static_cast<double>(k) * whitening.bin_width < settings.encoder_noise_from) continue;
      ratios.push_back(std::norm(missing[k]) / (noise.at({true, g}, k, shares) + rounding_power(torque_power, settings.least_torque, whitening)));
    }
    if (ratios.empty()) continue;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    // Power in a bin of noise has an exponential distribution, whose median is ln 2 of its mean.
    shown[i] = std::clamp(*middle / std::numbers::ln2, kLeastNoise, 1.0);
  }
  noise.lower_corners(whitening, nominal, shown, settings.corner_from);
  // What lies as far again above the judged frequencies as they go leaks too.
  const std::size_t smeared = std::min(whitening.transform_length, transform_length(4 * (whitening.first_bin + whitening.bin_count)));
  whitening.smear = smear_of(whitening, smeared);
  noise.tell_sources(shown, smeared / 2 + 1, whitening);
  const CommonNoise common(whitening, response);
  for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
    const Channel& channel = whitening.channels[c];
    const auto i = static_cast<std::size_t>(channel.index);
    const std::vector<double> sum = channel.is_torque ? torque_power : running_power({&record.acceleration[i]}, whitening);
    const double rounding = rounding_power(sum, channel.is_torque ? settings.least_torque : settings.least_acceleration, whitening);
    Eigen::VectorXd weight(static_cast<Eigen::Index>(whitening.bin_count)), missed_share = weight;
    for (std::size_t b = 0; b < whitening.bin_count; ++b) {
      const std::size_t k = whitening.first_bin + b;
      const std::size_t half = 4 + static_cast<std::size_t>(0.5 * settings.smoothing * static_cast<double>(k));
      const double missed = settings.discrepancy_share * settings.discrepancy_share * mean_around(sum, k, half);
      const double variance = missed + rounding + noise.own(channel, k) + common.power(c, b);
      weight(static_cast<Eigen::Index>(b)) = std::numbers::sqrt2 / std::sqrt(variance);
      missed_share(static_cast<Eigen::Index>(b)) = missed / variance;
    }
    whitening.weight.push_back(weight);
    whitening.missed.push_back(missed_share);
  }
  take_apart(common, whitening);
  return whitening;
}

std::span<const std::complex<Two>> TransformRoom::spectra(const Whitening& whitening, const Series& first, const Series& second) {
  const std::vector<double>& window = whitening.window;
  const std::size_t length = whitening.transform_length, half = length / 2;
  const auto value_at = [&](std::size_t n) {
    if (n >= window.size()) return Two{};
    const double one = ((*first.values)[n] - first.offset) * window[n];
    const double other = second.values != nullptr ? ((*second.values)[n] - second.offset) * window[n] : 0.0;
    return Two(Two::Lanes{one, other});
  };
  spectra_.resize(whitening.bin_count);
  // Where the length allows, even and odd values as real and imaginary parts of half as many (Sorensen et al. 1987, IEEE Transactions on
  // Acoustics, Speech, and Signal Processing 35, p. 849).
  if (length % 4 != 0) {
    values_.resize(length);
    transformed_.resize(length);
    for (std::size_t n = 0; n < length; ++n) values_[n] = value_at(n);
    fft_.fwd(transformed_.data(), values_.data(), static_cast<Eigen::Index>(length));
    for (std::size_t b = 0; b < whitening.bin_count; ++b) spectra_[b] = transformed_[whitening.first_bin + b];
    return spectra_;
  }
  if (turns_length_ != length) {
    turns_length_ = length;
    turns_.clear();
    for (std::size_t k = 0; k <= half / 2; ++k) {
      turns_.push_back(std::exp(std::complex<double>(0.0, -std::numbers::pi * (static_cast<double>(k) / static_cast<double>(half) + 0.5))));
    }
  }
  values_.resize(half);
  transformed_.resize(half);
  for (std::size_t n = 0; n < half; ++n) values_[n] = {value_at(2 * n), value_at(2 * n + 1)};
  fft_.fwd(transformed_.data(), values_.data(), static_cast<Eigen::Index>(half));
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    const std::size_t bin = whitening.first_bin + b;  // never 0, and below half
    const bool is_mirrored = bin >= half / 2;
    const std::size_t k = is_mirrored ? half - bin : bin;
    const std::complex<Two> here = transformed_[k], there = std::conj(transformed_[half - k]);
    const std::complex<Two> turned = (here - there) * std::complex<Two>(turns_[k].real(), turns_[k].imag());
    spectra_[b] = is_mirrored ? std::conj(here + there - turned) * Two(0.5) : (here + there + turned) * Two(0.5);
  }
  return spectra_;
}

Eigen::VectorXd whiten(const Whitening& whitening, const Shadow& shadow) {
  Eigen::VectorXd result(whitening.size());
  TransformRoom room;
  whiten(whitening, shadow, room, result);
  return result;
}

void whiten(const Whitening& whitening, const Shadow& shadow, TransformRoom& room, Eigen::Ref<Eigen::VectorXd> result) {
  const auto rows = static_cast<Eigen::Index>(2 * whitening.bin_count);  // of a channel
  const auto series_of = [&](std::size_t c) -> TransformRoom::Series {
    if (c >= whitening.channels.size()) return {nullptr};
    const Channel& channel = whitening.channels[c];
    const auto i = static_cast<std::size_t>(channel.index);
    if (channel.is_torque) return {&shadow.missing_torque[i]};
    return {&shadow.acceleration_difference[i], mean_under(whitening, shadow.acceleration_difference[i])};
  };
  for (std::size_t first = 0; first < whitening.channels.size(); first += 2) {
    const auto spectra = room.spectra(whitening, series_of(first), series_of(first + 1));
    for (std::size_t lane = 0; lane < 2 && first + lane < whitening.channels.size(); ++lane) {
      const Eigen::VectorXd& weight = whitening.weight[first + lane];
      Eigen::Index row = rows * static_cast<Eigen::Index>(first + lane);
      for (std::size_t b = 0; b < whitening.bin_count; ++b) {
        const double w = weight(static_cast<Eigen::Index>(b));
        result(row++) = w * spectra[b].real().lanes[lane];
        result(row++) = w * spectra[b].imag().lanes[lane];
      }
    }
  }
  // Each channel freed of those before it, the last one first.
  const double* const apart = reinterpret_cast<const double*>(whitening.apart.data());
  const std::size_t channels = whitening.channels.size();
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    const double* const of_bin = apart + 2 * b * whitening.channels_apart();
    double* const values = result.data() + 2 * b;
    for (std::size_t c = channels; c-- > 0;) {
      const double* const factors = of_bin + c * (c + 1);
      double real = 0.0, imaginary = 0.0;
      for (std::size_t d = 0; d <= c; ++d) {
        const double* const value = values + static_cast<std::size_t>(rows) * d;
        real += factors[2 * d] * value[0] - factors[2 * d + 1] * value[1];
        imaginary += factors[2 * d] * value[1] + factors[2 * d + 1] * value[0];
      }
      values[static_cast<std::size_t>(rows) * c] = real;
      values[static_cast<std::size_t>(rows) * c + 1] = imaginary;
    }
  }
  Eigen::Index row = whitening.spectra_size();
  for (const FlankPart& part : whitening.flanks) result(row++) = part.weight * beside_the_first(shadow, part);
}

double judged_share(const Whitening& whitening) {
  const auto is_judged = [](double weight) { return weight > 0.0; };
  const auto first = std::find_if(whitening.window.begin(), whitening.window.end(), is_judged);
  const auto last = std::find_if(whitening.window.rbegin(), whitening.window.rend(), is_judged).base();
  if (first >= last) return 0.0;
  return static_cast<double>(std::count_if(first, last, is_judged)) / static_cast<double>(last - first);
}

}  // namespace slewlab::diagnosis
