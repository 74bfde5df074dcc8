#include "sim/machine/plausibility.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

MachineFile thesis_file() {
  MachineFile file;
  file.parameters = thesis_crane();
  return file;
}

std::vector<ImplausibleValue> found_in(const CraneParameters& crane, double step = kStep) {
  MachineFile file;
  file.parameters = crane;
  return implausible_values(file, {.plant_step = step});
}

std::string keys_of(const std::vector<ImplausibleValue>& found) {
  std::string text;
  for (const ImplausibleValue& value : found) text += (text.empty() ? "" : " ") + value.key;
  return text;
}

// The keys that are found implausible, blanks between.
std::string keys(const CraneParameters& crane, double step = kStep) { return keys_of(found_in(crane, step)); }

TEST(Plausibility, TheThesissCraneIsPlausibleAtAnyScale) {
  EXPECT_EQ(keys(thesis_crane()), "");
  for (const double factor : {1e-6, 1e-3, 1e3}) EXPECT_EQ(keys(with_masses_times(thesis_crane(), factor)), "") << factor;
}

// 60 t as 60 000 t, the slip of kg for t.
TEST(Plausibility, ALoadOfManyBooms) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 60e6;
  const auto found = found_in(crane);
  ASSERT_GE(found.size(), 1u);
  EXPECT_EQ(found[0].key, "load.mass");
  EXPECT_EQ(found[0].found, "a load of 740 times the boom's mass");  // 6e7 / 81 047
}

// 30 t as 30 kg, the slip of t for kg: less than any hook.
TEST(Plausibility, ALoadThatIsLessThanAHook) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 30.0;
  const auto found = found_in(crane);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].key, "load.mass");
  EXPECT_EQ(found[0].found, "a load of 0.00037 times the boom's mass");  // 30 / 81 047
  crane.load.mass = 500.0;
  EXPECT_EQ(keys(crane), "") << "a hook without a load";
  crane.load.mass = 0.0;
  EXPECT_EQ(keys(crane), "") << "no load at all";
}

// 252 t m^2 as 252 kg m^2, the slip of kg for t: less than a thousandth of what the boom has.
TEST(Plausibility, AHouseLessThanAnything) {
  CraneParameters crane = thesis_crane();
  crane.house.inertia *= 1e-3;
  EXPECT_EQ(keys(crane), "house.inertia");
}

// 1.08 kg m^2 as 1.08 g m^2, beside a brake of 0.037 kg m^2.
TEST(Plausibility, ARotorLighterThanItsBrake) {
  CraneParameters crane = thesis_crane();
  crane.drive.motor_inertia *= 1e-3;
  const auto found = found_in(crane);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].key, "drive.motor_inertia");
  EXPECT_EQ(found[0].found, "a rotor of 0.0292 times its brake's inertia");  // 1.08e-3 / 0.037
}

// 250 N m as 250 kN m: whatever else is judged by it, its own key is named first.
TEST(Plausibility, MotorsOfAThousandTimesTheirTorque) {
  CraneParameters crane = thesis_crane();
  crane.drive.rated_torque *= 1e3;
  const auto found = found_in(crane);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].key, "drive.rated_torque");
}

// A thousand times the stiffness is 32 times the frequency, 103 Hz: 9.7 steps of 1 ms to a period. A shorter step has more.
TEST(Plausibility, GearsTooStiffForTheStep) {
  CraneParameters crane = thesis_crane();
  crane.drive.gearbox_stiffness *= 1000.0;
  EXPECT_EQ(keys(crane), "drive.gearbox_stiffness");
  EXPECT_EQ(keys(crane, 1e-4), "");
  EXPECT_EQ(keys(crane, 0.0), "") << "no step is known";
}

TEST(Plausibility, RopesThatAreNoRopes) {
  CraneParameters crane = thesis_crane();
  crane.load.rope_length = 1e-3;  // millimetres for metres
  EXPECT_EQ(keys(crane), "load.rope_length");
  crane.load.rope_length = 6e3;
  EXPECT_EQ(keys(crane), "load.rope_length");
}

TEST(Plausibility, ABoomOfJelly) {
  CraneParameters crane = thesis_crane();
  crane.boom.youngs_modulus *= 1e-3;  // MPa for GPa
  crane.boom.shear_modulus *= 1e-3;
  EXPECT_EQ(keys(crane), "boom.youngs_modulus");
}

