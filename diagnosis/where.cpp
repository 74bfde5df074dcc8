#include "diagnosis/where.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace slewlab::diagnosis {

namespace {

constexpr double kStanding = 0.02, kChanging = 0.05;  // shares of the record's largest speed

std::string name_of(const Channel& channel) {
  return channel.is_torque ? fmt::format("torque of group {}", channel.index + 1) : fmt::format("{} acceleration", accelerometer_name(channel.index));
}

// Calls visit(channel, frequency [Hz], row) for the two rows of every bin of all records' spectra.
void for_each_bin(const Problem& problem, const std::function<void(const Channel&, double, Eigen::Index)>& visit) {
  Eigen::Index row = 0;
  for (const Whitening& whitening : problem.whitening) {
    for (const Channel& channel : whitening.channels) {
      for (std::size_t b = 0; b < whitening.bin_count; ++b, row += 2) visit(channel, static_cast<double>(whitening.first_bin + b) * whitening.bin_width, row);
    }
    row += whitening.flanks_size();
  }
}

}  // namespace

std::vector<BandShare> bands_of_gap(const Problem& problem, const Eigen::VectorXd& difference, const Eigen::VectorXd& left) {
  const std::vector<double>& edges = problem.thresholds.band_edges;
  struct Sum {
    double square = 0.0, more = 0.0, count = 0.0;
  };
  std::map<std::pair<std::string, std::size_t>, Sum> sums;
  for_each_bin(problem, [&](const Channel& channel, double frequency, Eigen::Index row) {
    std::size_t band = 0;
    while (band + 2 < edges.size() && frequency >= edges[band + 1]) ++band;
    Sum& sum = sums[{name_of(channel), band}];
    for (const Eigen::Index part : {row, row + 1}) {
      sum.square += difference(part) * difference(part);
      sum.more += difference(part) * difference(part) - left(part) * left(part);
      sum.count += 1.0;
    }
  });
  double total = 0.0;
  for (const auto& [key, sum] : sums) total += std::max(0.0, sum.more);
  std::vector<BandShare> bands;
  if (total <= 0.0) return bands;
  for (const auto& [key, sum] : sums) {
    const auto& [channel, band] = key;
    bands.push_back({channel, edges[band], edges[band + 1], std::max(0.0, sum.more) / total, sum.square / sum.count});
  }
  std::stable_sort(bands.begin(), bands.end(), [](const BandShare& a, const BandShare& b) { return a.share > b.share; });
  return bands;
}

std::optional<ChannelShare> channel_of_most(const std::vector<BandShare>& bands) {
  constexpr double kMost = 2.0 / 3.0;
  std::map<std::string, double> shares;
  for (const BandShare& band : bands) shares[band.channel] += band.share;
  for (const auto& [channel, share] : shares) {
    if (share >= kMost) return ChannelShare{channel, share};
  }
  return {};
}

ChannelShare largest_slow_share(const Problem& problem, const Eigen::VectorXd& difference, const Eigen::VectorXd& left, double below) {
  std::map<std::string, double> taken;
  for_each_bin(problem, [&](const Channel& channel, double frequency, Eigen::Index row) {
    if (!channel.is_torque && frequency < below) taken[name_of(channel)] += difference.segment<2>(row).squaredNorm() - left.segment<2>(row).squaredNorm();
  });
  ChannelShare largest;
  const double all = difference.squaredNorm() - left.squaredNorm();
  if (all <= 0.0) return largest;
  for (const auto& [channel, amount] : taken) {
    if (amount / all > largest.share) largest = {channel, amount / all};
  }
  return largest;
}

namespace {

// What the machine does from grid point `begin` to `end`, by group 1.
const char* phase_of(const Record& record, std::size_t begin, std::size_t end, double top_speed) {
  const std::vector<double>& speed = record.shaft_speed[0];
  const double first = speed[begin], middle = std::fabs(speed[begin + (end - begin) / 2]), last = speed[end - 1];
  const double change = std::fabs(last) - std::fabs(first);
  if (middle < kStanding * top_speed) return "standing";
  if (change > kChanging * top_speed) return "accelerating";
  if (change < -kChanging * top_speed) return "braking";
  return first * last < 0.0 ? "reversing" : "constant speed";
}

}  // namespace

std::vector<Moment> largest_moments(const Problem& problem, const Point& point, std::size_t most) {
  std::vector<Moment> moments;
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const Record& record = problem.records[r];
    const Shadow follower = shadow_at(problem, point, r);
    const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(problem.thresholds.moment / record.step)));
    double top_speed = 0.0;
    for (const double speed : record.shaft_speed[0]) top_speed = std::max(top_speed, std::fabs(speed));
    for (std::size_t n = 0; n + length <= record.size(); n += length) {
      double square = 0.0;
      for (std::size_t i = n; i < n + length; ++i) {
        for (int g = 0; g < record.group_count; ++g) {
          const double missing = follower.missing_torque[static_cast<std::size_t>(g)][i];
          square += missing * missing / record.group_count;
        }
      }
      moments.push_back({record.name, record.time(n) + 0.5 * record.step * static_cast<double>(length),
                         phase_of(record, n, n + length, top_speed), std::sqrt(square / static_cast<double>(length))});
    }
  }
  std::stable_sort(moments.begin(), moments.end(), [](const Moment& a, const Moment& b) { return a.missing_torque > b.missing_torque; });
  if (moments.size() > most) moments.resize(most);
  return moments;
}

}  // namespace slewlab::diagnosis
