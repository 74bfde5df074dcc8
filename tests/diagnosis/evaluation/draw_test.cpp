// Expected numbers: the proportions and bounds that draw.h states.
#include "diagnosis/evaluation/draw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/evaluation/seal.h"
#include "sim/machine/machine_file.h"
#include "tests/sim/scaled_crane.h"

namespace slewlab::diagnosis::withheld {
namespace {

const std::string kConfig = std::string(SLEWLAB_SOURCE_DIR) + "/config/";

NominalMachine nominal(const std::string& crane, const std::string& controller) {
  return nominal_machine(sim::describe(sim::load_machine_file(kConfig + "cranes/" + crane + ".yaml")),
                         controller::load_controller_file(kConfig + "controllers/" + controller + ".yaml").settings);
}

const NominalMachine& thesis() {
  static const NominalMachine kThesis = nominal("thesis", "thesis");
  return kThesis;
}

TEST(Draw, SeedsOfTuningAndScoringAreKeptApart) {
  EXPECT_NO_THROW(check_seed(999, Purpose::kTune));
  EXPECT_NO_THROW(check_seed(1000, Purpose::kScore));
  EXPECT_THROW(check_seed(999, Purpose::kScore), std::invalid_argument);
  EXPECT_THROW(check_seed(1000, Purpose::kTune), std::invalid_argument);
}

TEST(Draw, KindsComeInProportion) {
  std::map<Kind, int> count;
  for (const DrawnCase& drawn : draw_cases(400, 3, thesis())) ++count[drawn.kind];
  EXPECT_EQ(count[Kind::kNothing], 60);
  EXPECT_EQ(count[Kind::kParameters], 60);
  EXPECT_EQ(count[Kind::kOneEffect], 160);
  EXPECT_EQ(count[Kind::kTwoEffects], 60);
  EXPECT_EQ(count[Kind::kLeftOut], 30);
  EXPECT_EQ(count[Kind::kNoCatalogue], 30);
}

// But for what every machine does, which is nobody's cause.
TEST(Draw, EffectsComeEquallyOften) {
  std::map<std::string, int> count;
  for (const DrawnCase& drawn : draw_cases(400, 3, thesis())) {
    if (drawn.kind == Kind::kOneEffect) ++count[drawn.laws[0].law];
  }
  int in_catalogue = 0, fewest = 1000, most = 0;
  for (const Law& law : laws()) {
    if (law.effect.empty()) continue;
    if (law.effect == "large_angles") {
      EXPECT_EQ(count[law.name], 0);
      continue;
    }
    ++in_catalogue;
    fewest = std::min(fewest, count[law.name]);
    most = std::max(most, count[law.name]);
  }
  EXPECT_GE(in_catalogue, 40);
  EXPECT_LE(most - fewest, 1);
}

// With equal chance within what has the description's standard deviation: sqrt(3) of it either way. 200 machines come near both ends.
TEST(Draw, SpreadStaysWithinTheDescriptionsAndNothingMissingHasNone) {
  const std::vector<sim::Parameter>& parameters = thesis().description.parameters;
  std::vector<double> lowest(parameters.size(), 1.0), highest(parameters.size(), 1.0);
  for (const DrawnCase& drawn : draw_cases(200, 4, thesis())) {
    ASSERT_EQ(drawn.spread.size(), thesis().description.parameters.size());
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (drawn.kind == Kind::kNothing) {
        EXPECT_EQ(drawn.spread[k], 1.0);
      }
      lowest[k] = std::min(lowest[k], drawn.spread[k]);
      highest[k] = std::max(highest[k], drawn.spread[k]);
    }
  }
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double end = std::sqrt(3.0) * parameters[k].spread;
    EXPECT_GE(lowest[k], 1.0 - end) << parameters[k].name;
    EXPECT_LE(highest[k], 1.0 + end) << parameters[k].name;
    EXPECT_LT(lowest[k], 1.0 - 0.9 * end) << parameters[k].name;
    EXPECT_GT(highest[k], 1.0 + 0.9 * end) << parameters[k].name;
  }
}