// Each by a factor that another unit of the same kind makes, or a shift of the point: the key is named, and it alone.
TEST(Plausibility, SlipsOfUnitAreNamedByTheirKey) {
  const struct {
    const char* key;
    void (*slip)(CraneParameters&);
  } kSlips[] = {
      {"load.rope_length", [](CraneParameters& crane) { crane.load.rope_length *= 1e-3; }},          // mm for m
      {"load.rod_length", [](CraneParameters& crane) { crane.load.rod_length *= 1e3; }},             // m for mm
      {"boom.mass", [](CraneParameters& crane) { crane.boom.mass *= 1e3; }},                         // t for kg
      {"boom.chord_outer_diameter", [](CraneParameters& crane) { crane.boom.chord_outer_diameter = 2.67; }},  // for 0.267
      {"boom.torsion_constant", [](CraneParameters& crane) { crane.boom.torsion_constant *= 1e6; }},
      {"boom.torsion_constant", [](CraneParameters& crane) { crane.boom.torsion_constant *= 1e-12; }},  // mm^4 for m^4
      {"boom.torsion_constant", [](CraneParameters& crane) { crane.boom.shear_modulus *= 1e-6; }},      // kPa for GPa
      {"house.sensor_radius", [](CraneParameters& crane) { crane.house.sensor_radius *= 1e3; }},        // m for mm
      {"drive.gearbox_play", [](CraneParameters& crane) { crane.drive.gearbox_play *= 57.3; }},         // rad for deg
      {"drive.pinion_play", [](CraneParameters& crane) { crane.drive.pinion_play *= 57.3; }},
      {"drive.motor_inertia", [](CraneParameters& crane) { crane.drive.gearbox_ratio = 21540.0; }},    // for 215.40
  };
  for (const auto& slip : kSlips) {
    CraneParameters crane = thesis_crane();
    slip.slip(crane);
    EXPECT_EQ(keys(crane, 0.0), slip.key);
  }
}

TEST(Plausibility, ADriveThatGivesTooMuchOrTooLittle) {
  MachineFile file = thesis_file();
  file.drive_protection.torque_limit = 400.0;
  file.drive_protection.brake.torque = 400.0;
  EXPECT_EQ(keys_of(implausible_values(file, {})), "");
  file.drive_protection.torque_limit = 400e3;  // kN m for N m
  file.drive_protection.brake.torque = 0.4;
  EXPECT_EQ(keys_of(implausible_values(file, {})), "drive_protection.torque_limit drive_protection.brake.torque");
}

// Between two commands the counter cannot move: with less than a period the drive would trip at once.
TEST(Plausibility, ATimeOutShorterThanTheControllersPeriod) {
  MachineFile file = thesis_file();
  file.drive_protection.alive_timeout = file.drive_protection.silence_timeout = 100'000;  // [ns] us for ms
  EXPECT_EQ(keys_of(implausible_values(file, {})), "") << "no period is known";
  const auto found = implausible_values(file, {.plant_step = kStep, .controller_period = 10'000'000});
  EXPECT_EQ(keys_of(found), "drive_protection.alive_timeout drive_protection.silence_timeout");
  EXPECT_EQ(found.at(0).found, "a time-out of 0.01 controller periods, so that the drive trips between two commands");
}

// A hundred seconds for a hundred milliseconds are ten thousand periods of 10 ms.
TEST(Plausibility, ATimeOutThatIsNone) {
  MachineFile file = thesis_file();
  const RunPeriods periods{.plant_step = kStep, .controller_period = 10'000'000};
  EXPECT_EQ(keys_of(implausible_values(file, periods)), "") << "a drive that watches nothing";
  file.drive_protection.alive_timeout = 100'000'000'000;
  const auto found = implausible_values(file, periods);
  ASSERT_EQ(keys_of(found), "drive_protection.alive_timeout");
  EXPECT_EQ(found.at(0).found, "a time-out of 1e+04 controller periods, for which the drive goes on with the last command");
}

// t m^2 for kg m^2.
TEST(Plausibility, AHouseThatIsHeavierToTurnThanItsBoom) {
  CraneParameters crane = thesis_crane();
  crane.house.inertia *= 1e3;
  EXPECT_EQ(keys(crane), "house.inertia");
}

