// Differences between record and observer as one vector of numbers that are comparable with each other: the
// spectrum of each channel, divided at each frequency by what a good model may still miss there, and then freed of what the channels have in common.
//
//   z(f) = L(f)^-1 W(f) d(f),    w_c(f) = sqrt(2 / (e^2 P_c(f) + N_cc(f))),    L L* = R,    R_cd = w_c w_d N_cd / 2 beside the diagonal, 1 on it, of which a hundredth at least is a channel's own
//
// N as the window smears it, whose bin holds what of its neighbours leaks into it: N_cd(f) = sum over f' of |V(f - f')|^2 N_cd(f') / sum |V|^2, V the
// window's transform.
// The noise of one encoder, and of the tip's accelerometer, leads the observer and so is in every channel: what the channels before it say of it is
// taken off each one, torques first. A residual of an accelerometer is then that sensor's own noise, and hardly the encoders', whose noise the
// controller hands on to the machine. That noise would be correlated with what another machine makes of the torques, and the residual of a wrong
// machine could be smaller than that of the true one.
// P is the smoothed power of the measured signal itself, e the share of it that mesh, step and laws of a good model still miss (learned from machines
// with nothing missing). The 2 is there because real and imaginary part share a bin's power: parts of noise alone have variance 1. N is the sensors'
// noise as the observer's loop has it (noise_response.h). An accelerometer's is white and rises as 1/f below a corner f_c, that of its data sheet or,
// where the residual of the nominal machine allows less, a lower one: v (1 + f_c / f) / (1 + f_c d), v as the record's fastest differences show it,
// which hold 1/f noise as well, d = 1.186 over half their rate; an encoder's that of its counts, q^2 / 12 per reading, or what its fastest
// differences show.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "diagnosis/flanks.h"
#include "diagnosis/noise_response.h"
#include "diagnosis/record.h"
#include "diagnosis/shadow.h"

namespace slewlab::diagnosis {

// Those with a dimension by thresholds_of() (thresholds.h).
struct WhiteningSettings {
  double discrepancy_share = 0.004;  // [-] e: learned on machines whose answers are known, docs/diagnosis/method.md
  double smoothing = 0.4;            // [-] width of the smoothing of P as a share of the frequency
  double highest_frequency = 0.0;    // [Hz] of the modes that matter
  double lowest_frequency = 0.0;     // [Hz] below which a record knows nothing
  double noise_corner = 0.0;         // [Hz] below which an accelerometer's noise rises as 1/f, at most (its data sheet)
  double corner_from = 0.0;          // [Hz] above which the residual of the nominal machine may lower that
  double encoder_noise_from = 0.0;   // [Hz] from which torque channels hold the encoders' noise alone
  double before_impact = 0.0;        // [s] a real machine may let go a little before its model
  double after_impact = 0.0;         // [s] in which the observer forgets an impact, three of its slowest time constants
  double flank_part = 0.0;           // [s] length of a part of what lies on the flanks near impacts, and in which the observer brings a motor there
  double soft_edge = 0.0;            // [s] over which the window falls beside a stretch that is taken out
  double count_smoothing = 0.0;      // [s] either side, over which coarse counts are taken for a smooth motion
  double least_torque = 0.0;         // [Nm] deviation in a torque channel that stands at zero, far below any sensor's
  double least_acceleration = 0.0;   // [m/s^2] the same of an accelerometer
};

struct Channel {
  bool is_torque = false;  // else an accelerometer
  int index = 0;           // group or accelerometer
};

// How one record's differences become numbers.
struct Whitening {
  std::vector<Channel> channels;
  std::size_t transform_length = 0;
  std::size_t first_bin = 0, bin_count = 0;
  double bin_width = 0.0;               // [Hz]
  std::vector<Eigen::VectorXd> weight;  // per channel, per bin
  std::vector<double> window;           // per grid point, 0 where the record is not to be judged
  double window_sum = 0.0;              // of all its points
  std::vector<FlankPart> flanks;        // in pairs
  std::vector<std::complex<double>> apart;  // L^-1 of each bin, row by row up to the diagonal
  // The sensors' noise that comes through the observer, as `weight` has it: the power of each source at the transform's frequencies from 0 on, beyond those that are judged as far again [rad^2], [(m/s^2)^2],
  // [Nm^2], how the window smears it, and what of a channel's variance the nominal machine does not make of it, per channel and bin. For machines that make something else of it (own_noise.h).
  std::vector<std::vector<double>> encoder_power;
  std::vector<double> tip_power;
  std::vector<std::vector<double>> torque_power;
  std::vector<double> smear;  // |V|^2 over its sum, as a function of time
  std::vector<Eigen::VectorXd> beside;
  std::vector<Eigen::VectorXd> missed;  // of a channel's variance, the part of mesh and step, e^2 P
  std::size_t channels_apart() const { return channels.size() * (channels.size() + 1) / 2; }  // numbers of `apart` in a bin
  Eigen::Index spectra_size() const { return static_cast<Eigen::Index>(2 * bin_count * channels.size()); }
  Eigen::Index flanks_size() const { return static_cast<Eigen::Index>(flanks.size()); }
  Eigen::Index size() const { return spectra_size() + flanks_size(); }
};

// `trusted` holds for each grid point whether it may be judged; the window falls to 0 where it may not. `response`, of a transform of
// transform_length(), turns the sensors' noise into the channels'. An encoder that stands makes no noise, so how much of it there is shows
// in what the `nominal` observer misses above `encoder_noise_from`, where motors hardly move; at most what its counts may make.
Whitening make_whitening(const Record& record, const std::vector<bool>& trusted, const NoiseResponse& response,
                         const Shadow& nominal, const WhiteningSettings& settings);

inline constexpr int kMostChannels = sim::kMaximumGroupCount + static_cast<int>(kAccelerometerCount);
using ChannelMatrix = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostChannels, kMostChannels>;

// N of every bin that is judged.
class CommonNoise {
 public:
  // Of a machine of that response, whose frequencies go as far as the whitening's sources.
  CommonNoise(const Whitening& whitening, const NoiseResponse& response);
  double power(std::size_t channel, std::size_t bin) const;
  // W N W* / 2, as the channels are weighted.
  ChannelMatrix weighted(const Whitening& whitening, std::size_t bin) const;

