// Stochastic effects (jitter, loss): no simulation repeats the draw that was, but it has the draw's power. So such an effect is not fitted to the
// differences but to their variance,
//
//   -2 ln P(d) = sum(ln(1 + a S) + d^2 / (1 + a S)) + constant,
//
// S being the power that a draw of its own adds to each whitened difference, smoothed over neighbouring frequencies, and a its scale, fitted. In a
// deterministic fit S = 0 and only the sum of squares remains, so both are compared as they are. A smooth power fits nearly any difference better
// than no effect does. Therefore such an effect is a candidate only where it comes near what a free power would reach.
//
// What one force adds to the channels of a record stands, at each frequency, in proportions that no draw changes. So the power is taken
// along the axes that the draws have there among the channels, the eigenvectors of sum(c c^H) over the draws and the nearest other bins, c
// being their changes: along the main one they are explained, across it the differences count in full.
// Assumes that what is missing adds to the differences independently of the rest, and linearly.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <string_view>
#include <vector>

#include "common/effect.h"
#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

bool is_stochastic(const common::EffectAbout& effect);
// The same by its name; one that the catalogue has not, as a controller's, is none.
bool is_stochastic(const common::EffectCatalogue& catalogue, std::string_view effect);

// Whether the stochastic effect delays on the average; and whether another effect is what such a one does on the average: a delay, or a lag.
bool is_stochastic_delay(const common::EffectAbout& effect);
bool is_steady_delay(const common::EffectAbout& effect);

// Of one record's channels: per bin a unitary matrix, column by column; the columns are the axes.
struct ChannelAxes {
  Eigen::Index first_row = 0;  // of the record's differences
  Eigen::Index channels = 0, bins = 0;
  std::vector<std::complex<double>> axes;
};
// Of every record, from the changes of the differences by draws; and differences of the channels as those of the axes.
std::vector<ChannelAxes> axes_of(const Problem& problem, std::span<const Eigen::VectorXd> changes);
Eigen::VectorXd along_axes(const std::vector<ChannelAxes>& records, Eigen::VectorXd values);

// S: what draws add, at each frequency along each axis; in the order of the differences, with the axis in the channel's place.
struct Power {
  Eigen::VectorXd profile;
  std::vector<ChannelAxes> records{};  // none: each channel is its own axis
};
// From the changes of the differences by draws.
Power power_of(const Problem& problem, std::span<const Eigen::VectorXd> changes);

struct PowerFit {
  double scale = 0.0;  // a
  double cost = 0.0;   // the sum; without the effect it is the sum of squares
};
PowerFit fit_power(const Eigen::VectorXd& difference, const Power& power);
PowerFit power_at(const Eigen::VectorXd& difference, const Power& power, double scale);

// The same for many differences and one power, which must outlive it: the logarithms of the scales that are tried first are taken once.
class PowerScales {
 public:
  explicit PowerScales(const Power& power);
  PowerFit fit(const Eigen::VectorXd& difference) const;

 private:
  const Power& power_;
  std::vector<Eigen::ArrayXd> logarithms_;  // per scale, of the variance in each row
};

// What the added power makes of unit variance: sum of logarithms in the cost, and differences (or columns) divided by what it adds.
struct AddedPower {
  Power power;
  double scale = 0.0;
  Eigen::VectorXd mean{};  // what it adds to the differences on the average; none: 0
};
double logarithms(const AddedPower& added);
Eigen::VectorXd divided(const AddedPower& added, const Eigen::VectorXd& values);
Eigen::VectorXd undivided(const AddedPower& added, const Eigen::VectorXd& values);

// All differences are divided by the power that a stochastic effect adds to them, as long as it lives.
class UnderPower {
 public:
  UnderPower(Problem& problem, const AddedPower& added) : problem_(problem) { problem_.added_power = &added; }
  ~UnderPower() { problem_.added_power = nullptr; }
  UnderPower(const UnderPower&) = delete;
  UnderPower& operator=(const UnderPower&) = delete;

 private:
  Problem& problem_;
};

// A machine with stochastic effects as several draws show it: the mean of their differences, and the power by which one draw stands off it.
struct Drawn {
  Eigen::VectorXd mean;
  Power power;
};
Drawn draw(Problem& problem, const Point& point);

// -2 ln P of differences that were not fitted, under a power found elsewhere; its scale is known by `deviation` [-], of ln a, alone.
double predictive_cost(const Eigen::VectorXd& difference, const Power& power, double deviation);

// What a cause that nobody knows would add: the mean power in each channel and third of an octave, over all records of `seen`, in the
// order of the differences of `unseen`. Frequencies that `seen` has none of get no power. With axes, which both have then, it acts along
// those, one power for each.
Power unknown_power(const Problem& seen, const std::vector<ChannelAxes>& seen_axes, const Eigen::VectorXd& difference, const Problem& unseen,
                    std::vector<ChannelAxes> unseen_axes);

// The same sum for a power that is free in every channel (or along every axis) and every third of an octave: what a cause would have to
// reach whose power nobody knows.
struct FreePower {
  double cost = 0.0;
  double noise = 0.0;  // the part of it that no power above the noise is needed for
  double chance = 0.0;  // that its powers take off beside, on the average, because they follow what the draw happened to be
};
FreePower free_power(const Problem& problem, const Eigen::VectorXd& difference);

// By how much the cost of the fit of `count` differences is above that of the free power, as a share of the free power's cost above the noise.
inline constexpr double kNearFreePower = 0.25;  // below which it may be the cause
double above_free_power(const PowerFit& fit, const FreePower& free, Eigen::Index count);

// The stochastic effect with its size changed so that its power is `scale` times what it was, within its bounds.
common::EffectInstance with_power(const common::EffectAbout& about, common::EffectInstance effect, double scale);
// By what the effect's power can grow at most until its size is at its upper bound.
double largest_scale(const common::EffectAbout& about, const common::EffectInstance& effect);

}  // namespace slewlab::diagnosis
