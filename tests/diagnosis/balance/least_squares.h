// What an engineer would do by hand: inertia, dry and viscous friction (each direction its own) and a constant torque by least squares,
// predicting records that were not fitted; and what the diagnosis predicts there, on the same series. Speeds and accelerations are
// differences over a few samples; effort and laws pass the mean that those differences are (a hat), so that the balance of a torque that
// is switched is exact. Of the diagnosis only its laws and forward simulation are used.
#pragma once

#include "tests/diagnosis/balance/drawn_axis.h"

namespace slewlab::diagnosis {

// RMS over all unseen records.
struct Prediction {
  double balance = 0.0;  // of the torque balance, where the axis moves
  double forward = 0.0;  // of measured minus simulated speed
};

Prediction least_squares(const sim::MachineFile& axis, const DrawnAxis& drawn);
Prediction predicted(const sim::MachineFile& axis, const DrawnAxis& drawn, const AxisDiagnosis& found);

}  // namespace slewlab::diagnosis
