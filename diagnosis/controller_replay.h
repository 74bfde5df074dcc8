// The controller's side of the wire: the nominal controller fed with the recorded speeds must answer with the
// recorded torques. What differs here is the controller's and nobody else's.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/record.h"

namespace slewlab::diagnosis {

struct ControllerReplay {
  std::array<std::vector<double>, sim::kMaximumGroupCount> motor_torque;  // [Nm] per cycle, as computed
  std::vector<double> difference;  // [Nm] recorded minus computed, group by group in every answered cycle that is compared
  double torque_rms = 0.0;      // [Nm] of the recorded commands
  double difference_rms = 0.0;  // [Nm] recorded minus computed
  double largest_difference = 0.0;
  double largest_time = 0.0;    // [s] of the largest difference
  double change_square = 0.0;   // [Nm^2] sum over the changes of the difference that GiveUp speaks of, as far as the replay went
  bool is_given_up = false;     // before the record's end; the torque's and the difference's size are not filled
};

// Where only a replay is of use whose difference, or its change over so many entries where `lag` is not 0, stays small: the sum of squares
// beyond which nobody wants to know the rest.
struct GiveUp {
  std::size_t lag = 0;
  double above = std::numeric_limits<double>::infinity();  // [Nm^2]
};

// Throws NotAdmitted where the motors turn and nobody asks them to.
void check_replayable(const Record& record);

// [s] From when on the controller's state is known: of a record that begins at rest, from its beginning, or where the drives were on before,
// a few cycles later; of one in motion, from when the joystick has stood still for so long that the ramp has come to its end, whatever it
// did before, or the measured speed shows that it has. Where the integrals are to be told by an answer, from the first one on that is not limited. Nothing where there is no such moment.
std::optional<double> controller_known_from(const Record& record, const controller::ControllerSettings& settings);

// A cycle whose ENCODER is missing from the log is computed with the speed between its neighbours. The settings' period and group count
// are taken from the record. Until `known_from` [s] its integrals are those with which it answers as was recorded, and only what follows is
// compared; nothing where it is never known. Throws NotAdmitted where they cannot fit.
ControllerReplay replay_controller(const Record& record, controller::ControllerSettings settings, std::optional<double> known_from,
                                   const GiveUp& give_up = {});
// From when the settings themselves say that the controller is known. Other settings are compared over the same cycles from that moment.
ControllerReplay replay_controller(const Record& record, const controller::ControllerSettings& settings);

}  // namespace slewlab::diagnosis
