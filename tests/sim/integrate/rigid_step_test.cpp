#include "sim/integrate/rigid_step.h"

#include <gtest/gtest.h>

#include "sim/model/crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 0.1;  // [s]

PlantModel rigid_axis() {
  CraneParameters axis;
  axis.boom.element_count = 0;
  axis.drive.group_count = axis.drive.motors_per_group = 1;
  axis.drive.is_rigid = true;
  axis.drive.motor_inertia = 0.002;  // [kg m^2]
  axis.drive.gearbox_ratio = 50.0;   // 5 kg m^2 on the axis
  axis.house.inertia = 12.0;
  return make_plant_model(axis, kStep);
}
constexpr double kInertia = 17.0;  // [kg m^2]

struct Step {
  PlantModel model = rigid_axis();
  PlantState state = make_plant_state(model);
  Push push{};

  explicit Step(double speed) {
    state.v[0] = speed / model.house[0];
    refresh(model, state);
  }
};

// Closed form: v = v0 + T h / J, x = v0 h + T h^2 / (2 J). The gears pass on what the motor's own inertia leaves.
TEST(RigidStep, HeldTorqueGivesConstantAcceleration) {
  Step step(0.4);
  step.push.motor[0] = 34.0;
  step_rigid(step.model, step.push, step.state);
  EXPECT_NEAR(step.state.house_speed, 0.4 + 34.0 / kInertia * kStep, 1e-14);
  EXPECT_NEAR(step.state.house_angle, 0.4 * kStep + 0.5 * 34.0 / kInertia * kStep * kStep, 1e-14);
  EXPECT_NEAR(step.state.gear_torque[0], 34.0 - 5.0 * 34.0 / kInertia, 1e-12);
  EXPECT_NEAR(step.state.supplied_work, 0.5 * kInertia * (step.state.house_speed * step.state.house_speed - 0.16), 1e-12);
}

// Closed form: full friction F stops it after v0 J / F, v0^2 J / (2 F) further on, and holds it for the rest of the step.
TEST(RigidStep, FrictionStopsItInsideTheStepAndHoldsIt) {
  Step step(0.02);
  step.push.has_friction = true;
  step.push.friction.house_positive = step.push.friction.house_negative = 34.0;  // stops after 0.01 s
  step_rigid(step.model, step.push, step.state);
  EXPECT_EQ(step.state.house_speed, 0.0);
  EXPECT_NEAR(step.state.house_angle, 0.02 * 0.02 * kInertia / (2.0 * 34.0), 1e-16);
  const double angle = step.state.house_angle;
  step.push.motor[0] = 33.0;  // below the friction
  step_rigid(step.model, step.push, step.state);
  EXPECT_EQ(step.state.house_angle, angle);
  EXPECT_NEAR(step.state.house_friction, -33.0, 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
