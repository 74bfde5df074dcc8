#include "diagnosis/thresholds.h"

#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

// The judged band ends above the fifth bending mode of a boom (thesis 4.2), which is the eighth structural mode: two of the drive and
// one of torsion lie below it. Chosen: a twentieth above it, where its resonance has fallen off.
constexpr std::size_t kModesThatMatter = 8;
constexpr double kAboveLastMode = 1.055;
// With fewer modes: so many times 1 / T, or the same distance above the last mode that there is between two modes.
constexpr double kBandWithoutModes = 40.0;
constexpr double kAboveOnlyModes = 1.5;

constexpr double kApart = 1.5;  // ratio of two neighbouring modes from which an edge goes between them
// Without a pendulum the first edge lies so far below the first mode.
constexpr double kBelowFirstMode = 2.6;

double highest_frequency(const std::vector<double>& structural, double time) {
  if (structural.size() >= kModesThatMatter) return kAboveLastMode * structural[kModesThatMatter - 1];
  const double of_modes = structural.empty() ? 0.0 : kAboveOnlyModes * structural.back();
  return std::max(of_modes, kBandWithoutModes / time);
}

AdmissionSettings admission_settings(const sim::MachineDescription& machine, double time, double highest) {
  AdmissionSettings settings;
  const sim::Scales& scales = machine.scales;
  settings.rated_torque = scales.motor_torque;
  settings.total_ratio = scales.ratio;
  settings.turn = scales.top_speed * scales.ratio * time;
  settings.time = time;
  settings.shortest_record = 5.0 * time;
  settings.frozen_time = time;
  settings.slow = 0.4 * time;
  settings.speed_window = 0.05 * time;
  settings.rate_half_width = 0.24 / highest;
  for (const sim::Sensor& sensor : machine.sensors) {
    const int accelerometer = accelerometer_at(sensor);
    if (accelerometer >= 0) settings.radius[static_cast<std::size_t>(accelerometer)] = sensor.radius;
  }
  return settings;
}

ShadowSettings shadow_settings(double time, double highest) {
  ShadowSettings settings;
  settings.speed_rate = 52.0 / time;
  settings.position_rate = 680.0 / (time * time);
  settings.speed_window = 0.32 / highest;
  settings.tip_damping_rate = 0.6 / time;
  settings.leak_time = time;
  settings.first_offset = 0.25 * time;
  settings.first_slope = time;
  settings.offset_time = 20.0 * time;
  return settings;
}

WhiteningSettings whitening_settings(const sim::MachineDescription& machine, double time, double highest) {
  WhiteningSettings settings;
  settings.lowest_frequency = 0.02 / time;
  settings.highest_frequency = highest;
  settings.encoder_noise_from = 0.5 * highest;
  settings.corner_from = 0.05 * highest;
  settings.before_impact = 0.3 * time;
  settings.after_impact = 2.5 * time;
  settings.flank_part = 0.1 * time;
  settings.soft_edge = 0.4 * time;
  settings.count_smoothing = 0.1 * time;
  settings.least_torque = 4e-9 * machine.scales.motor_torque;
  for (const sim::Sensor& sensor : machine.sensors) {
    if (accelerometer_at(sensor) < 0) continue;
    settings.noise_corner = sensor.noise_corner;
    settings.least_acceleration = 2e-4 * sensor.noise_floor;
  }
  return settings;
}

}  // namespace

std::vector<double> edges_between(const std::vector<double>& pendulum, const std::vector<double>& structural, double lowest, double highest) {
  std::vector<double> edges{lowest};
  const auto add = [&](double edge) {
    if (edge > edges.back() && edge < highest) edges.push_back(edge);
  };
  if (!structural.empty()) {
    const double first = structural.front();
    const auto above = std::lower_bound(pendulum.begin(), pendulum.end(), first);
    add(above == pendulum.begin() ? first / kBelowFirstMode : std::sqrt(*(above - 1) * first));
  }
  for (std::size_t k = 1; k < structural.size(); ++k) {
    if (structural[k] > kApart * structural[k - 1]) add(std::sqrt(structural[k] * structural[k - 1]));
  }
  edges.push_back(highest);
  return edges;
}

Thresholds thresholds_of(const sim::MachineDescription& machine) {
  const std::vector<double> structural = sim::structural_modes(machine.machine, kModesThatMatter);
  Thresholds thresholds;
  thresholds.time = sim::characteristic_time(machine.scales, structural);
  const double time = thresholds.time, highest = highest_frequency(structural, time);
  thresholds.admission = admission_settings(machine, time, highest);
  thresholds.shadow = shadow_settings(time, highest);
  thresholds.whitening = whitening_settings(machine, time, highest);
  thresholds.band_edges = edges_between(sim::pendulum_modes(machine.machine), structural, thresholds.whitening.lowest_frequency, highest);
  thresholds.highest_mode = 5.0 * highest;
  thresholds.latency = 3e-4 * time;
  thresholds.coarse_latency = 3e-3 * time;
  thresholds.fitted_time = 240.0 * time;
  thresholds.shortest_stretch = 20.0 * time;
  thresholds.moment = time;
  thresholds.spell_every = 0.5 * time;
  return thresholds;
}

}  // namespace slewlab::diagnosis
