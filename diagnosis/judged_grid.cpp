#include "diagnosis/judged_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "diagnosis/decimation.h"
#include "diagnosis/sensor_noise.h"

namespace slewlab::diagnosis {

namespace {

std::vector<double> every(const std::vector<double>& series, std::size_t points) {
  std::vector<double> taken;
  taken.reserve(series.size() / points + 1);
  for (std::size_t n = 0; n < series.size(); n += points) taken.push_back(series[n]);
  return taken;
}

}  // namespace

std::size_t points_per_judged_point(const Record& record, double highest) {
  if (!record.sampled_at.empty() || record.encoder_quantum >= kCoarseCount) return 1;
  auto points = std::max<std::size_t>(1, static_cast<std::size_t>(1.0 / (kGridPerBand * highest * record.step)));
  // Readings of the encoders lie on the new grid, or many of them between two of its points.
  const std::size_t reading = reading_stride(record);
  if (points >= reading) return points - points % reading;
  while (reading % points != 0) --points;
  return points;
}

Record on_judged_grid(Record record, double highest) {
  const std::size_t points = points_per_judged_point(record, highest), reading = reading_stride(record), count = record.size();
  if (points <= 1) return record;
  SensorNoise noise = sensor_noise(record);
  for (double& variance : noise.encoder) variance /= static_cast<double>(std::max<std::size_t>(1, points / reading));
  for (double& variance : noise.accelerometer) variance /= static_cast<double>(points);
  noise.torque /= static_cast<double>(points);
  record.noise = noise;
  const auto of_encoders = [&](std::vector<double>& series) { series = points > reading ? decimated(series, points) : every(series, points); };
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    for (auto* groups : {&record.shaft_speed, &record.shaft_position, &record.position_rate}) of_encoders((*groups)[g]);
    record.recorded_torque[g] = std::move(record.motor_torque[g]);
    record.recorded_torque[g].resize((count + points - 1) / points * points, record.recorded_torque[g].back());
    record.motor_torque[g] = means(record.recorded_torque[g], points);
  }
  for (std::vector<double>& series : record.acceleration) series = decimated(series, points);
  of_encoders(record.slew_angle);
  record.recorded_per_point = points;
  record.step *= static_cast<double>(points);
  return record;
}

}  // namespace slewlab::diagnosis