TEST(Draw, WhatIsLeftOutIsTheTrueEffectAndDecoysNeverAre) {
  int decoys = 0;
  for (const DrawnCase& drawn : draw_cases(300, 5, thesis())) {
    std::set<std::string> effects;
    for (const DrawnLaw& law : drawn.laws) effects.insert(law_named(law.law).effect);
    if (drawn.kind == Kind::kLeftOut) {
      ASSERT_EQ(drawn.without.size(), 1u);
      EXPECT_EQ(*effects.begin(), drawn.without[0]);
    } else if (!drawn.without.empty()) {
      ++decoys;
      EXPECT_EQ(effects.count(drawn.without[0]), 0u);
    }
  }
  EXPECT_GT(decoys, 15);  // an eighth of 277 is 35
}

TEST(Draw, SizesKeepToTheirLawsRange) {
  for (const DrawnCase& drawn : draw_cases(300, 6, thesis())) {
    for (const DrawnLaw& one : drawn.laws) {
      const Law& law = law_named(one.law);
      const double unit = law.unit(thesis().scales);
      EXPECT_GE(one.size, unit * std::min(law.low, law.high) * (1.0 - 1e-12)) << law.name;
      EXPECT_LE(one.size, unit * std::max(law.low, law.high) * (1.0 + 1e-12)) << law.name;
    }
  }
}

TEST(Draw, AtLeastFourLawsAreInNoCatalogue) {
  EXPECT_GE(std::count_if(laws().begin(), laws().end(), [](const Law& law) { return law.effect.empty(); }), 4);
}

TEST(Draw, TwoEffectsDiffer) {
  for (const DrawnCase& drawn : draw_cases(300, 7, thesis())) {
    if (drawn.kind == Kind::kTwoEffects) {
      EXPECT_NE(drawn.laws[0].law, drawn.laws[1].law);
    }
  }
}

TEST(Draw, SameSeedSameCases) {
  const std::vector<DrawnCase> one = draw_cases(50, 8, thesis()), two = draw_cases(50, 8, thesis()), other = draw_cases(50, 9, thesis());
  int same = 0;
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(one[n].spread, two[n].spread);
    EXPECT_EQ(one[n].noise_seeds, two[n].noise_seeds);
    same += one[n].noise_seeds == other[n].noise_seeds ? 1 : 0;
  }
  EXPECT_EQ(same, 0);
}

// Kinds, laws, what is left out, spread, seeds and manoeuvres, to the last bit; sizes are told apart below.
std::string text_of(const std::vector<DrawnCase>& cases) {
  std::string text;
  char word[64];
  const auto number = [&](double value) {
    std::snprintf(word, sizeof word, "%a ", value);
    text += word;
  };
  const auto whole = [&](std::uint64_t value) {
    std::snprintf(word, sizeof word, "%" PRIu64 " ", value);
    text += word;
  };
  for (const DrawnCase& drawn : cases) {
    text += std::to_string(drawn.number) + " " + name_of(drawn.kind) + " ";
    for (const DrawnLaw& law : drawn.laws) text += law.law + " ";
    for (const std::string& effect : drawn.without) text += "-" + effect + " ";
    for (const double factor : drawn.spread) number(factor);
    whole(drawn.law_seed);
    for (const std::uint64_t seed : drawn.noise_seeds) whole(seed);
    for (const Manoeuvre& manoeuvre : drawn.manoeuvres) {
      number(manoeuvre.duration);
      for (const Request& request : manoeuvre.requests) {
        number(request.time);
        number(request.speed_request);
      }
    }
    text += '\n';
  }
  return text;
}

// A seed is its set: the digest pins what is drawn from one, so that a set can be made again.
TEST(Draw, SeedsOfTheThesissCraneKeepTheirCases) {
  EXPECT_EQ(sha256(text_of(draw_cases(300, 31, thesis()))), "fad8734913b546bb83d94bba5022fd83ddc3d898647a9f72b6b945a156f4ac99");
}

