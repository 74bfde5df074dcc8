#include "sim/effects/catalogue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include "common/yaml_file.h"
#include "sim/integrate/machine.h"
#include "sim/machine/effect_scales.h"
#include "sim/machine/machine_file.h"
#include "tests/sim/effects/effect_bench.h"
#include "tests/sim/scaled_crane.h"

namespace slewlab::sim {
namespace {

// A slew to one side and back, held over 10 ms, that crosses the play.
DriveCommand manoeuvre(double time) {
  const double held = std::floor(time / 0.01 + 1e-6);
  DriveCommand command;
  command.sequence = std::lround(held);
  const double torque = 220.0 * std::sin(2.0 * held * 0.01);
  command.motor_torque = {torque + 20.0, torque - 20.0};
  return command;
}

double distance(const std::vector<BenchSample>& a, const std::vector<BenchSample>& b) {
  double sum = 0.0;
  const auto add = [&](double x, double y, double scale) { sum += (x - y) * (x - y) / (scale * scale); };
  for (std::size_t k = 0; k < a.size(); ++k) {
    add(a[k].readings.shaft_speed[0], b[k].readings.shaft_speed[0], 10.0);
    add(a[k].readings.shaft_speed[1], b[k].readings.shaft_speed[1], 10.0);
    add(a[k].readings.tip_acceleration, b[k].readings.tip_acceleration, 0.5);
    add(a[k].readings.house_acceleration, b[k].readings.house_acceleration, 0.05);
    add(a[k].readings.slew_angle, b[k].readings.slew_angle, 0.01);
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// A law that holds others whole moves the machine as these do where it has nothing of its own: frictions that are even, not more at rest, do not warm, or
// flatten far above every speed, whose curve is a line within 2 % up to a 25th of the speed at which it does.
TEST(EffectCatalogue, ALawIsItsPartsWhereItHasNothingOfItsOwn) {
  common::EffectCatalogue catalogue;
  for (const EffectDescription* effect : effect_catalogue()) catalogue.effects.push_back(thesis_effect(effect->about.name));
  MachineSettings settings;
  settings.crane = rigid_crane_without_play();
  const auto coasted = [&](std::vector<common::EffectInstance> effects) {
    settings.effects = std::move(effects);
    return run(settings, 4.0, no_drive, {.slew_speed = 0.004}).back().house_angle;
  };
  const std::vector<common::EffectInstance> laws{{"bearing_uneven", {1e5, 0.0, 1.0, 0.3, 0.0, 0.0, 0.2, 5e-5}},
                                                 {"bearing_stribeck", {1e5, 0.0, 0.01, 0.2, 5e-5}},
                                                 {"bearing_warming", {1e5, 5e6, 0.0, 1.0, 0.2, 5e-5}},
                                                 {"bearing_rising", {2e6, 0.1, 0.05, 0.2, 5e-5}}};
  for (const EffectDescription* effect : effect_catalogue()) {
    const auto is_it = [&](const common::EffectInstance& law) { return law.name == effect->about.name; };
    EXPECT_EQ(effect->about.parts != nullptr, std::any_of(laws.begin(), laws.end(), is_it)) << effect->about.name;
  }
  for (const common::EffectInstance& whole : laws) {
    const std::vector<common::EffectInstance> parts = common::parts_of(catalogue, whole);
    ASSERT_FALSE(parts.empty()) << whole.name;
    std::vector<std::string> names;
    for (const common::EffectInstance& part : parts) names.insert(names.begin(), part.name);
    EXPECT_TRUE(common::are_the_parts_of_one(catalogue, names));
    EXPECT_FALSE(common::are_the_parts_of_one(catalogue, std::vector<std::string>{names.front(), whole.name}));
    const double as_one = coasted({whole}), as_parts = coasted(parts), without = coasted({});
    EXPECT_GT(std::fabs(without - as_one), 0.3 * std::fabs(without)) << whole.name;
    EXPECT_NEAR(as_parts, as_one, 0.02 * std::fabs(without - as_one)) << whole.name;
  }
}

TEST(EffectCatalogue, DescribesEveryEffectFully) {
  std::set<std::string_view> names;
  for (const EffectDescription* effect : effect_catalogue()) {
    EXPECT_TRUE(names.insert(effect->about.name).second) << effect->about.name;
    EXPECT_EQ(find_effect(effect->about.name), effect);
    EXPECT_FALSE(effect->about.physics.empty());
    EXPECT_FALSE(effect->about.parameters.empty());
    EXPECT_FALSE(effect->ports.empty());
    EXPECT_TRUE(effect->change != nullptr || effect->start != nullptr);
    bool has_size = false;
    for (const common::EffectParameter& p : effect->about.parameters) {
      EXPECT_LT(p.lower, p.upper) << effect->about.name << " " << p.name;
      EXPECT_TRUE(p.typical >= p.lower && p.typical <= p.upper) << effect->about.name << " " << p.name;
      EXPECT_GT(p.prior_scale, 0.0);
      EXPECT_FALSE(p.meaning.empty());
      if (p.scale == common::ParameterScale::logarithmic) {
        EXPECT_GT(p.lower, 0.0);
      }
      for (const double value : p.tries) {
        EXPECT_TRUE(value >= p.lower && value <= p.upper) << effect->about.name << " " << p.name << " " << value;
        EXPECT_NE(value, p.typical) << effect->about.name << " " << p.name;
      }
      has_size = has_size || p.absent.has_value();
    }
    EXPECT_TRUE(has_size) << effect->about.name << " cannot fade out";
  }
  EXPECT_EQ(find_effect("gremlins"), nullptr);
}

// Sizes at `absent` run as if the effect were not there; where absent is infinite, the largest allowed size
// is nearer to it than the typical one, and a typical one is far from it.
TEST(EffectCatalogue, SizesFadeOut) {
  const CraneParameters crane = flexible_crane();
  const BenchStart start{.slew_speed = 0.02, .rope_angle = 0.02};
  const auto without = run(MachineSettings{.crane = crane, .effects = {}}, 3.0, manoeuvre, start);
  for (const EffectDescription* effect : effect_catalogue()) {
    common::EffectInstance typical_size = common::typical_instance(thesis_effect(effect->about.name));
    if (typical_size.name == "hoisting") typical_size.values[1] = 0.0;  // begins at once
    common::EffectInstance faded = typical_size;
    bool exactly = true;
    for (std::size_t i = 0; i < faded.values.size(); ++i) {
      const common::EffectParameter& p = thesis_effect(effect->about.name).parameters[i];
      if (!p.absent) continue;
      exactly = exactly && std::isfinite(*p.absent);
      faded.values[i] = std::min(p.upper, *p.absent);
    }
    const auto gone = run({.crane = crane, .effects = {faded}}, 3.0, manoeuvre, start);
    const auto there = run({.crane = crane, .effects = {typical_size}}, 3.0, manoeuvre, start);
    const double typical = distance(there, without);
    EXPECT_GT(typical, 1e-6) << effect->about.name;
    EXPECT_LT(distance(gone, without), exactly ? 1e-9 : 0.6 * typical) << effect->about.name;
  }
}

// One description serves machines of every size: the typical sizes of a machine with other masses, or with lengths times
// lambda and times times sqrt(lambda), make the same motion, whatever the effect.
TEST(EffectCatalogue, SizesFollowTheMachine) {
  const CraneParameters thesis = flexible_crane();
  const auto without = run(MachineSettings{.crane = thesis, .effects = {}}, 1.0, manoeuvre, {.slew_speed = 0.02, .rope_angle = 0.02});
  struct Size {
    CraneParameters crane;
    double torque, time;  // factors
  };
  constexpr double kLambda = 4.0;
  const double root = std::sqrt(kLambda);
  for (const Size& size : {Size{with_masses_times(thesis, 1e3), 1e3, 1.0}, Size{with_masses_times(thesis, 1e-6), 1e-6, 1.0},
                           Size{with_lengths_times(thesis, kLambda), kLambda, root}}) {
    const common::EffectCatalogue catalogue = effects_for(size.crane);
    EXPECT_TRUE(catalogue.unsuited.empty());
    for (const common::EffectAbout& about : catalogue.effects) {
      const auto there =
          run({.crane = thesis, .effects = {common::typical_instance(thesis_effect(about.name))}}, 1.0, manoeuvre, {.slew_speed = 0.02, .rope_angle = 0.02});
      const auto drive = [&](double time) {
        DriveCommand command = manoeuvre(time / size.time);
        for (double& torque : command.motor_torque) torque *= size.torque;
        return command;
      };
      auto scaled = run({.crane = size.crane, .effects = {common::typical_instance(about)}, .step = 0.001 * size.time,
                         .scales = effect_scales(size.crane)},
                        size.time, drive, {.slew_speed = 0.02 / size.time, .rope_angle = 0.02});
      for (BenchSample& sample : scaled) {
        for (double& speed : sample.readings.shaft_speed) speed *= size.time;  // accelerations are as gravity is
      }
      ASSERT_EQ(scaled.size(), there.size()) << about.name;
      EXPECT_LE(distance(scaled, there), 1e-3 * distance(there, without) + 1e-9) << about.name << ", torques times " << size.torque;
    }
  }
}

// A machine without load or boom has no effects of theirs, and says what is missing.
TEST(EffectCatalogue, LeavesOutWhatDoesNotSuitTheMachine) {
  CraneParameters machine = rigid_crane();
  machine.boom = {};
  machine.boom.element_count = 0;
  machine.drive.group_count = 1;
  const common::EffectCatalogue catalogue = effects_for(machine);
  EXPECT_EQ(catalogue.find("wind"), nullptr);
  EXPECT_EQ(catalogue.find("load_mass"), nullptr);
  EXPECT_EQ(catalogue.find("uneven_play"), nullptr);
  EXPECT_NE(catalogue.find("bearing_coulomb"), nullptr);
  EXPECT_NE(catalogue.find("house_inertia"), nullptr);
  for (const common::EffectAbout& about : catalogue.effects) {
    for (const common::EffectParameter& p : about.parameters) {
      EXPECT_LT(p.lower, p.upper) << about.name << " " << p.name;
      EXPECT_TRUE(std::isfinite(p.typical) && p.prior_scale > 0.0) << about.name << " " << p.name;
    }
    EXPECT_NO_THROW(make_machine({.crane = machine, .effects = {common::typical_instance(about)}})) << about.name;
  }
  try {
    make_machine({.crane = machine, .effects = {{"tag_line", {500.0, 2000.0}}}});
    ADD_FAILURE() << "a tag line without a load";
  } catch (const std::invalid_argument& refused) {
    EXPECT_STREQ(refused.what(), "effect tag_line needs a boom and a load, which this machine has not");
  }
}

// Gears wound up against each other stay in contact, so that everything is smooth: error over the step.
TEST(EffectCatalogue, SmoothEffectsAreOfSecondOrderInTheStep) {
  const CraneParameters crane = flexible_crane();
  const double wound = 100.0 * torque_factor(crane);
  const BenchStart start{.slew_speed = 0.03, .rope_angle = 0.03, .gear_torque = {wound, -wound}};
  for (const char* name :
       {"torque_lag", "pinion_mesh_variation", "gear_friction", "dragging_brake", "bearing_coulomb",
        "bearing_viscous", "bearing_stribeck", "bearing_rising", "bearing_uneven", "bearing_warming", "torque_offset", "tilted_axis", "pedestal_flexibility", "heel", "wind",
        "hoisting", "large_angles", "air_drag", "offlead", "tag_line", "vessel_roll", "gusts"}) {
    common::EffectInstance instance = common::typical_instance(thesis_effect(name));
    if (instance.name == "hoisting") instance.values = {0.5, 0.0, 8.0, 1.0, 1.0};  // ramps of 1 s: at a whole step, without a step of acceleration
    for (std::size_t p = 0; p < instance.values.size(); ++p) {
      if (find_effect(name)->about.parameters[p].name == "give") instance.values[p] = 0.0;  // below
    }
    const auto end = [&](double step) {
      return run({.crane = crane, .effects = {instance}, .step = step}, 1.6, constant_drive(110.0, -95.0),
                 start)
          .back();
    };
    const BenchSample best = end(0.000125), fine = end(0.0005), coarse = end(0.001);
    const auto ratio = [&](double BenchSample::* field, double rounding) {
      const double small = std::fabs(fine.*field - best.*field);
      const double large = std::fabs(coarse.*field - best.*field);
      // Second order: (4 - 1/16) / (1 - 1/16) = 4.2.
      if (small > rounding) {
        EXPECT_GT(large / small, 3.0) << name << " " << large << " " << small;
      }
    };
    ratio(&BenchSample::house_angle, 1e-11);
    ratio(&BenchSample::tip_displacement, 1e-9);
    ratio(&BenchSample::load_displacement, 1e-9);
  }
}

// Joints that give take up their friction within a step or two of 1 ms here, and turn within one: first order, and small.
TEST(EffectCatalogue, JointsThatGiveAreRightWithinAShareOfTheirEffect) {
  const CraneParameters crane = flexible_crane();
  const BenchStart start{.slew_speed = 0.03, .rope_angle = 0.03};
  for (const char* name : {"dragging_brake", "bearing_coulomb", "bearing_stribeck", "bearing_rising", "bearing_uneven", "bearing_warming"}) {
    const common::EffectInstance instance = common::typical_instance(thesis_effect(name));
    const auto end = [&](double step, const std::vector<common::EffectInstance>& effects) {
      return run({.crane = crane, .effects = effects, .step = step}, 1.6, constant_drive(110.0, 95.0), start).back();
    };
    const BenchSample best = end(0.0000625, {instance}), coarse = end(0.001, {instance}), without = end(0.001, {});
    EXPECT_LT(std::fabs(coarse.house_angle - best.house_angle), 0.01 * std::fabs(without.house_angle - best.house_angle))
        << name;
    EXPECT_LT(std::fabs(coarse.tip_displacement - best.tip_displacement),
              0.01 * std::fabs(without.tip_displacement - best.tip_displacement))
        << name;
  }
}

// A law that feeds what it acts on grows without bounds, on one crane and not on another: each effect at its typical size and at the ends of its range, on
// cranes of three makers' proportions whose load swings while half the rated torque starts and stops them. Twenty times the top speed is more than
// a constant torque at its end pushes any of them to within the run.
TEST(EffectCatalogue, NoEffectOfAnySizeLeavesWhatACraneCanDo) {
  for (const char* name : {"thesis", "harbour_5t", "offshore_900t"}) {
    MachineSettings settings;
    settings.crane = load_machine_file(std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/" + name + ".yaml").parameters;
    settings.scales = effect_scales(settings.crane, settings.drive_protection);
    const auto drive = [torque = 0.5 * settings.crane.drive.rated_torque](double time) {
      const double share = time < 5.0 ? 1.0 : time >= 10.0 && time < 15.0 ? -1.0 : 0.0;
      return constant_drive(share * torque, share * torque)(time);
    };
    for (const common::EffectAbout& about : effects_for(settings.crane).effects) {
      const common::EffectParameter& size = about.parameters[common::kSize];
      for (const double value : {size.typical, size.upper, size.lower}) {
        if (!std::isfinite(value)) continue;
        common::EffectInstance effect = common::typical_instance(about);
        effect.values[common::kSize] = value;
        settings.effects = {effect};
        double fastest = 0.0;
        for (const BenchSample& sample : run(settings, 20.0, drive, {.rope_angle = 0.15})) {
          fastest = std::fabs(sample.house_speed) <= fastest ? fastest : std::fabs(sample.house_speed);
        }
        EXPECT_LT(fastest, 20.0 * settings.crane.drive.top_speed) << name << ", " << about.name << " of " << value;
      }
    }
  }
}

TEST(EffectCatalogue, ReadsBackWhatItWrites) {
  std::vector<common::EffectInstance> all;
  const common::EffectCatalogue catalogue = effects_for(flexible_crane());
  for (const common::EffectAbout& about : catalogue.effects) all.push_back(common::typical_instance(about));
  common::InputProblems problems;
  const auto tree =
      common::parse_yaml_text(common::effects_text(all, catalogue, "test"), "crane.yaml", problems);
  const auto read = common::read_effects(*tree.find("effects"), effects_for(flexible_crane()), problems);
  ASSERT_TRUE(problems.empty()) << common::to_text(problems.front());
  ASSERT_EQ(read.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(read[i].name, all[i].name);
    EXPECT_EQ(read[i].values, all[i].values);
  }
}

std::string problem_of(const std::string& text) {
  common::InputProblems problems;
  const auto tree = common::parse_yaml_text(text, "crane.yaml", problems);
  common::read_effects(*tree.find("effects"), effects_for(flexible_crane()), problems);
  std::string all;
  for (const common::InputProblem& problem : problems) all += common::to_text(problem) + "\n";
  return all;
}

TEST(EffectCatalogue, TellsWhatIsWrongInAFile) {
  const std::string share = "    delay_share: {value: 0.2, unit: \"-\", source: a}\n";
  EXPECT_EQ(problem_of("effects:\n  - effect: torque_lag\n    time_constant: {value: 30, unit: ms, source: a}\n" + share),
            "");
  const std::string unknown = problem_of("effects:\n  - effect: torque_lagg\n");
  EXPECT_NE(unknown.find("crane.yaml:2"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("'torque_lag' is near"), std::string::npos) << unknown;
  const std::string bounds =
      problem_of("effects:\n  - effect: torque_lag\n    time_constant: {value: 3, unit: s, source: a}\n" + share);
  EXPECT_NE(bounds.find("time_constant"), std::string::npos) << bounds;
  EXPECT_NE(bounds.find("0.5"), std::string::npos) << bounds;
  const std::string unit =
      problem_of("effects:\n  - effect: torque_lag\n    time_constant: {value: 0.1, unit: m, source: a}\n" + share);
  EXPECT_NE(unit.find("unit"), std::string::npos) << unit;
  const std::string key = problem_of(
      "effects:\n  - effect: torque_lag\n    time_constant: {value: 0.1, unit: s, source: a}\n" + share +
      "    overshoot: 3\n");
  EXPECT_NE(key.find("overshoot"), std::string::npos) << key;
  const std::string missing = problem_of("effects:\n  - effect: torque_lag\n");
  EXPECT_NE(missing.find("time_constant"), std::string::npos) << missing;
  EXPECT_NE(missing.find("delay_share"), std::string::npos) << missing;
  const std::string twice = problem_of(
      "effects:\n  - effect: load_mass\n    factor: {value: 1.1, unit: \"-\", source: a}\n"
      "  - effect: load_mass\n    factor: {value: 1.2, unit: \"-\", source: a}\n");
  EXPECT_NE(twice.find("once"), std::string::npos) << twice;
}

// docs/effects/README.md has a row for every effect, of its subsystem and with a link to its page.
TEST(EffectCatalogue, EveryEffectHasItsRowInTheIndex) {
  std::vector<std::filesystem::path> pages{std::filesystem::path(SLEWLAB_SOURCE_DIR) / "docs" / "effects"};
#ifdef SLEWLAB_MORE_PAGES  // of the tutorial's effect
  pages.emplace_back(SLEWLAB_MORE_PAGES);
#endif
  std::stringstream index;
  for (const std::filesystem::path& folder : pages) {
    std::ifstream file(folder / "README.md");
    ASSERT_TRUE(file) << folder;
    index << file.rdbuf();
  }
  for (const EffectDescription* effect : effect_catalogue()) {
    const std::string name(effect->about.name);
    const std::string row = "| " + std::string(common::name_of(effect->about.subsystem)) + " | [" + name + "](" + name + ".md) | ";
    EXPECT_NE(index.str().find(row), std::string::npos) << row;
  }
}

// docs/effects/NAME.md states what the code has: one table row per parameter with its bounds.
TEST(EffectCatalogue, EveryEffectHasItsPage) {
  for (const EffectDescription* effect : effect_catalogue()) {
    const common::EffectAbout* about = &effect->about;
    const std::string name = std::string(about->name) + ".md";
    std::filesystem::path page = std::filesystem::path(SLEWLAB_SOURCE_DIR) / "docs" / "effects" / name;
#ifdef SLEWLAB_MORE_PAGES  // of the tutorial's effect
    if (!std::filesystem::exists(page)) page = std::filesystem::path(SLEWLAB_MORE_PAGES) / name;
#endif
    std::ifstream file(page);
    ASSERT_TRUE(file) << page;
    std::stringstream text;
    text << file.rdbuf();
    for (const common::EffectParameter& p : about->parameters) {
      EXPECT_NE(text.str().find(common::parameter_row(p)), std::string::npos) << page << "\n"
                                                                              << common::parameter_row(p);
      EXPECT_NE(text.str().find("    " + std::string(p.name) + ": {value: "), std::string::npos)
          << page << ": no " << p.name << " in the crane's file";
    }
  }
}

// On a linear axis forces are forces; what belongs to the motor's shaft is as it turns.
TEST(Catalogue, ALinearAxisHasItsOwnUnits) {
  MachineFile rotary;
  rotary.kind = MachineKind::axis;
  rotary.parameters.drive = {.group_count = 1, .motors_per_group = 1, .motor_inertia = 1e-3, .gearbox_ratio = 600.0, .rated_torque = 1.0,
                             .top_speed = 0.3, .is_rigid = true};
  rotary.parameters.house.inertia = 95.0;
  MachineFile linear = rotary;
  linear.axis.is_linear = true;
  MachineFile direct = linear;  // no turning motor
  direct.axis.is_shaft_linear = true;
  const auto unit = [](const common::EffectCatalogue& catalogue, const char* effect, const char* parameter) {
    for (const common::EffectParameter& one : catalogue.at(effect).parameters) {
      if (one.name == parameter) return common::name_of(one.unit);
    }
    return std::string_view{};
  };
  const common::EffectCatalogue of_linear = effects_for(linear), of_rotary = effects_for(rotary);
  EXPECT_EQ(unit(of_linear, "bearing_coulomb", "torque"), "N");
  EXPECT_EQ(unit(of_rotary, "bearing_coulomb", "torque"), "N m");
  EXPECT_EQ(unit(of_linear, "bearing_viscous", "coefficient"), "N s/m");
  EXPECT_EQ(unit(of_rotary, "bearing_viscous", "coefficient"), "N m s/rad");
  EXPECT_EQ(unit(of_linear, "bearing_stribeck", "stribeck_speed"), "m/s");
  EXPECT_EQ(unit(of_linear, "torque_offset", "torque"), "N");
  EXPECT_EQ(unit(of_linear, "torque_ripple", "amplitude"), "N m");
  EXPECT_EQ(unit(effects_for(direct), "torque_ripple", "amplitude"), "N");
}

}  // namespace
}  // namespace slewlab::sim
