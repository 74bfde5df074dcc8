// The controller's side of the wire: the nominal controller fed with the recorded speeds must answer with the
// recorded torques. What differs here is the controller's and nobody else's.
#pragma once

#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/record.h"

namespace slewlab::diagnosis {

struct ControllerReplay {
  std::array<std::vector<double>, sim::kMaximumGroupCount> motor_torque;  // [Nm] per cycle, as computed
  std::vector<double> difference;  // [Nm] recorded minus computed, group by group in every answered cycle
  double torque_rms = 0.0;      // [Nm] of the recorded commands
  double difference_rms = 0.0;  // [Nm] recorded minus computed
  double largest_difference = 0.0;
  double largest_time = 0.0;    // [s] of the largest difference
};

// A controller can only be followed from standstill and with the operator's moves. Throws NotAdmitted where the motors turn when the
// record begins, and where they turn and nobody asks them to.
void check_replayable(const Record& record, const controller::ControllerSettings& settings);

// A cycle whose ENCODER is missing from the log is computed with the speed between its neighbours. The settings' period and group count
// are taken from the record. Throws NotAdmitted where they cannot fit.
ControllerReplay replay_controller(const Record& record, controller::ControllerSettings settings);

}  // namespace slewlab::diagnosis