TEST(Draw, HalvingLeavesLawsWithoutARangeAsTheyAre) {
  DrawnCase drawn;
  drawn.laws = {{"lag_of_two", 0.04}, {"true_pendulum", 1.0}};
  const DrawnCase half = halved(drawn, 2);
  EXPECT_EQ(half.laws[0].size, 0.01);
  EXPECT_EQ(half.laws[1].size, 1.0);
}

// Sizes in SI units, as they were before they became multiples of scales. Within 1 %: the multiples have three digits.
TEST(Draw, SizesOfTheThesissCraneAreStillTheSame) {
  const struct {
    const char* law;
    double low, high;
  } kSizes[] = {
      {"lag_of_two", 0.004, 0.07},
      {"soft_limit", 230, 110},
      {"sampled_dead_time", 0.003, 0.04},
      {"ripple_of_two", 1, 60},
      {"uneven_motors", 0.02, 0.4},
      {"uneven_gearboxes", 0.05, 0.55},
      {"worn_gears", 4e-05, 0.0015},
      {"uneven_gears", 8e-05, 0.0009},
      {"pinion_teeth", 3e+08, 8e+06},
      {"pinion_mesh", 0.01, 0.4},
      {"gearbox_mesh", 0.0008, 0.04},
      {"tooth_friction", 0.004, 0.15},
      {"brake_bristles", 1, 60},
      {"oil_column", 1e+11, 1.5e+09},
      {"bearing_bristles", 3000, 400000},
      {"thinning_grease", 100000, 1.5e+07},
      {"bearing_bristles_breaking_away", 3000, 300000},
      {"heavy_house", 0.3, 20},
      {"slew_ring", 1e+11, 2e+09},
      {"pedestal_mode", 8e+09, 4e+07},
      {"inclined_crane", 0.0005, 0.04},
      {"axial_force", 400000, 8.5e+06},
      {"damping_by_power", 0.3, 2.2},
      {"other_steel", 0.02, 0.4},
      {"jib_beside_the_axis", 150, 8000},
      {"relative_wind", 1.5, 25},
      {"other_load", 0.02, 0.6},
      {"other_rope", 0.02, 0.4},
      {"hoisting_on_elastic_rope", 0.01, 0.8},
      {"true_pendulum", 1, 1},
      {"drag_by_power", 10, 1500},
      {"radial_pendulum", 1, 1},
      {"sagging_tag_line", 20, 4000},
      {"swell", 0.0002, 0.03},
      {"kaimal_gusts", 0.2, 6},
      {"coarse_counts", 0.002, 0.05},
      {"eccentric_encoder", 0.0005, 0.05},
      {"wrong_scale", 0.001, 0.1},
      {"late_encoder", 0.002, 0.04},
      {"warm_clock", 3e-05, 0.006},
      {"beating_bus", 0.003, 0.04},
      {"two_hops", 0.006, 0.06},
      {"bursts_of_loss", 0.03, 0.8},
      {"droop_on", 0.1, 10},
      {"gains", 0.02, 0.8},
      {"ramp_times", 0.01, 0.5},
      {"play_map", 0.03, 0.9},
      {"filter_on", 0.002, 0.08},
      {"stiffening_gears", 0.02, 3},
      {"slew_cogging", 3000, 300000},
      {"tight_spot", 10000, 600000},
      {"creeping_rope", 0.005, 0.5},
      {"warming_motors", 0.005, 0.3},
      {"flat_roller", 20000, 800000},
      {"stiffening_guy", 3e+06, 3e+09},
  };
  for (const auto& size : kSizes) {
    const Law& law = law_named(size.law);
    const double unit = law.unit(thesis().scales);
    EXPECT_NEAR(law.low * unit / size.low, 1.0, 0.01) << size.law;
    EXPECT_NEAR(law.high * unit / size.high, 1.0, 0.01) << size.law;
  }
}

