#include "sim/machine/machine_file.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "sim/model/boom.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

const std::string kFolder = SLEWLAB_SOURCE_DIR "/config/cranes/";

std::string complaint(const std::vector<common::Override>& overrides, const std::string& name = "thesis.yaml") {
  try {
    load_machine_file(kFolder + name, overrides);
  } catch (const common::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CraneFile, ThesisCraneIsTheOneOfTheUnitTests) {
  const CraneParameters file = load_machine_file(kFolder + "thesis.yaml").parameters;
  const CraneParameters crane = thesis_crane();
  EXPECT_EQ(file.drive.group_count, crane.drive.group_count);
  EXPECT_EQ(file.drive.motors_per_group, crane.drive.motors_per_group);
  EXPECT_DOUBLE_EQ(file.drive.motor_inertia, crane.drive.motor_inertia);
  EXPECT_DOUBLE_EQ(file.drive.brake_inertia, crane.drive.brake_inertia);
  EXPECT_DOUBLE_EQ(file.drive.gearbox_inertia, crane.drive.gearbox_inertia);
  EXPECT_DOUBLE_EQ(file.drive.gearbox_ratio, crane.drive.gearbox_ratio);
  EXPECT_DOUBLE_EQ(file.drive.pinion_ratio, crane.drive.pinion_ratio);
  EXPECT_DOUBLE_EQ(file.drive.gearbox_stiffness, crane.drive.gearbox_stiffness);
  EXPECT_DOUBLE_EQ(file.drive.gear_damping_ratio, crane.drive.gear_damping_ratio);
  EXPECT_DOUBLE_EQ(file.drive.gearbox_play, crane.drive.gearbox_play);
  EXPECT_DOUBLE_EQ(file.drive.pinion_play, crane.drive.pinion_play);
  EXPECT_DOUBLE_EQ(file.drive.rated_torque, crane.drive.rated_torque);
  EXPECT_DOUBLE_EQ(file.drive.top_speed, crane.drive.top_speed);
  EXPECT_EQ(file.drive.pinion_teeth, crane.drive.pinion_teeth);
  EXPECT_EQ(file.drive.gearbox_ring_teeth, crane.drive.gearbox_ring_teeth);
  EXPECT_EQ(file.drive.gearbox_sun_teeth, crane.drive.gearbox_sun_teeth);
  EXPECT_DOUBLE_EQ(file.house.inertia, crane.house.inertia);
  EXPECT_DOUBLE_EQ(file.house.sensor_radius, crane.house.sensor_radius);
  EXPECT_EQ(file.boom.element_count, crane.boom.element_count);
  EXPECT_DOUBLE_EQ(file.boom.length, crane.boom.length);
  EXPECT_DOUBLE_EQ(file.boom.mass, crane.boom.mass);
  EXPECT_DOUBLE_EQ(file.boom.angle, crane.boom.angle);
  EXPECT_DOUBLE_EQ(file.boom.pivot_radius, crane.boom.pivot_radius);
  EXPECT_DOUBLE_EQ(file.boom.chord_outer_diameter, crane.boom.chord_outer_diameter);
  EXPECT_DOUBLE_EQ(file.boom.chord_inner_diameter, crane.boom.chord_inner_diameter);
  EXPECT_DOUBLE_EQ(file.boom.youngs_modulus, crane.boom.youngs_modulus);
  EXPECT_DOUBLE_EQ(file.boom.shear_modulus, crane.boom.shear_modulus);
  EXPECT_DOUBLE_EQ(file.boom.torsion_constant, crane.boom.torsion_constant);
  EXPECT_DOUBLE_EQ(file.boom.damping_ratio, crane.boom.damping_ratio);
  ASSERT_EQ(file.boom.profile.size(), crane.boom.profile.size());
  for (std::size_t i = 0; i < crane.boom.profile.size(); ++i) {
    EXPECT_DOUBLE_EQ(file.boom.profile[i].position, crane.boom.profile[i].position);
    EXPECT_DOUBLE_EQ(file.boom.profile[i].half_width, crane.boom.profile[i].half_width);
    EXPECT_DOUBLE_EQ(file.boom.profile[i].half_height, crane.boom.profile[i].half_height);
  }
  EXPECT_DOUBLE_EQ(file.load.mass, crane.load.mass);
  EXPECT_DOUBLE_EQ(file.load.rope_length, crane.load.rope_length);
  EXPECT_DOUBLE_EQ(file.load.rod_length, crane.load.rod_length);
  EXPECT_DOUBLE_EQ(file.load.damping_ratio, crane.load.damping_ratio);
}

TEST(CraneFile, SmallMachinesAreValid) {
  EXPECT_EQ(load_machine_file(kFolder + "rigid_boom.yaml").parameters.boom.element_count, 0);
  EXPECT_EQ(load_machine_file(kFolder + "no_load.yaml").parameters.load.mass, 0.0);
  const DriveParameters one = load_machine_file(kFolder + "one_group.yaml").parameters.drive;
  EXPECT_EQ(one.group_count, 1);
  EXPECT_EQ(one.group_count * one.motors_per_group, 6);
  EXPECT_EQ(load_machine_file(kFolder + "no_play.yaml").parameters.drive.pinion_play, 0.0);
  const CraneParameters bare = load_machine_file(kFolder + "no_load.yaml", {{"boom", "null"}}).parameters;
  EXPECT_EQ(bare.boom.element_count, 0);
  EXPECT_EQ(bare.boom.mass, 0.0);
}

// Whoever does not know the teeth leaves them out; half a planetary stage says nothing of its mesh.
TEST(CraneFile, TeethMayBeLeftOut) {
  const DriveParameters unknown = load_machine_file(kFolder + "thesis.yaml", {{"drive.pinion_teeth", "null"},
                                                                             {"drive.gearbox_ring_teeth", "null"},
                                                                             {"drive.gearbox_sun_teeth", "null"}}).parameters.drive;
  EXPECT_EQ(unknown.pinion_teeth, 0);
  EXPECT_EQ(unknown.gearbox_ring_teeth, 0);
  EXPECT_EQ(unknown.gearbox_sun_teeth, 0);
  EXPECT_NE(complaint({{"drive.gearbox_sun_teeth", "null"}}).find("key 'drive.gearbox_sun_teeth': found nothing: the key is missing"),
            std::string::npos)
      << complaint({{"drive.gearbox_sun_teeth", "null"}});
  EXPECT_NE(complaint({{"drive.pinion_teeth", "2"}}).find("key 'drive.pinion_teeth'"), std::string::npos);
}

TEST(CraneFile, KeepsTheEffectsAsTheyAre) {
  const MachineFile file = load_machine_file(kFolder + "thesis.yaml", {{"effects", "{wind: {speed: 3}}"}});
  ASSERT_NE(file.effects.find("wind"), nullptr);
  EXPECT_EQ(load_machine_file(kFolder + "thesis.yaml").effects.kind, common::YamlNode::Kind::null);
  EXPECT_NE(file.canonical_text, load_machine_file(kFolder + "thesis.yaml").canonical_text);
}

TEST(CraneFile, ReadsTheDriveProtectionInItsUnits) {
  const DriveProtectionSettings protection =
      load_machine_file(kFolder + "thesis.yaml", {{"drive_protection.silence_timeout", "120 ms"}}).drive_protection;
  EXPECT_EQ(protection.silence_timeout, 120'000'000);  // [ns]
  EXPECT_EQ(protection.brake.closing_delay, 80'000'000);
  EXPECT_DOUBLE_EQ(protection.brake.closing_time_constant, 0.06);
  EXPECT_EQ(protection.answer_age_limit, 1);
  const DriveProtectionSettings none = load_machine_file(kFolder + "thesis.yaml", {{"drive_protection", "null"}}).drive_protection;
  EXPECT_EQ(none.silence_timeout, kNever);
  EXPECT_EQ(none.brake.torque, 0.0);
  EXPECT_NE(complaint({{"drive_protection.torque_limit", "0"}}).find("above 0 N m"), std::string::npos)
      << complaint({{"drive_protection.torque_limit", "0"}});
}

TEST(CraneFile, BadValuesAreExplained) {
  EXPECT_EQ(complaint({{"load.mass", "-30 t"}}),
            "--set load.mass=-30 t: key 'load.mass': found -30 t, expected a number of at least 0 t");
  EXPECT_EQ(complaint({{"boom.angle", "120 deg"}}).find("--set boom.angle=120 deg: key 'boom.angle': found 120 deg, expected a number from"),
            0u);
  EXPECT_NE(complaint({{"boom.angel", "50"}}).find("key 'boom.angel': found a key that is not known here, "
                                                   "expected 'angle' (or one of"),
            std::string::npos);
  EXPECT_EQ(complaint({{"boom.chord_inner_diameter", "300 mm"}}),
            "--set boom.chord_inner_diameter=300 mm: key 'boom.chord_inner_diameter': found 0.3 m, "
            "expected less than chord_outer_diameter, 0.267 m");
  EXPECT_EQ(complaint({{"boom.profile.half_width", "[1, 2]"}}),
            "--set boom.profile.half_width=[1, 2]: key 'boom.profile.half_width': found a list of 2, "
            "expected as many numbers as 'position' has: 6");
  EXPECT_NE(complaint({{"boom.profile.position", "[0, 0.2, 0.2, 0.6, 0.8, 1]"}}).find("expected numbers that rise"),
            std::string::npos);
  EXPECT_NE(complaint({{"house", "null"}}).find("key 'house': found nothing: the key is missing"), std::string::npos);
  EXPECT_NE(complaint({{"kind", "controller"}}).find("key 'kind': found controller, expected crane"),
            std::string::npos);
}

TEST(CraneFile, BoomTypesHaveTheirOwnKeys) {
  const BoomParameters box = load_machine_file(kFolder + "box_girder.yaml").parameters.boom;
  EXPECT_EQ(box.type, BoomType::box_girder);
  EXPECT_DOUBLE_EQ(box.side_plate, 0.016);
  const BoomParameters bent = load_machine_file(kFolder + "knuckle.yaml").parameters.boom;
  EXPECT_EQ(bent.type, BoomType::knuckle);
  EXPECT_DOUBLE_EQ(bent.knuckle_position, 0.55);
  const BoomParameters frame = load_machine_file(kFolder + "a_frame.yaml").parameters.boom;
  EXPECT_EQ(frame.type, BoomType::a_frame);
  EXPECT_GT(frame.cylinders.force, 0.0);

  EXPECT_NE(complaint({{"boom.type", "{value: truss, source: test}"}}).find("key 'boom.type': found truss, expected"), std::string::npos) << complaint({{"boom.type", "{value: truss, source: test}"}});
  EXPECT_NE(complaint({{"boom.type", "{value: box_girder, source: test}"}}).find("key 'boom.side_plate'"), std::string::npos) << complaint({{"boom.type", "{value: box_girder, source: test}"}});
  EXPECT_NE(complaint({{"boom.type", "{value: box_girder, source: test}"}}).find("key 'boom.torsion_constant': found a key of other boom types, expected no such key, or null, or boom.type lattice or a_frame"),
            std::string::npos);
  EXPECT_NE(complaint({{"boom.side_plate", "800 mm"}}, "box_girder.yaml").find("key 'boom.side_plate': found 0.8 m, expected less than half_width everywhere"),
            std::string::npos)
      << complaint({{"boom.side_plate", "800 mm"}}, "box_girder.yaml");
  EXPECT_NE(complaint({{"boom.elements", "1"}}, "knuckle.yaml").find("key 'boom.elements': found 1, expected 2 or more"), std::string::npos);
}

TEST(CraneFile, MotionsAreReadWithTheirLimits) {
  const MotionParameters motions = load_machine_file(kFolder + "thesis_moving.yaml").parameters.motions;
  EXPECT_DOUBLE_EQ(motions.hoisting.top_speed, 0.5);
  EXPECT_DOUBLE_EQ(motions.shortest_rope, 8.0);
  EXPECT_DOUBLE_EQ(motions.luffing.acceleration, 0.5 * std::numbers::pi / 180.0);
  EXPECT_EQ(load_machine_file(kFolder + "thesis.yaml").parameters.motions.travelling.top_speed, 0.0);

  EXPECT_NE(complaint({{"hoisting.shortest_rope", "70 m"}}, "thesis_moving.yaml").find("found 70 m, expected not more than load.rope_length, 60 m"), std::string::npos)
      << complaint({{"hoisting.shortest_rope", "70 m"}}, "thesis_moving.yaml");
  EXPECT_NE(complaint({{"boom.angle", "10 deg"}}, "thesis_moving.yaml").find("a range with boom.angle in it"), std::string::npos);
  // A boom on cylinders goes as far as their lever and their oil do.
  const CraneParameters frame = load_machine_file(kFolder + "a_frame.yaml").parameters;
  EXPECT_GT(frame.motions.luffing.top_speed, 0.0);
  EXPECT_GT(oil_column(frame.boom, frame.motions.lowest_angle), 0.4);  // [m]
  EXPECT_NE(complaint({{"luffing.lowest_angle", "30 deg"}}, "a_frame.yaml").find("key 'luffing.lowest_angle': found 30 deg, where the cylinders have an oil column of -"), std::string::npos)
      << complaint({{"luffing.lowest_angle", "30 deg"}}, "a_frame.yaml");
  EXPECT_NE(complaint({{"luffing.lowest_angle", "0 deg"}, {"boom.luffing_cylinders.base_radius", "2.5 m"}, {"boom.luffing_cylinders.base_height", "0.1 m"}}, "a_frame.yaml").find("about the pivot"), std::string::npos)
      << complaint({{"luffing.lowest_angle", "0 deg"}, {"boom.luffing_cylinders.base_radius", "2.5 m"}, {"boom.luffing_cylinders.base_height", "0.1 m"}}, "a_frame.yaml");
  EXPECT_NE(complaint({{"load", "null"}}, "thesis_moving.yaml").find("key 'hoisting': found a winch"), std::string::npos) << complaint({{"load", "null"}}, "thesis_moving.yaml");
}

}  // namespace
}  // namespace slewlab::sim
