// What an engineer would do by hand: inertia, dry and viscous friction (each direction its own) and a constant torque by least squares,
// predicting records that were not fitted; and what the diagnosis predicts there, on the same series. Speeds and accelerations are
// differences over a few samples; effort and laws pass the mean that those differences are (a hat), so that the balance of a torque that
// is switched is exact. Of the diagnosis only its laws and forward simulation are used.
#pragma once

#include "tests/diagnosis/balance/drawn_axis.h"

namespace slewlab::diagnosis {

// Records on the axis: those that are fitted, and those that never are.
struct Split {
  std::vector<AxisRecord> fitted, unseen;
  double inertia = 0.0, top_speed = 0.0;  // of the nominal axis
};
Split split_of(const sim::MachineFile& axis, const std::vector<NamedRun>& fitted, const std::vector<NamedRun>& unseen);

// RMS over all unseen records.
struct UnseenErrors {
  double balance = 0.0;  // of the torque balance, where the axis moves
  double forward = 0.0;  // of measured minus simulated speed
};

UnseenErrors least_squares(const Split& split);
UnseenErrors predicted(const Split& split, const AxisDiagnosis& found);

}  // namespace slewlab::diagnosis
