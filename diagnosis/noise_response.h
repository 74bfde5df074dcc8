// What the sensors' noise makes of the observer's differences. The observer is a closed loop of encoders, model and, where there is one, the
// tip's accelerometer: below its own frequency the missing torque follows an encoder's noise as the machine's inertia has it, above it as
// the observer's gains do, and the model's accelerations shake with it. So no formula of the gains gives the noise, but the loop itself:
//
//   N_cd(f) = sum over sources s of H_cs(f) S_s(f) conj(H_ds(f)),    H_cs = transform of what channel c answers to one reading of s that is off by 1
//
// on the diagonal the power in a channel, beside it how far two channels have the same noise.
// of the machine with its teeth together (no play) and without effects that act while it runs but the linear ones.
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

// H at each frequency of a transform over the record's grid, from 0 on, but for the time of the reading, which all channels share; channels that the record has not are empty.
struct SourceResponse {
  std::array<std::vector<std::complex<double>>, sim::kMaximumGroupCount> torque;    // [Nm] per unit of the source
  std::array<std::vector<std::complex<double>>, kAccelerometerCount> acceleration;  // [m/s^2] per unit
};
struct NoiseResponse {
  std::array<SourceResponse, sim::kMaximumGroupCount> encoder;  // of one reading of the position that is off by 1 rad
  std::array<SourceResponse, sim::kMaximumGroupCount> torque;   // of a torque that is written down 1 Nm too high over one grid step; empty: none is rounded
  SourceResponse tip;  // of a tip acceleration that is off by 1 m/s^2 at one grid point; empty: not measured
};

// A record of a machine that stands, on the grid of `record` and with its sensors.
Record standing(const Record& record, std::size_t length);

// The first frequencies of a series' transform, from 0 on; 0: all up to half its rate.
std::vector<std::complex<double>> spectrum_of(const std::vector<double>& values, std::size_t frequencies = 0);

// What follows where nothing but what is linear acts while the machine runs and its teeth never part: what it answers grows with what it is asked. Play may be the crane's
// or an effect's. Throws std::invalid_argument where the machine cannot be built.
Follower linear_follower(sim::MachineSettings machine, const Grid& grid, const ForceSteps& force_steps);

// `length` points on the record's grid, an even number; so many of the frequencies, or all. Throws std::invalid_argument where the machine cannot be built.
NoiseResponse noise_response(const sim::MachineSettings& nominal, const Record& record, const ShadowGains& gains, std::size_t length, const ForceSteps& force_steps = {},
                             std::size_t frequencies = 0);

}  // namespace slewlab::diagnosis
