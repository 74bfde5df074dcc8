#include "diagnosis/noise_response.h"

#include <algorithm>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

// Drives that are on and push with nothing.
DriveCourse idle_drives(const Record& record) {
  DriveCourse drives;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    drives.motor_torque[g].assign(record.size(), 0.0);
    drives.brake_torque[g].assign(record.size(), 0.0);
  }
  drives.enable.assign(record.size(), true);
  return drives;
}

}  // namespace

Record standing(const Record& record, std::size_t length) {
  Record still;
  still.step = record.step;
  still.encoder_period = record.encoder_period;
  still.group_count = record.group_count;
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    for (auto* series : {&still.motor_torque[g], &still.shaft_speed[g], &still.shaft_position[g], &still.position_rate[g]}) series->assign(length, 0.0);
  }
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) still.acceleration[a].assign(record.acceleration[a].empty() ? 0 : length, 0.0);
  return still;
}

std::vector<std::complex<double>> spectrum_of(const std::vector<double>& values, std::size_t frequencies) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, values);
  if (frequencies == 0 || frequencies >= spectrum.size()) return spectrum;
  return {spectrum.begin(), spectrum.begin() + static_cast<std::ptrdiff_t>(frequencies)};
}

Follower linear_follower(sim::MachineSettings machine, const Grid& grid, const ForceSteps& force_steps) {
  std::erase_if(machine.effects, [](const common::EffectInstance& effect) {
    const sim::EffectDescription* description = sim::find_effect(effect.name);
    if (description != nullptr && description->about.linear) return false;
    return description == nullptr || std::any_of(description->ports.begin(), description->ports.end(), [](sim::EffectPort port) { return port != sim::EffectPort::parameters; });
  });
  Follower follower = follower_of(machine, grid, force_steps);
  for (sim::GearContact& gear : follower.machine.model.gear) gear.half_play = 0.0;
  return follower;
}

NoiseResponse noise_response(const sim::MachineSettings& nominal, const Record& record, const ShadowGains& gains, std::size_t length, const ForceSteps& force_steps,
                             std::size_t frequencies) {
  NoiseResponse response;
  Record still = standing(record, length);
  DriveCourse drives = idle_drives(still);
  const Follower follower = linear_follower(nominal, grid_of(still), force_steps);
  const std::size_t cycle = reading_stride(record);
  // Behind the time in which the tip sensor's offset is taken, for which a reading that is off would be taken.
  const std::size_t place = std::min(length / 2, static_cast<std::size_t>(gains.first_offset / record.step) + cycle + 1);
  const auto groups = static_cast<std::size_t>(record.group_count);
  const auto answer = [&] {
    Shadow differences;
    std::vector<Shadowing> alone;
    alone.push_back({follower, 0.0, {}, &differences});
    shadow(std::move(alone), still, drives, gains);
    SourceResponse answers;
    for (std::size_t g = 0; g < groups; ++g) answers.torque[g] = spectrum_of(differences.missing_torque[g], frequencies);
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) {
      if (!still.acceleration[a].empty()) answers.acceleration[a] = spectrum_of(differences.acceleration_difference[a], frequencies);
    }
    return answers;
  };
  for (std::size_t g = 0; g < groups; ++g) {
    // Between two readings a position is a cubic (record.h).
    for (std::size_t k = 0; k < cycle; ++k) {
      const double near = 1.0 - static_cast<double>(k) / static_cast<double>(cycle);
      still.shaft_position[g][place + k] = still.shaft_position[g][place - k] = near * near * (3.0 - 2.0 * near);
    }
    response.encoder[g] = answer();
    std::fill(still.shaft_position[g].begin(), still.shaft_position[g].end(), 0.0);
  }
  for (std::size_t g = 0; g < groups && record.torque_noise > 0.0; ++g) {
    drives.motor_torque[g][place] = 1.0;
    response.torque[g] = answer();
    drives.motor_torque[g][place] = 0.0;
  }
  if (!still.acceleration[kTip].empty()) {
    still.acceleration[kTip][place] = 1.0;
    response.tip = answer();
  }
  return response;
}

}  // namespace slewlab::diagnosis
