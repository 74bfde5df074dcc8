#include "diagnosis/flanks.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/shadow.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kPlayShare = 0.05;  // of half of the play, chosen: what it differs by from unit to unit, for what the contact's law makes wrong

// [Nm^2] variance of the mean over so many points of what one group misses beside another, as noise and the model's usual errors have it: white,
// with the power that the lowest frequency has which such a mean tells from a constant.
double variance_of_mean(const Whitening& whitening, std::size_t group, std::size_t points, double step) {
  const double frequency = 1.0 / (2.0 * static_cast<double>(points) * step);
  const auto bin = static_cast<std::size_t>(std::lround(frequency / whitening.bin_width));
  const std::size_t b = std::clamp(bin, whitening.first_bin, whitening.first_bin + whitening.bin_count - 1) - whitening.first_bin;
  double power = 0.0;
  for (const std::size_t g : {std::size_t{0}, group}) power += 2.0 / std::pow(whitening.weight[g](static_cast<Eigen::Index>(b)), 2.0);
  return power / whitening.window_sum / static_cast<double>(points);
}

}  // namespace

double beside_the_first(const Shadow& shadow, const FlankPart& part) {
  double sum = 0.0;
  for (std::size_t n = part.from; n < part.to; ++n) sum += shadow.missing_torque[part.group][n] - shadow.missing_torque[0][n];
  return sum / static_cast<double>(part.to - part.from);
}

void add_flanks(const Record& record, const Shadow& nominal, const std::vector<bool>& trusted, double duration, double play_torque, std::size_t from, std::size_t to,
                Whitening& whitening) {
  if (play_torque <= 0.0 || record.group_count < 2 || whitening.window_sum <= 0.0) return;
  const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(duration / record.step)));
  const auto touches = [&](std::size_t n) { return !trusted[n] && !nominal.contact_lost[n]; };
  bool is_beginning = true;
  for (std::size_t begin = 0, end = 0; begin < record.size(); begin = end) {
    for (; begin < record.size() && !touches(begin); ++begin) is_beginning &= !trusted[begin];
    end = begin;
    while (end < record.size() && touches(end)) ++end;
    const bool is_behind_an_impact = begin > 0 && nominal.contact_lost[begin - 1];
    if (is_beginning || !is_behind_an_impact) continue;
    // From where the observer has brought the motors to their places.
    const std::size_t first = std::max(begin + length, from), last = std::min(end, to);
    for (std::size_t g = 1; g < static_cast<std::size_t>(record.group_count); ++g) {
      const double place = kPlayShare * play_torque;
      const double weight = 1.0 / std::sqrt(place * place + variance_of_mean(whitening, g, length, record.step));
      // In pairs, as real and imaginary part of a bin.
      for (std::size_t n = first; n + 2 * length <= last; n += 2 * length) {
        whitening.flanks.push_back({g, n, n + length, weight});
        whitening.flanks.push_back({g, n + length, n + 2 * length, weight});
      }
    }
  }
}

}  // namespace slewlab::diagnosis
