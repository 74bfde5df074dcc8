#include "sim/effects/mesh_torque.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/integrate/reference.h"
#include "sim/model/drive_line.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// By hand: k 1000 Nm/rad, c 10 Nms/rad, 0.1 rad of half play.
TEST(MeshTorque, IsTheStiffnessTimesTheDepth) {
  const GearContact gear{.stiffness = 1000.0, .damping = 10.0, .half_play = 0.1};
  const auto at = [&](double deflection, double rate, double share) { return mesh_torque(gear, share, deflection, rate); };
  EXPECT_NEAR(at(0.3, 0.0, 0.2), 0.2 * 1000.0 * 0.2, 1e-9);
  EXPECT_NEAR(at(0.3, 2.0, 0.2), 0.2 * 1000.0 * 0.2, 1e-9);  // the damping stays
  EXPECT_NEAR(at(-0.3, 0.0, -0.2), 0.2 * 1000.0 * 0.2, 1e-9);
  EXPECT_EQ(at(0.05, -3.0, 0.2), 0.0);                        // in the play
  EXPECT_EQ(at(0.3, -30.0, 0.2), 0.0);                        // damping would pull at either stiffness: 200, 240 < 300
  EXPECT_NEAR(at(0.3, -22.0, 0.2), 240.0 - 220.0, 1e-9);      // it would at the smaller one only
  EXPECT_NEAR(at(0.3, 0.0, -1.4), -200.0, 1e-9);              // no stiffness left
}

// The whole crane, through its play and wound up, against SUNDIALS with the stiffness itself going up and down.
TEST(MeshTorque, ActsAsTheStiffnessItself) {
  const CraneParameters crane = flexible_crane();
  constexpr double kStep = 0.001, kPhase = 0.4, kLast = -1.1, kSine = 0.24, kCosine = -0.07, kShare = 0.2;
  const Drive drive = constant_drive(120.0, -30.0);
  struct Mesh {
    const char* effect;
    double amplitude, order;
    bool of_motor;
  };
  for (const Mesh& mesh : {Mesh{"pinion_mesh_variation", 0.3, 12.0 * crane.drive.pinion_ratio, false},
                           Mesh{"gearbox_mesh_variation", 0.02, 110.0 * 8.0 / 118.0 * total_ratio(crane.drive), true}}) {
    std::vector<double> values{mesh.amplitude, kPhase, kSine, kCosine};
    if (!mesh.of_motor) {
      values.insert(values.begin() + 2, kLast);
      values.push_back(kShare);
    }
    const auto with = run(crane, mesh.effect, values, 2.0, drive);
    const auto without = run({.crane = crane, .effects = {}}, 2.0, drive);
    ReferenceExtra extra;
    extra.gears = [&](const ReferenceMotion& motion, const double*, ReferenceGears& gears) {
      for (int i = 0; i < crane.drive.group_count; ++i) {
        // The last half has the same wave, so much on, and a smaller one.
        const double on = !mesh.of_motor && i == 1 ? kLast - kPhase : 0.0;
        const double height = mesh.of_motor ? 1.0 : i == 1 ? 1.0 - kShare : 1.0 + kShare;
        const double at = mesh.order * (mesh.of_motor ? motion.motor_angle[i] : motion.house_angle) + on;
        gears.stiffness_share[i] +=
            height * mesh.amplitude * (std::sin(at + kPhase) + kSine * std::sin(2.0 * at) + kCosine * std::cos(2.0 * at));
      }
    };
    const ReferencePointer reference = make_reference(reference_machine(crane), {.tolerance = 1e-8}, extra);
    double error[3] = {}, effect[3] = {};
    for (std::size_t k = 0; k < with.size(); ++k) {
      advance(*reference, drive(0.0).motor_torque, static_cast<double>(k + 1) * kStep);
      const PlantReadings truth = read(*reference);
      const auto add = [&](int signal, double exact, double a, double b) {
        error[signal] += (a - exact) * (a - exact);
        effect[signal] += (b - exact) * (b - exact);
      };
      add(0, truth.shaft_speed[0], with[k].readings.shaft_speed[0], without[k].readings.shaft_speed[0]);
      add(2, truth.house_acceleration, with[k].readings.house_acceleration, without[k].readings.house_acceleration);
      add(1, truth.tip_acceleration, with[k].readings.tip_acceleration, without[k].readings.tip_acceleration);
    }
    EXPECT_LT(std::sqrt(error[0] / effect[0]), 0.01) << mesh.effect;
    EXPECT_LT(std::sqrt(error[1] / effect[1]), 0.03) << mesh.effect;
    EXPECT_LT(std::sqrt(error[2] / effect[2]), 0.02) << mesh.effect;
  }
}

}  // namespace
}  // namespace slewlab::sim
