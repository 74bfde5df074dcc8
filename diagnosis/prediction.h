// What a model says of a manoeuvre that it has not seen: machine and controller in closed loop from the
// operator's moves alone, against what was measured, per signal.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/record.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

struct SignalGap {
  std::string signal;
  std::string unit;
  double measured = 0.0;  // RMS about its mean
  double gap = 0.0;       // RMS of measured minus predicted
};

SignalGap gap_between(const std::string& signal, const char* unit, std::span<const double> measured, std::span<const double> predicted);

// Of torques, shaft speeds and the accelerations that were measured, from `from_time` [s] on; of accelerations what differs more than the
// mean, which may be the sensor's offset.
std::vector<SignalGap> signal_gaps(const Record& measured, const Record& predicted, double from_time = 0.0);

struct Prediction {
  Record series;                 // on the grid of the record it was made for; only its signals are filled
  std::vector<SignalGap> gaps;
  double relative_gap = 0.0;     // root of the mean square, over signals, of gap / measured
};

// The gaps count from `from_time` [s] on.
Prediction predict(const sim::MachineSettings& machine, const controller::ControllerSettings& controller,
                   const Record& record, double from_time = 0.0);

}  // namespace slewlab::diagnosis
