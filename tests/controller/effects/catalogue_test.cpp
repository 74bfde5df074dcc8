#include "controller/effects/catalogue.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "controller/controller_file.h"

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
    common::EffectInstance instance = common::typical_instance(effects_for(settings).at(effect->about.name));
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

// What a diagnosis found of a controller can be written as a file over the nominal one, and read again to the bit.
TEST(ControllerEffects, SurviveAFileOverTheNominalOne) {
  const std::filesystem::path nominal_file = SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml";
  const ControllerSettings nominal = load_controller_file(nominal_file).settings;
  EXPECT_EQ(changes_text(nominal, nominal, "test"), "");
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "controller_with_effect.yaml";
  for (const ControllerEffect* effect : effect_catalogue()) {
    const ControllerSettings changed = with_effects(nominal, {common::typical_instance(effects_for(nominal).at(effect->about.name))});
    const std::string changes = changes_text(nominal, changed, "test");
    EXPECT_NE(changes, "") << effect->about.name;
    std::ofstream(file) << "include: " << nominal_file.string() << "\n" << changes;
    const ControllerSettings read = load_controller_file(file).settings;
    EXPECT_EQ(changes_text(changed, read, "test"), "") << effect->about.name;
  }
  std::filesystem::remove(file);
}

// docs/effects/NAME.md states what the code has: one table row per parameter with its bounds.
TEST(ControllerEffects, EveryEffectHasItsPage) {
  for (const ControllerEffect* effect : effect_catalogue()) {
    const common::EffectAbout* about = &effect->about;
    const std::filesystem::path page = std::filesystem::path(SLEWLAB_SOURCE_DIR) / "docs" / "effects" / (std::string(about->name) + ".md");
    std::ifstream file(page);
    ASSERT_TRUE(file) << page;
    std::stringstream text;
    text << file.rdbuf();
    for (const common::EffectParameter& p : about->parameters) {
      EXPECT_NE(text.str().find(common::parameter_row(p)), std::string::npos) << page << "\n" << common::parameter_row(p);
    }
  }
}

TEST(ControllerEffects, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(with_effects({}, {{"torque_lag", {0.1, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(with_effects({}, {{"droop", {-1.0}}}), std::invalid_argument);
  EXPECT_THROW(with_effects({}, {{"droop", {}}}), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::controller
