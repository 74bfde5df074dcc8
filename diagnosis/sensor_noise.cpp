#include "diagnosis/sensor_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "diagnosis/median_deviation.h"

namespace slewlab::diagnosis {

namespace {

// Variance of a white sensor noise, from the median size of its differences.
double noise_variance(std::vector<double> values) {
  constexpr std::size_t kOrders = 6;
  double least = std::numeric_limits<double>::infinity(), gain = 1.0;
  for (std::size_t order = 1; order <= kOrders && values.size() > 1; ++order) {
    for (std::size_t n = 1; n < values.size(); ++n) values[n - 1] = values[n] - values[n - 1];
    values.pop_back();
    gain *= 2.0 * static_cast<double>(2 * order - 1) / static_cast<double>(order);
    if (order < 2) continue;
    const double deviation = median_deviation(values);
    least = std::min(least, deviation * deviation / gain);
  }
  return std::isfinite(least) ? least : 0.0;
}

double accelerometer_variance(const Record& record, std::size_t accelerometer) {
  const double least = variance_of(record.acceleration_rounding[accelerometer]);
  if (record.sampled_at.empty()) return std::max(least, noise_variance(record.acceleration[accelerometer]));
  return std::max(least, noise_variance(record.sampled_acceleration[accelerometer])) * record.sensor_period / record.step;
}

// Of a reading of the position: counts are off by anything between two of them.
double encoder_variance(const Record& record, std::size_t group) {
  const std::vector<double>& position = record.shaft_position[group];
  std::vector<double> read;
  for (std::size_t n = 0; n < position.size(); n += reading_stride(record)) read.push_back(position[n]);
  return std::max(variance_of({record.encoder_quantum}), noise_variance(read));
}

}  // namespace

SensorNoise sensor_noise(const Record& record) {
  SensorNoise noise;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) noise.encoder[g] = encoder_variance(record, g);
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
    if (!record.acceleration[a].empty()) noise.accelerometer[a] = accelerometer_variance(record, a);
  }
  noise.torque = record.torque_noise * static_cast<double>(reading_stride(record));
  return noise;
}

}  // namespace slewlab::diagnosis