TEST(Draw, SameCasesOfAMachineWithOtherMasses) {
  const std::string text = text_of(draw_cases(100, 32, thesis()));
  for (const double factor : {1e-6, 1e-3, 1e3}) {
    NominalMachine scaled = thesis();
    scaled.description.machine = sim::with_masses_times(scaled.description.machine, factor);
    scaled = nominal_machine(scaled.description, scaled.controller);
    EXPECT_EQ(text_of(draw_cases(100, 32, scaled)), text) << factor;
  }
}

TEST(Draw, TimesOfTheManoeuvresAreStretchedWithTheRamp) {
  NominalMachine slower = thesis();
  slower.controller.ramp.acceleration_time *= 2.0;
  slower = nominal_machine(slower.description, slower.controller);
  const DrawnCase one = draw_cases(1, 33, thesis()).at(0), two = draw_cases(1, 33, slower).at(0);
  for (std::size_t m = 0; m < one.manoeuvres.size(); ++m) {
    EXPECT_NEAR(two.manoeuvres[m].duration, 2.0 * one.manoeuvres[m].duration, 1e-9);
    for (std::size_t k = 0; k < one.manoeuvres[m].requests.size(); ++k) {
      EXPECT_NEAR(two.manoeuvres[m].requests[k].time, 2.0 * one.manoeuvres[m].requests[k].time, 1e-9);
      EXPECT_EQ(two.manoeuvres[m].requests[k].speed_request, one.manoeuvres[m].requests[k].speed_request);
    }
  }
}

TEST(Draw, AMachineGetsOnlyLawsThatSuitIt) {
  for (const DrawnCase& drawn : draw_cases(200, 34, nominal("no_load", "thesis"))) {
    for (const DrawnLaw& law : drawn.laws) EXPECT_NE(law_named(law.law).needs, Needs::load) << law.law;
  }
  for (const DrawnCase& drawn : draw_cases(200, 34, nominal("one_group", "one_group"))) {
    for (const DrawnLaw& law : drawn.laws) {
      EXPECT_NE(law_named(law.law).needs, Needs::two_groups) << law.law;
      EXPECT_NE(law_named(law.law).needs, Needs::play_compensation) << law.law;
    }
  }
}

TEST(Draw, ARecorderIsSwitchedOnWhereItIsAskedAndChangesNothingElse) {
  const std::vector<DrawnCase> rest = draw_cases(60, 35, thesis());
  const std::string text = text_of(rest);
  std::map<int, int> count;  // of records a and b: at rest, with the drives on, in motion
  for (const Begin begin : {Begin::kDrivesOn, Begin::kInMotion, Begin::kAny}) {
    const std::vector<DrawnCase> cases = draw_cases(60, 35, thesis(), begin);
    EXPECT_EQ(text_of(cases), text);
    for (const DrawnCase& drawn : cases) {
      EXPECT_EQ(drawn.record_from[2], 0.0);  // the unseen manoeuvre
      for (std::size_t m = 0; m < kDiagnosedManoeuvres; ++m) {
        const double from = drawn.record_from[m], first = drawn.manoeuvres[m].requests.front().time;
        EXPECT_LT(from, drawn.manoeuvres[m].duration / 3.0);  // most of the manoeuvre is there
        if (begin == Begin::kDrivesOn) {
          EXPECT_GT(from, 0.5);  // the drives have laid the teeth on their flanks within half a second
          EXPECT_LT(from, first);
        }
        if (begin == Begin::kInMotion) {
          EXPECT_GT(from, first);
        }
        if (begin == Begin::kAny) ++count[from == 0.0 ? 0 : from < first ? 1 : 2];
      }
    }
  }
  // 120 records, each with a third of the chance: 40, with a deviation of 5.2; four of those.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(count[k], 40, 21);
  for (const DrawnCase& drawn : rest) EXPECT_EQ(drawn.record_from, (std::array<double, 3>{}));
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
