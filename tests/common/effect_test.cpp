#include "common/effect.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "common/yaml_node.h"

namespace slewlab::common {
namespace {

const EffectAbout& example() {
  static const EffectAbout about{.name = "example",
                                 .subsystem = Subsystem::house,
                                 .physics = "an example",
                                 .parameters = {{.name = "angle",
                                                 .unit = Unit::radian,
                                                 .meaning = "how far",
                                                 .lower = 0.0,
                                                 .upper = 1.0,
                                                 .typical = 0.2,
                                                 .prior_scale = 0.1,
                                                 .absent = 0.0},
                                                {.name = "stiffness",
                                                 .unit = Unit::newton_per_metre,
                                                 .per = ScaleOf::gear_stiffness,
                                                 .meaning = "how stiff",
                                                 .lower = 1.0,
                                                 .upper = 1e6,
                                                 .typical = 1e3,
                                                 .prior_scale = 0.5,
                                                 .scale = ParameterScale::logarithmic,
                                                 .absent = std::numeric_limits<double>::infinity()}}};
  return about;
}

TEST(Effect, TypicalInstanceHasTheTypicalValues) {
  const EffectInstance instance = typical_instance(example());
  EXPECT_EQ(instance.name, "example");
  EXPECT_EQ(instance.values, (std::vector<double>{0.2, 1e3}));
}

TEST(Effect, ChecksCountAndBounds) {
  EXPECT_NO_THROW(check_instance(example(), {"example", {0.0, 1e6}}));
  EXPECT_THROW(check_instance(example(), {"example", {0.0}}), std::invalid_argument);
  EXPECT_THROW(check_instance(example(), {"example", {1.1, 10.0}}), std::invalid_argument);
  try {
    check_instance(example(), {"example", {0.5, 2e6}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "effect example: stiffness is 2e+06 N/m, allowed is 1 ... 1e+06");
  }
}

TEST(Effect, RowNamesBoundsPriorAndWhereItVanishes) {
  EXPECT_EQ(parameter_row(example().parameters[0]), "| `angle` | rad | - | 0 ... 1 | 0.2 | 0 +- 0.1 | 0 | how far |");
  EXPECT_EQ(parameter_row(example().parameters[1]),
            "| `stiffness` | N/m | gear stiffness | 1 ... 1e+06 | 1000 | ln: 1000 +- 0.5 | infinite | how stiff |");
}

// A law's numbers are multiples of its scales; a logarithmic prior's width is a ratio and stays.
TEST(Effect, TakesTheUnitsOfAMachine) {
  EffectScales scales;
  scales[ScaleOf::gear_stiffness] = 20.0;
  const EffectAbout about = in_units_of(example(), scales);
  EXPECT_EQ(about.parameters[0].upper, 1.0);
  EXPECT_EQ(about.parameters[0].prior_scale, 0.1);
  EXPECT_EQ(about.parameters[1].lower, 20.0);
  EXPECT_EQ(about.parameters[1].upper, 20e6);
  EXPECT_EQ(about.parameters[1].typical, 20e3);
  EXPECT_EQ(about.parameters[1].prior_scale, 0.5);
  EXPECT_EQ(about.parameters[1].absent, std::numeric_limits<double>::infinity());
  EXPECT_EQ(in_units_of(about, {}).parameters[1].upper, 20e6);  // is in SI now
}

TEST(Effect, SuitsAMachineThatHasItsParts) {
  EffectAbout law = example();
  law.needs = {.boom = true, .load = true, .groups = 2};
  const EffectCatalogue without = catalogue_for({&law}, {}, {.boom = true, .groups = 1});
  EXPECT_TRUE(without.effects.empty());
  EXPECT_EQ(without.unsuited.at(0).missing, "2 motor groups and a load");
  EXPECT_EQ(expected_effect_name(without, "example"), "an effect that suits this machine; this one needs 2 motor groups and a load");
  EXPECT_THROW(without.at("example"), std::invalid_argument);
  const EffectCatalogue with = catalogue_for({&law}, {}, {.gears = true, .boom = true, .flexible_boom = true, .load = true, .groups = 4});
  EXPECT_EQ(with.at("example").name, "example");
  EXPECT_EQ(with.find("other"), nullptr);
}

TEST(Effect, GivesValuesByName) {
  const std::vector<double> numbers{0.25, 10.0};
  const EffectValues values(example(), numbers);
  EXPECT_EQ(values["stiffness"], 10.0);
  EXPECT_THROW(values["mass"], std::out_of_range);
}

TEST(Effect, NoListIsNoEffect) {
  InputProblems problems;
  EXPECT_TRUE(read_effects(YamlNode{}, {{example()}, {}}, problems).empty());
  EXPECT_TRUE(problems.empty());
}

TEST(Effect, WritesWhatAFileHolds) {
  EXPECT_EQ(effects_text({{"example", {0.25, 10.0}}}, {{example()}, {}}, "diagnosis"),
            "effects:\n  - effect: example\n"
            "    angle: {value: 0.25, unit: \"rad\", source: \"diagnosis\"}\n"
            "    stiffness: {value: 10, unit: \"N/m\", source: \"diagnosis\"}\n");
  EXPECT_THROW(effects_text({{"other", {}}}, {{example()}, {}}, "x"), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::common
