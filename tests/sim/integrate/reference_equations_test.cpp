#include "sim/integrate/reference_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

ReferenceEquations thesis_equations() { return make_reference_equations(reference_machine(thesis_crane()), {}); }

TEST(ReferenceEquations, RefusesMachinesThatCannotBe) {
  CraneParameters crane = thesis_crane();
  crane.drive.gearbox_stiffness = 0.0;
  EXPECT_THROW(make_reference_equations(reference_machine(crane), {}), std::invalid_argument);
  ReferenceExtra extra;
  extra.start = {0.0};
  EXPECT_THROW(make_reference_equations(reference_machine(thesis_crane()), extra), std::invalid_argument);
}

TEST(ReferenceEquations, NothingMovesAtRest) {
  ReferenceEquations r = thesis_equations();
  const std::vector<double> y(static_cast<std::size_t>(r.size), 0.0);
  std::vector<double> rates(y.size(), 1.0);
  derive(r, 0.0, y.data(), rates.data());
  for (const double rate : rates) EXPECT_EQ(rate, 0.0);
}

// A motor in its play is free: T t / J and T t^2 / (2 J) of the held torque, which no rate of the state needs to give.
TEST(ReferenceEquations, TheHeldTorqueMovesAFreeMotorInClosedForm) {
  ReferenceEquations r = thesis_equations();
  r.held[0] = 500.0;  // [Nm]
  r.held_since = 2.0;
  std::vector<double> y(static_cast<std::size_t>(r.size), 0.0), rates(y.size());
  ReferencePlace place;
  observe(r, 2.5, y.data(), place);
  const double acceleration = 500.0 / r.machine.group_inertia[0];
  EXPECT_NEAR(place.motor_angle[0], 0.5 * acceleration * 0.25, 1e-15);
  EXPECT_NEAR(place.motor_speed[0], acceleration * 0.5, 1e-15);
  EXPECT_EQ(place.motor_angle[1], 0.0);
  derive(r, 2.5, y.data(), rates.data());
  EXPECT_EQ(rates[static_cast<std::size_t>(r.speeds())], 0.0);
}

// (3.5) and action = reaction: what a closed gear takes from its motor it gives to the house, mode by mode.
TEST(ReferenceEquations, AClosedGearPushesMotorAndModes) {
  ReferenceEquations r = thesis_equations();
  r.contact[1] = -1;
  const double depth = 1e-4;  // [rad]
  std::vector<double> y(static_cast<std::size_t>(r.size), 0.0), rates(y.size());
  y[1] = -r.machine.gear[1].half_play - depth;
  derive(r, 0.0, y.data(), rates.data());
  const double torque = -r.machine.gear[1].stiffness * depth;
  const double rounding = 1e-9 * -torque;
  EXPECT_NEAR(rates[static_cast<std::size_t>(r.speeds() + 1)] * r.machine.group_inertia[1], -torque, rounding);
  for (int k = 0; k < r.mode_count; ++k) {
    EXPECT_NEAR(rates[static_cast<std::size_t>(r.v() + k)], r.machine.modes.house[static_cast<std::size_t>(k)] * torque,
                rounding * std::fabs(r.machine.modes.house[static_cast<std::size_t>(k)]));
  }
}

// Teeth touch while they are both in depth and would push.
TEST(ReferenceEquations, TheContactFunctionIsTheSmallerOfDepthAndPush) {
  const GearContact gear{.stiffness = 100.0, .damping = 10.0, .half_play = 0.5};
  EXPECT_DOUBLE_EQ(contact_function(gear, 1, 0.75, 1.0), 0.25);
  EXPECT_DOUBLE_EQ(contact_function(gear, 1, 0.75, -1.0), 0.25 - 0.1);
  EXPECT_DOUBLE_EQ(contact_function(gear, -1, 0.75, 1.0), -1.25 - 0.1);
}

}  // namespace
}  // namespace slewlab::sim
