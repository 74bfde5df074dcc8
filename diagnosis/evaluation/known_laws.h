// A withheld case with the laws that the diagnosis knows: the catalogue's effects, of the sizes that were drawn, in the withheld laws' place, and the
// plant's integrator, step and mesh in the reference's. Spread, controller, drive, manoeuvres, recorder and sensors are the same. No law of the diagnosis
// is wrong on such a machine: what it does not name there, the records do not tell or its search does not find. So its score is what can be reached at best.
//
// The drive's speed is the plant's reading with what counting adds to it, by the tracking loop L of measure.h:
//   speed = reading + L(counted position) - L(position).
#pragma once

#include <vector>

#include "diagnosis/evaluation/draw.h"
#include "diagnosis/loop/loop.h"

namespace slewlab::diagnosis::withheld {

// Whether each law of the case has its own in the catalogue.
bool has_known_laws(const DrawnCase& drawn);

struct KnownMachine {
  sim::MachineSettings machine;
  controller::ControllerSettings controller;
  EncoderCounting counting;
  NoiseSettings noise;
};

// The machine with those of its laws that are `on`. True sizes, in their order, to `sizes`: where a drawn one lies beyond the catalogue's bounds, the bound.
// Throws std::invalid_argument where a law is in no catalogue.
KnownMachine known_machine(const DrawnCase& drawn, const NominalMachine& nominal, const sim::DriveProtectionSettings& drive_protection,
                           const std::vector<bool>& on, std::vector<std::vector<TrueSize>>* sizes = nullptr);

// As run_truth(). Throws DriveStopped, std::invalid_argument.
TruthRun run_known(const KnownMachine& known, const Manoeuvre& manoeuvre, std::uint64_t noise_seed);

}  // namespace slewlab::diagnosis::withheld
