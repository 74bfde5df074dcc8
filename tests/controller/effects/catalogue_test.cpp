#include "controller/effects/catalogue.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace slewlab::controller {
namespace {

// Every value at `absent` leaves the settings as they are.
TEST(ControllerEffects, AbsentSizesChangeNothing) {
  ControllerSettings settings;
  settings.speed_control = {.proportional_gain = 40.0, .integral_time = 1.0};
  settings.ramp = {.shape = RampShape::s_curve,
                   .top_speed = 0.05,
                   .acceleration_time = 4.0,
                   .deceleration_time = 4.0,
                   .emergency_stop_time = 1.5,
                   .curved_share = 0.3};
  settings.play_compensation.enabled = true;
  settings.play_compensation.point_count = 1;
  settings.play_compensation.points[0] = {0.0, 0.10, -0.10};
  for (const ControllerEffect* effect : effect_catalogue()) {
    common::EffectInstance instance = common::typical_instance(effect->about);
    for (std::size_t i = 0; i < instance.values.size(); ++i) {
      instance.values[i] = effect->about.parameters[i].absent.value();
    }
    const ControllerSettings same = with_effects(settings, {instance});
    EXPECT_EQ(same.speed_control.proportional_gain, 40.0) << effect->about.name;
    EXPECT_EQ(same.speed_control.integral_time, 1.0) << effect->about.name;
    EXPECT_EQ(same.speed_control.droop, 0.0) << effect->about.name;
    EXPECT_EQ(same.ramp.acceleration_time, 4.0) << effect->about.name;
    EXPECT_EQ(same.ramp.curved_share, 0.3) << effect->about.name;
    EXPECT_EQ(same.play_compensation.points[0].half_1, 0.10) << effect->about.name;
    EXPECT_EQ(same.speed_filter_time, 0.0) << effect->about.name;
  }
}

TEST(ControllerEffects, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(with_effects({}, {{"torque_lag", {0.1, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(with_effects({}, {{"droop", {-1.0}}}), std::invalid_argument);
  EXPECT_THROW(with_effects({}, {{"droop", {}}}), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::controller
