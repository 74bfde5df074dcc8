#include "sim/machine/axis_file.h"

#include <numbers>

#include "sim/machine/drive_protection_file.h"
#include "sim/machine/possible_value.h"
#include "sim/machine/sensors_file.h"

namespace slewlab::sim {
namespace {

using common::any_number;
using common::between;
using common::positive;
using common::Unit;
using common::YamlReader;

constexpr double kTurn = 2.0 * std::numbers::pi;  // [rad]

// A key that belongs to the other form of axis, told in words instead of as unknown.
void refuse(YamlReader& reader, std::string_view key, std::string_view why) {
  if (reader.has(key)) reader.report(key, "'" + std::string(key) + "'", std::string(why));
}

void read_transmission(YamlReader reader, bool is_linear, DriveParameters& drive) {
  drive.gearbox_stiffness =
      sized(reader, "stiffness", is_linear ? Unit::newton_per_metre : Unit::newton_metre_per_radian, positive(), kStiffness);
  drive.gear_damping_ratio = reader.number("damping_ratio", Unit::none, between(0.0, 1.0));
  drive.gearbox_play = reader.optional_number("play", is_linear ? Unit::metre : Unit::radian, between(0.0, is_linear ? kLength.most : kTurn)).value_or(0.0);
  reader.finish();
}

AxisForceParameters read_load(YamlReader reader, bool is_linear) {
  AxisForceParameters load;
  load.constant = optional_sized(reader, "constant", is_linear ? Unit::newton : Unit::newton_metre, any_number(), kTorque).value_or(0.0);
  if (is_linear) {
    refuse(reader, "gravity", "nothing: the weight of a linear axis is the same everywhere, load.constant in N");
    refuse(reader, "gravity_angle", "nothing: a linear axis has no angle");
  } else if (reader.has("gravity") || reader.has("gravity_angle")) {
    load.gravity = sized(reader, "gravity", Unit::newton_metre, any_number(), kTorque);
    load.gravity_angle = reader.number("gravity_angle", Unit::radian, between(-kTurn, kTurn));
  }
  reader.finish();
  return load;
}

}  // namespace

void read_axis(YamlReader& reader, MachineFile& file) {
  reader.heading("axis");
  AxisForm& form = file.axis;
  DriveParameters& drive = file.parameters.drive;
  form.is_linear = reader.choice("coordinate", {"rotary", "linear"}) == 1;
  drive.group_count = drive.motors_per_group = 1;

  if (form.is_linear) {
    file.parameters.house.inertia = sized(reader, "mass", Unit::kilogram, positive(), kMass);
    const auto travel = optional_sized(reader, "travel_per_turn", Unit::metre, positive(), kTravel);
    form.is_shaft_linear = !travel;
    drive.gearbox_ratio = travel ? kTurn / *travel : 1.0;
    refuse(reader, "inertia", "'mass' in kg: the axis is linear");
    refuse(reader, "ratio", "'travel_per_turn' in m: the axis is linear");
  } else {
    file.parameters.house.inertia = sized(reader, "inertia", Unit::kilogram_square_metre, positive(), kInertia);
    drive.gearbox_ratio = optional_sized(reader, "ratio", Unit::none, positive(), kRatio).value_or(1.0);
    refuse(reader, "mass", "'inertia' in kg m^2: the axis is rotary");
    refuse(reader, "travel_per_turn", "'ratio': the axis is rotary");
  }

  const std::string_view own = form.is_shaft_linear ? "motor_mass" : "motor_inertia";
  drive.motor_inertia = optional_sized(reader, own, form.is_shaft_linear ? Unit::kilogram : Unit::kilogram_square_metre, positive(),
                                       form.is_shaft_linear ? kMass : kInertia)
                            .value_or(0.0);
  refuse(reader, form.is_shaft_linear ? "motor_inertia" : "motor_mass",
         form.is_shaft_linear ? "'motor_mass' in kg, or a 'travel_per_turn': without one the motor does not turn"
                              : "'motor_inertia' in kg m^2: the motor turns");
  drive.is_rigid = !reader.has("transmission");
  if (!drive.is_rigid) {
    read_transmission(reader.map("transmission"), form.is_linear, drive);
    if (drive.motor_inertia == 0.0) {
      reader.report("transmission", "a transmission that gives, and no '" + std::string(own) + "'",
                    "'" + std::string(own) + "' above 0: it swings against what the axis moves");
    }
  }
  if (reader.has("load")) file.parameters.axis_force = read_load(reader.map("load"), form.is_linear);
  file.parameters.house.has_encoder = reader.has("load_encoder") && reader.flag("load_encoder");

  drive.rated_torque = form.is_shaft_linear ? sized(reader, "rated_force", Unit::newton, positive(), kTorque)
                                            : sized(reader, "rated_torque", Unit::newton_metre, positive(), kTorque);
  refuse(reader, form.is_shaft_linear ? "rated_torque" : "rated_force",
         form.is_shaft_linear ? "'rated_force' in N: without 'travel_per_turn' the motor does not turn"
                              : "'rated_torque' in N m, of the motor");
  drive.top_speed = sized(reader, "top_speed", form.is_linear ? Unit::metre_per_second : Unit::radian_per_second, positive(), kSpeed);
  if (reader.has("sensors")) file.parameters.sensors = read_axis_sensors(reader.map("sensors"), form.is_linear, form.is_shaft_linear);
  if (reader.has("drive_protection")) {
    file.drive_protection = read_drive_protection(reader.map("drive_protection"), form.is_shaft_linear ? kLinearShaft : ShaftUnits{});
  }
  file.parameters.boom.element_count = 0;
}

}  // namespace slewlab::sim
