// What would tell two causes apart that the records given do not: both fitted machines run the same manoeuvres in closed loop, and
// the signal in which their predictions differ most, against what an ordinary sensor of it makes of noise, is the one
// to record (Hunter, Reiner 1965: the experiment that discriminates best is the one in which the rival models' predictions are
// farthest apart).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/record.h"
#include "sim/integrate/machine_settings.h"
#include "sim/machine/description.h"

namespace slewlab::diagnosis {

struct Separation {
  std::string manoeuvre;
  std::string signal;
  std::string unit;
  double difference = 0.0;    // [unit] RMS of one prediction minus the other
  double noise_floors = 0.0;  // the same over the signal's noise
};

// What the operator asks for, in ramps of the controller from rest to top speed.
struct SpeedRequest {
  double time = 0.0;   // [ramps]
  double speed = 0.0;  // [-]
};
struct Manoeuvre {
  std::string name;
  std::vector<SpeedRequest> requests;
};
inline constexpr double kManoeuvreDuration = 6.8;  // [ramps]

const std::vector<Manoeuvre>& usual_manoeuvres();

// A record of the manoeuvre with no signal in it yet, at the controller's period or a step near `machine_step` [s] that divides it.
Record blank_record(const Manoeuvre& manoeuvre, const controller::ControllerSettings& controller, double machine_step);

// By unit: the noise of the machine's sensors, and what that of a speed becomes in a commanded torque.
std::map<std::string, double, std::less<>> noise_floors(const sim::MachineDescription& machine, const controller::ControllerSettings& controller);

// Below this many noise floors a difference is not called one.
inline constexpr double kSeparated = 3.0;

// Of every manoeuvre and signal, the farthest apart first: a slew there and back at half and at full speed, inching, a reversal at full
// speed without a stop. Throws std::invalid_argument where machine and controller do not fit each other.
std::vector<Separation> separations(const sim::MachineSettings& one, const sim::MachineSettings& other,
                                    const controller::ControllerSettings& controller);

}  // namespace slewlab::diagnosis