 private:
  std::size_t in_bin_;
  std::vector<std::complex<double>> lower_;  // rows up to the diagonal, bin by bin
};

// L^-1 of one bin.
ChannelMatrix apart_at(const Whitening& whitening, std::size_t bin);

// By how much whitening stretches what the spectra differ by: -2 ln of their density is the sum of squares of what is whitened, less this, and a constant. 4 sum of ln(w_c / L_cc).
double log_stretch(const Whitening& whitening);

// The next length for so many grid points that 2, 3 and 5 divide down to 1, where the transform is fast; an even one.
std::size_t transform_length(std::size_t count);

// Where a record may be judged: away from impacts, at which every small difference grows to full size. Takes out
// each stretch in which the observer's gears are not all in contact, and what follows it until it is forgotten; likewise a beginning in motion, and behind
// one all that follows a moment in which no gear is in contact.
std::vector<bool> trusted_stretches(const Record& record, const Shadow& shadow, const WhiteningSettings& settings);

// Real and imaginary part of every bin of every channel, weighted; then what each part of a stretch on the flanks says.
Eigen::VectorXd whiten(const Whitening& whitening, const Shadow& shadow);

// Two numbers that one instruction of every x86-64 and every 64-bit ARM handles, each as if it were alone, bit for bit.
struct Two {
  using Lanes [[gnu::vector_size(16)]] = double;
  Lanes lanes{};

  Two() = default;
  Two(double both) : lanes{both, both} {}  // NOLINT: a number among them
  explicit Two(Lanes given) : lanes(given) {}
  Two& operator+=(Two other) { lanes += other.lanes; return *this; }
  Two& operator-=(Two other) { lanes -= other.lanes; return *this; }
  Two& operator*=(Two other) { lanes *= other.lanes; return *this; }
  friend Two operator+(Two a, Two b) { return Two(a.lanes + b.lanes); }
  friend Two operator-(Two a, Two b) { return Two(a.lanes - b.lanes); }
  friend Two operator*(Two a, Two b) { return Two(a.lanes * b.lanes); }
  friend Two operator-(Two a) { return Two(-a.lanes); }
};

// The transforms' sines and room, used again: making them takes as long as using them. Two series are transformed at once, and of their
// spectra only the bins that are judged are put together.
class TransformRoom {
 public:
  struct Series {
    const std::vector<double>* values;  // one per point of the whitening's grid; null: none
    double offset = 0.0;                // taken off them
  };
  // Under the whitening's window, from its first bin on. Valid until the next call.
  std::span<const std::complex<Two>> spectra(const Whitening& whitening, const Series& first, const Series& second);

 private:
  Eigen::FFT<Two> fft_;
  std::vector<std::complex<Two>> values_, transformed_, spectra_;
  std::vector<std::complex<double>> turns_;  // of the transform of this length: what puts the spectra of even and odd values together
  std::size_t turns_length_ = 0;
};
// As whiten(), into `result`.
void whiten(const Whitening& whitening, const Shadow& shadow, TransformRoom& room, Eigen::Ref<Eigen::VectorXd> result);

// Share that is judged of the stretch from the first point to the last one that is: 1 but for what lies near impacts.
double judged_share(const Whitening& whitening);
inline constexpr double kFreeOfImpacts = 0.8;  // share below which numerical errors behind impacts count: free runs across them are not compared; chosen

}  // namespace slewlab::diagnosis