MachineFile rigid_table() {
  MachineFile file;
  file.kind = MachineKind::axis;
  file.parameters.boom.element_count = 0;
  file.parameters.drive = {.group_count = 1, .motors_per_group = 1, .gearbox_ratio = 80.0, .rated_torque = 6.0, .top_speed = 1.0, .is_rigid = true};
  file.parameters.house.inertia = 40.0;
  return file;
}

// 40 kg m^2 under 6 N m at a ratio of 80 reach 1 rad/s in 40 / 480 s; a thousand times as much, t for kg, in 83 s, a millionth in 83 ns.
TEST(Plausibility, AnAxisThatNoMotorWouldMove) {
  MachineFile file = rigid_table();
  EXPECT_EQ(keys_of(implausible_values(file, {})), "");
  file.parameters.house.inertia = 40e3;
  const auto found = implausible_values(file, {});
  ASSERT_EQ(keys_of(found), "rated_torque");
  EXPECT_EQ(found.at(0).found, "83.3 s from rest to top speed: inertia and top_speed against all that the motor is rated for");
  file.parameters.house.inertia = 40e-6;
  EXPECT_EQ(keys_of(implausible_values(file, {})), "rated_torque");
}

// The motor is rated for 480 N m on the axis.
TEST(Plausibility, AnAxissLoadThatItsMotorCannotHold) {
  MachineFile file = rigid_table();
  file.parameters.axis_force = {.constant = -400.0, .gravity = -120.0};
  EXPECT_EQ(keys_of(implausible_values(file, {})), "");
  file.parameters.axis_force = {.constant = 0.0, .gravity = -120e6};  // MN m for N m
  const auto found = implausible_values(file, {});
  ASSERT_EQ(keys_of(found), "load.gravity");
  EXPECT_EQ(found.at(0).found, "gravity of 2.5e+05 times what the motor is rated for, on the axis");
  file.parameters.axis_force = {.constant = -490.0};
  EXPECT_EQ(keys_of(implausible_values(file, {})), "load.constant");
}

// What is judged are ratios: an axis of a millionth or a million times the inertia, with torques to match, is the same.
TEST(Plausibility, AnAxisIsPlausibleAtAnyScale) {
  for (const double factor : {1e-6, 1e-3, 1e3, 1e6}) {
    MachineFile file = rigid_table();
    file.parameters.house.inertia *= factor;
    file.parameters.drive.rated_torque *= factor;
    file.parameters.axis_force = {.gravity = -120.0 * factor};
    EXPECT_EQ(keys_of(implausible_values(file, {})), "") << factor;
  }
}

// A tilting table of 40 kg m^2 behind a gearbox that gives: 22 Hz, 0.1 s to its top speed, two arc minutes of play.
TEST(Plausibility, AnElasticAxissSlipsAreNamedByItsOwnKeys) {
  MachineFile table;
  table.kind = MachineKind::axis;
  table.parameters.boom.element_count = 0;
  table.parameters.drive = {.group_count = 1, .motors_per_group = 1, .motor_inertia = 0.0015, .gearbox_ratio = 80.0, .gearbox_stiffness = 150e3,
                            .gear_damping_ratio = 0.05, .gearbox_play = 6e-4, .rated_torque = 6.0, .top_speed = 1.0};
  table.parameters.house.inertia = 40.0;
  EXPECT_EQ(keys_of(implausible_values(table, {.plant_step = kStep})), "");
  const struct {
    const char* key;
    void (*slip)(DriveParameters&);
  } kSlips[] = {{"motor_inertia", [](DriveParameters& drive) { drive.motor_inertia *= 1e-6; }},
                {"transmission.stiffness", [](DriveParameters& drive) { drive.gearbox_stiffness *= 1e-3; }},  // N m/rad for kN m/rad
                {"transmission.play", [](DriveParameters& drive) { drive.gearbox_play *= 1e3; }}};            // rad for mrad
  for (const auto& slip : kSlips) {
    MachineFile other = table;
    slip.slip(other.parameters.drive);
    EXPECT_EQ(keys_of(implausible_values(other, {})), slip.key);
  }
}

}  // namespace
}  // namespace slewlab::sim
