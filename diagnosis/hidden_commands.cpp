#include "diagnosis/hidden_commands.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "diagnosis/decimation.h"
#include "diagnosis/sensor_noise.h"
#include "diagnosis/torque_noise.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kKinks = 0.01;  // share of the largest third differences, which are no noise; chosen

// [Nm^2] of what is fast in a series of commands.
double fast_variance(const std::vector<double>& torque) {
  if (torque.size() < 4) return 0.0;
  const Eigen::VectorXd third = third_difference(Eigen::Map<const Eigen::VectorXd>(torque.data(), static_cast<Eigen::Index>(torque.size())));
  std::vector<double> squares;
  for (const double one : third) squares.push_back(one * one);
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - static_cast<std::size_t>(kKinks * static_cast<double>(squares.size())));
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return sum / static_cast<double>(squares.size()) / kThirdDifferenceGain;
}

constexpr int kBefore = 2, kPoints = 6;  // rows that a polynomial goes through, and those of them before the row itself

// What each of these rows counts at `place` [rows] behind the row: Lagrange's polynomials.
std::array<double, kPoints> weights_at(double place) {
  std::array<double, kPoints> weights{};
  for (int i = 0; i < kPoints; ++i) {
    double weight = 1.0;
    for (int k = 0; k < kPoints; ++k) {
      if (k != i) weight *= (place - (k - kBefore)) / (i - k);
    }
    weights[static_cast<std::size_t>(i)] = weight;
  }
  return weights;
}

// So many from each row to the next, on the polynomial through the rows about them; before the first row and behind the last one it stands.
std::vector<double> between(const std::vector<double>& rows, std::size_t each) {
  const auto last = static_cast<std::ptrdiff_t>(rows.size()) - 1;
  std::vector<std::array<double, kPoints>> weights;
  for (std::size_t j = 0; j < each; ++j) weights.push_back(weights_at(static_cast<double>(j) / static_cast<double>(each)));
  std::vector<double> values;
  values.reserve(rows.size() * each);
  for (std::ptrdiff_t n = 0; n <= last; ++n) {
    for (const std::array<double, kPoints>& weight : weights) {
      double value = 0.0;
      for (int i = 0; i < kPoints; ++i) value += weight[static_cast<std::size_t>(i)] * rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n + i - kBefore, 0, last))];
      values.push_back(value);
    }
  }
  return values;
}

}  // namespace

bool may_hide_commands(std::span<const Record> records, const std::optional<controller::ControllerSettings>& controller) {
  constexpr double kAsFast = 0.9;  // of the record's period, that the controller's may be below it by rounding
  return std::any_of(records.begin(), records.end(), [&](const Record& record) {
    const bool is_cycle_known = controller && controller->period >= kAsFast * record.encoder_period;
    return !is_cycle_known && changes_with_every_message(record);
  });
}

bool can_have_commands_between(const Record& record) { return record.recorded_per_point == 1 && reading_stride(record) == 1 && !record.has_measured_torque; }

Record with_commands_between(Record record, int commands_per_row) {
  if (commands_per_row <= 1 || !can_have_commands_between(record)) return record;
  const auto each = static_cast<std::size_t>(commands_per_row);
  double fast = 0.0;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    fast = std::max(fast, fast_variance(record.motor_torque[g]));
    record.recorded_torque[g] = between(record.motor_torque[g], each);
    record.motor_torque[g] = means(record.recorded_torque[g], each);
  }
  SensorNoise noise = record.noise ? *record.noise : sensor_noise(record);
  const double of_row = (1.0 - 1.0 / commands_per_row) * fast;
  noise.torque += of_row;
  record.noise = noise;
  record.torque_noise += commands_per_row * of_row;
  record.recorded_per_point = each;
  return record;
}

MoreTorques torques_ahead(const Record& record, double lead) {
  MoreTorques torques;
  const std::size_t each = record.recorded_per_point;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    const std::vector<double>& commanded = commands(record, g);
    std::vector<double>& ahead = torques.of_group[g];
    ahead.assign(record.size(), 0.0);
    for (std::size_t n = 0; n + 1 < record.size(); ++n) ahead[n] = lead / record.step * (commanded[(n + 1) * each] - commanded[n * each]);
  }
  return torques;
}

}  // namespace slewlab::diagnosis
