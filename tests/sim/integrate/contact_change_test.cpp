#include "sim/integrate/contact_change.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slewlab::sim {
namespace {

constexpr double kLength = 1e-3;  // [s] of the step
constexpr GearContact kUndamped{.stiffness = 2e8, .damping = 0.0, .half_play = 1e-3};
constexpr GearContact kDamped{.stiffness = 2e8, .damping = 4e4, .half_play = 1e-3};
constexpr double kNever = 2.0;

// Steady motion from `start` [rad] to `end`.
Deflection steady(double start, double end) {
  const double rate = (end - start) / kLength;
  return {start, rate, end, rate, kLength};
}

// Up at `rate` [rad/s] at first and down by the same at the end: the parabola start + rate s (1 - s / length).
Deflection parabola(double start, double rate) { return {start, rate, start, -rate, kLength}; }

double change(const GearContact& gear, int contact, int side, const Deflection& d) {
  return may_change(gear, contact, side, d) ? first_change(gear, contact, side, d) : kNever;
}

// Half of the way from the middle of the play to twice its edge is the edge; damping does not matter to teeth that approach.
TEST(ContactChange, FreeTeethMeetTheFlankWhereTheWayIsUsedUp) {
  for (const GearContact& gear : {kUndamped, kDamped}) {
    EXPECT_NEAR(change(gear, 0, 1, steady(0.0, 2e-3)), 0.5, 1e-12);
    EXPECT_NEAR(change(gear, 0, -1, steady(0.0, -2e-3)), 0.5, 1e-12);
    EXPECT_EQ(change(gear, 0, -1, steady(0.0, 2e-3)), kNever);
    EXPECT_EQ(change(gear, 0, 1, steady(0.0, 0.9e-3)), kNever);
  }
}

// Teeth that part let go where k depth = c |rate|: from depth D, falling by 2 D over the step, at (1 - c 2 D / (k D h)) / 2.
TEST(ContactChange, TeethInContactLetGoWhereTheyWouldPull) {
  constexpr double kDepth = 1e-3;
  const Deflection parting = steady(1e-3 + kDepth, 1e-3 - kDepth);
  EXPECT_NEAR(change(kUndamped, 1, 1, parting), 0.5, 1e-12);
  const double share = kDamped.damping / kDamped.stiffness * 2.0 / kLength;
  EXPECT_NEAR(change(kDamped, 1, 1, parting), 0.5 * (1.0 - share), 1e-12);
  EXPECT_EQ(change(kDamped, 1, 1, steady(1.5e-3, 1.4e-3)), kNever);
}

// The parabola's top is rate h / 4 above its ends. Both ends are short of the edge by `gap`: it is met at the lower root of
// rate h x (1 - x) = gap, where there is one.
TEST(ContactChange, ATurnInsideTheStepIsSeen) {
  constexpr double kGap = 1e-5, kRate = 0.1;
  const double root = 0.5 * (1.0 - std::sqrt(1.0 - 4.0 * kGap / (kRate * kLength)));
  EXPECT_NEAR(change(kUndamped, 0, 1, parabola(1e-3 - kGap, kRate)), root, 1e-12);
  EXPECT_EQ(change(kUndamped, 0, 1, parabola(1e-3 - 0.26 * kRate * kLength, kRate)), kNever);  // a hundredth of the way short
  EXPECT_EQ(change(kUndamped, 0, 1, parabola(0.0, kRate)), kNever);                            // far from the edge
}

TEST(ContactChange, TeethThatAreBeyondAtTheStartChangeThere) {
  EXPECT_EQ(change(kUndamped, 0, 1, steady(1.1e-3, 1.2e-3)), 0.0);
}

}  // namespace
}  // namespace slewlab::sim
