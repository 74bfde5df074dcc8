#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

#include "sim/model/boom.h"
#include "sim/model/load.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

using Complex = std::complex<double>;

// A load carried round at a steady speed o, seen from outside: with q = [z; b] of the rope's end and the rod, complex,
//   M q'' + K (q - [r; 0] e^(i o t)) = 0
// has the solution A e^(i o t), A = (K - o^2 M)^-1 K [r; 0], and beside it in each mode the free swing that begins at q(0) - A with i o
// times that; q(0) is [r; 0], or A and an angle of rope and rod outwards. What the tip sees is the part of z across, Im(z e^(-i o t)).
void expect_as_seen_from_outside(const CraneParameters& crane, double slew, double within, std::optional<double> outwards = {}) {
  const LoadOnSpring load = load_on_spring(crane.load);
  const double r = tip_radius(crane.boom);
  const Eigen::Vector2d tip(r, 0.0);
  Eigen::Matrix2d forced = load.stiffness - slew * slew * load.mass;
  if (crane.load.rod_length == 0.0) forced(1, 1) = 1.0;  // no rod
  const Eigen::Vector2d carried = forced.inverse() * load.stiffness * tip;
  Eigen::Vector2d begins = tip;
  if (outwards) begins = carried + *outwards * Eigen::Vector2d(crane.load.rope_length, 1.0);
  const Eigen::Vector2d place = load.modes.transpose() * load.mass * (begins - carried);
  double largest = 0.0;
  for (const BenchSample& s : run(crane, "offlead", {1.0}, 30.0, no_drive, {.slew_speed = slew, .outwards = outwards})) {
    Complex z = carried(0) * std::polar(1.0, slew * s.time);
    for (int j = 0; j < 2; ++j) {
      const double w = load.frequency(j);
      if (w == 0.0) continue;
      z += load.modes(0, j) * place(j) * (std::cos(w * s.time) + Complex(0.0, slew / w) * std::sin(w * s.time));
    }
    const double expected = std::imag(z * std::polar(1.0, -slew * s.time));
    ASSERT_NEAR(s.load_displacement - s.tip_displacement, expected, within) << s.time;
    largest = std::max(largest, std::fabs(expected));
  }
  EXPECT_GT(largest, 1000.0 * within) << "the bound must be small against the motion";
}

TEST(Offlead, LagsAsSeenFromOutside) { expect_as_seen_from_outside(pendulum(), 0.05, 1e-4); }

// The outward swing is a fifth of the radius.
TEST(Offlead, LagsAsSeenFromOutsideWhenItIsFarOut) { expect_as_seen_from_outside(pendulum(), 0.2, 1e-3); }

TEST(Offlead, ItsRodSwingsOutwardsToo) {
  CraneParameters crane = pendulum(30e3, 20.0);
  crane.load.rod_length = 5.0;
  expect_as_seen_from_outside(crane, 0.15, 1e-4);
}

// Begun in motion it swings about where it hangs on a house that turns evenly.
TEST(Offlead, BeginsAsItSwings) {
  CraneParameters crane = pendulum(30e3, 20.0);
  crane.load.rod_length = 5.0;
  expect_as_seen_from_outside(crane, 0.15, 1e-4, 0.04);
  for (const BenchSample& s : run(crane, "offlead", {1.0}, 30.0, no_drive, {.slew_speed = 0.15, .outwards = 0.0})) {
    ASSERT_NEAR(s.load_displacement - s.tip_displacement, 0.0, 1e-4) << s.time;
  }
}

// A crane that nobody drives, with house and motors as one inertia J and a point load, seen from outside:
//   J theta'' = r (M g / L) Im(z e^(-i theta)),   z'' = -(g / L) (z - r e^(i theta)),
// by Runge and Kutta. What the load gains of angular momentum the house loses.
TEST(Offlead, HouseAndLoadGoOnAsSeenFromOutside) {
  CraneParameters crane = rigid_crane_with_load();
  crane.load.damping_ratio = 0.0;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  crane.drive.gear_damping_ratio = 0.5;
  constexpr double kSlew = 0.15, kStep = 1e-3;
  const double r = tip_radius(crane.boom), w2 = kGravity / crane.load.rope_length, inertia = whole_inertia(crane);
  struct State {
    double angle, speed;
    Complex z, rate;
  };
  const auto derivative = [&](const State& s) {
    return State{s.speed, r * crane.load.mass * w2 * std::imag(s.z * std::polar(1.0, -s.angle)) / inertia, s.rate, -w2 * (s.z - std::polar(r, s.angle))};
  };
  const auto moved = [](const State& s, const State& d, double h) {
    return State{s.angle + h * d.angle, s.speed + h * d.speed, s.z + h * d.z, s.rate + h * d.rate};
  };
  State state{0.0, kSlew, r, Complex(0.0, kSlew * r)};
  double slowed = 0.0;
  for (const BenchSample& s : run(crane, "offlead", {1.0}, 40.0, no_drive, {.slew_speed = kSlew})) {
    const State k1 = derivative(state), k2 = derivative(moved(state, k1, 0.5 * kStep)), k3 = derivative(moved(state, k2, 0.5 * kStep)),
                k4 = derivative(moved(state, k3, kStep));
    for (const auto& [k, share] : {std::pair{k1, 1.0}, {k2, 2.0}, {k3, 2.0}, {k4, 1.0}}) state = moved(state, k, kStep / 6.0 * share);
    ASSERT_NEAR(s.house_speed, state.speed, 0.002 * kSlew) << s.time;
    slowed = std::max(slowed, kSlew - state.speed);
  }
  EXPECT_GT(slowed, 0.2 * kSlew) << "the bound must be small against what the load takes";
}

}  // namespace
}  // namespace slewlab::sim
