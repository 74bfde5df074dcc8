// What a machine is made of and what drives it, without the machine itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/effect.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/integrate/plant_ports.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// An effect that begins or ends while the machine runs.
struct EffectSwitch {
  std::int64_t time = 0;  // [ns]
  std::string effect;
  bool on = true;
};

struct MachineSettings {
  CraneParameters crane;
  std::vector<common::EffectInstance> effects;
  double step = 0.001;     // [s]
  std::uint64_t seed = 0;  // of the effects that draw numbers
  double started_at = 0.0;  // [s] on the clock by which effects and motions know the time
  // By which the effects' bounds are judged: those of the nominal machine, where `crane` is a changed one. Without them
  // the crane's own.
  std::optional<common::EffectScales> scales = std::nullopt;
  // Of the drive between controller and machine (sim/drive/crane_plant.h). A Machine alone does what it is told.
  DriveProtectionSettings drive_protection{};
  std::vector<EffectSwitch> effect_switches{};  // by rising time; until the first of an effect it acts
  MotionRequests motion_requests{};  // hoisting, luffing, travelling while it slews; none costs nothing
  // Plant steps from one boom angle to the next while the boom luffs. The angle of such a stretch is that of its middle.
  int steps_per_boom_angle = 10;
};

// What the drives are told, held until the next one. All values per motor of a group, on the fast axis.
struct DriveCommand {
  std::int64_t sequence = 0;  // of the TORQUE message; a change marks a new message (jitter and loss need it)
  GroupArray motor_torque{};  // [Nm]
  GroupArray brake_torque{};  // [Nm] of the disk brake, opposes motion and holds at rest; 0 is open
  bool enable = true;         // false: the drives deliver no torque, the brakes still act
};

}  // namespace slewlab::sim
