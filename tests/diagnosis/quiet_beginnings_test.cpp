#include "diagnosis/quiet_beginnings.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/machine/description.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis {
namespace {

// Of two records behind moves the boom of the second one rings: that one's rod and boom are at rest, its load and motors stay, and the first record is as it was.
TEST(QuietBeginnings, AreOfTheRecordInWhichTheBoomRings) {
  Nuisances nuisances = nuisances_of(sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/harbour_5t.yaml")), 3e-4);
  nuisances.has_motion = true;
  nuisances.offset_groups = 2;
  nuisances.begins = {RecordBegins::in_motion, RecordBegins::at_rest};
  Point point;
  point.nuisance.assign(nuisances.count(2), 1.5);
  Point quiet = point;
  EXPECT_FALSE(quieten_beginnings(nuisances, quiet)) << "no farther than machines swing";
  EXPECT_EQ(quiet.nuisance, point.nuisance);
  const std::size_t motion = nuisances.count(1) + nuisances.swing_amounts() + nuisances.offset_groups;
  point.nuisance[motion + nuisances.swing_amounts() + 3] = -6.0;  // the rate of the second bend
  quiet = point;
  EXPECT_TRUE(quieten_beginnings(nuisances, quiet));
  const Beginning first = beginning_of(nuisances, quiet.nuisance, 0), second = beginning_of(nuisances, quiet.nuisance, 1), was = beginning_of(nuisances, point.nuisance, 1);
  EXPECT_EQ(first.rod, 1.5 * kSwingDeviation);
  EXPECT_EQ(first.bend_rate[1], 1.5 * kBendDeviation);
  EXPECT_EQ(was.bend_rate[1], -6.0 * kBendDeviation);
  EXPECT_EQ(second.swing, was.swing);
  EXPECT_EQ(second.motor_offset[1], was.motor_offset[1]);
  for (const double amount : {second.rod, second.rod_rate, second.bend[0], second.bend[1], second.bend_rate[0], second.bend_rate[1], second.outwards}) EXPECT_EQ(amount, 0.0);
  EXPECT_FALSE(quieten_beginnings(nuisances, quiet));
}

// A machine that has not moved before has neither.
TEST(QuietBeginnings, AreNoneWhereNothingMoved) {
  const Nuisances nuisances = nuisances_of(sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/harbour_5t.yaml")), 3e-4);
  Point point;
  point.nuisance.assign(nuisances.count(1), 5.0);
  EXPECT_FALSE(quieten_beginnings(nuisances, point));
}

}  // namespace
}  // namespace slewlab::diagnosis
