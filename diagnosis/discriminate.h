// What would tell two causes apart that the records given do not: both fitted machines run the same manoeuvres in closed loop, and
// the signal in which their predictions differ most, against what an ordinary sensor of it makes of noise, is the one
// to record (Hunter, Reiner 1965: the experiment that discriminates best is the one in which the rival models' predictions are
// farthest apart).
#pragma once

#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/record.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

struct Separation {
  std::string manoeuvre;
  std::string signal;
  std::string unit;
  double difference = 0.0;    // [unit] RMS of one prediction minus the other
  double noise_floors = 0.0;  // the same over the signal's noise
};

// Below this many noise floors a difference is not called one.
inline constexpr double kSeparated = 3.0;

// Of every manoeuvre and signal, the farthest apart first: a slew there and back at half and at full speed, inching, a reversal at full
// speed without a stop. Throws std::invalid_argument where machine and controller do not fit each other.
std::vector<Separation> separations(const sim::MachineSettings& one, const sim::MachineSettings& other,
                                    const controller::ControllerSettings& controller);

}  // namespace slewlab::diagnosis
