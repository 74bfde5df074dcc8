// The heat of a mode against closed forms, and that of the whole crane against what it loses.
#include "tools/soak/dissipation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/integrate/oscillator.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::tools {
namespace {

constexpr double kStep = 1e-3;  // [s]

struct OneCrane {
  sim::PlantModel model = sim::make_plant_model(sim::thesis_crane(), kStep);
  sim::PlantState state = sim::make_plant_state(model);
};

// Without a force all that a mode loses is heat: a slow one, and the fastest, which loses most of its energy within a step.
TEST(ModalDissipation, WithoutAForceIsWhatTheModeLoses) {
  for (const bool is_fastest : {false, true}) {
    OneCrane crane;
    const std::size_t k = is_fastest ? static_cast<std::size_t>(crane.model.mode_count) - 1 : 1;
    crane.state.q[k] = 1e-3;
    crane.state.v[k] = 0.7;
    const double before = sim::modal_energy(crane.model, crane.state, static_cast<int>(k));
    ModalDissipation dissipation(crane.model, crane.state);
    const sim::OscillatorResponse r = sim::oscillator_response(crane.model.square[k], crane.model.damping_rate[k], kStep);
    crane.state.q[k] = r.qq * 1e-3 + r.qv * 0.7;
    crane.state.v[k] = r.vq * 1e-3 + r.vv * 0.7;
    const double lost = before - sim::modal_energy(crane.model, crane.state, static_cast<int>(k));
    if (is_fastest) {
      EXPECT_GT(lost, 0.5 * before);
    }
    EXPECT_NEAR(dissipation.over_step(crane.state), lost, 1e-9 * before);
    crane.state.q[k] = crane.state.v[k] = 0.0;
  }
}

// A mode that a linear force moves, against the sum of d v^2 over a thousand parts of the step by Simpson's rule.
TEST(ModalDissipation, UnderALinearForceIsTheIntegralOfItsPower) {
  OneCrane crane;
  for (const std::size_t k : {std::size_t{1}, static_cast<std::size_t>(crane.model.mode_count) - 1}) {
    const double square = crane.model.square[k], rate = crane.model.damping_rate[k];
    constexpr double kForce = 40.0, kForceRate = -3e4, kPosition = 2e-3, kSpeed = -0.3;
    constexpr int kParts = 1000;
    const auto at = [&](double time) {
      if (time == 0.0) return std::pair{kPosition, kSpeed};
      const sim::OscillatorResponse r = sim::oscillator_response(square, rate, time);
      return std::pair{r.qq * kPosition + r.qv * kSpeed + kForce * r.q[0] + kForceRate * r.q[1],
                       r.vq * kPosition + r.vv * kSpeed + kForce * r.v[0] + kForceRate * r.v[1]};
    };
    double expected = 0.0;
    for (int n = 0; n <= kParts; ++n) {
      const double v = at(kStep * n / kParts).second;
      expected += (n == 0 || n == kParts ? 1.0 : n % 2 == 1 ? 4.0 : 2.0) * rate * v * v * kStep / kParts / 3.0;
    }
    OneCrane one;
    one.state.q[k] = kPosition;
    one.state.v[k] = kSpeed;
    ModalDissipation dissipation(one.model, one.state);
    std::tie(one.state.q[k], one.state.v[k]) = at(kStep);
    EXPECT_NEAR(dissipation.over_step(one.state), expected, 1e-6 * expected) << "mode " << k;
  }
}

// Teeth that are wound up and let go push their two sides apart and part before they are unwound, because the damper holds them back: from there on
// they give nothing, and the rest of k depth^2 / 2 is heat. Nothing else supplies or takes energy, so that energy and heat stay what was stored.
TEST(Dissipation, OfTeethThatPartWoundUpIsWhatTheyStillHold) {
  OneCrane crane;
  sim::PlantWorkspace workspace = sim::make_plant_workspace(crane.model);
  for (int i = 0; i < crane.model.group_count; ++i) {
    crane.state.motor_angle[i] = (i == 0 ? 1.0 : -1.0) * (crane.model.gear[i].half_play + 1e-4);
  }
  sim::refresh(crane.model, crane.state);
  const double stored = sim::mechanical_energy(crane.model, crane.state);
  ModalDissipation modal(crane.model, crane.state);
  double heat = 0.0, in_parted_teeth = 0.0;
  double power = gear_and_rope_dissipation(crane.model, crane.state);
  bool has_parted = false;
  for (int n = 0; n < 300; ++n) {
    sim::step(crane.model, workspace, {}, crane.state);
    const double now = gear_and_rope_dissipation(crane.model, crane.state);
    heat += 0.5 * kStep * (power + now) + modal.over_step(crane.state);
    power = now;
    if (crane.state.contact[0] != 0) continue;
    has_parted = true;
    if (now > 0.0) in_parted_teeth = std::max(in_parted_teeth, sim::mechanical_energy(crane.model, crane.state));
  }
  ASSERT_TRUE(has_parted);
  EXPECT_GT(in_parted_teeth, 0.0);
  EXPECT_NEAR(sim::mechanical_energy(crane.model, crane.state) + heat, stored, 2e-4 * stored);
}

}  // namespace
}  // namespace slewlab::tools
