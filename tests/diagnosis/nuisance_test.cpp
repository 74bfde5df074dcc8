#include "diagnosis/nuisance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "sim/effects/catalogue.h"
#include "sim/machine/description.h"
#include "sim/machine/machine_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

// The thesis's crane has all 16 parameters.
Nuisances thesis_nuisances() {
  return nuisances_of(sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml")), 3e-4);
}

// Both priors: the slope is half the derivative of the cost, by central differences.
TEST(Prior, SlopeIsHalfTheDerivative) {
  const double h = 1e-6;
  const Nuisances nuisances = thesis_nuisances();
  for (const double x : {-7.0, -2.5, -1.0, 0.0, 0.4, 1.99, 2.2, 5.0}) {
    EXPECT_NEAR(nuisance_prior(nuisances, 0, x).slope,
                (nuisance_prior(nuisances, 0, x + h).cost - nuisance_prior(nuisances, 0, x - h).cost) / (4.0 * h), 1e-5) << x;
    EXPECT_NEAR(effect_prior(x).slope, (effect_prior(x + h).cost - effect_prior(x - h).cost) / (4.0 * h), 1e-6) << x;
  }
}

// Within the spread from unit to unit a nuisance's prior is the normal one; outside it is prohibitive: 10 % are 3.5
// standard deviations, and e^-40 is never worth a better name.
TEST(Prior, NuisancesEndWhereUnitsDo) {
  EXPECT_EQ(nuisance_prior(thesis_nuisances(), 3, 1.5).cost, 2.25);
  EXPECT_GT(nuisance_prior(thesis_nuisances(), 3, 0.10 / sim::kUnitDeviation).cost, 75.0);
}

// The encoders' latency has no such bounds.
TEST(Prior, LatencyIsNormal) {
  const Nuisances nuisances = thesis_nuisances();
  EXPECT_EQ(nuisance_prior(nuisances, nuisances.common_count() - 1, 4.0).cost, 16.0);
}

// Student's t with 2 degrees of freedom: -2 ln of (1 + x^2 / 2)^(-3/2), with the scale that gives unit curvature at 0.
TEST(Prior, LargeSizesStayPossible) {
  EXPECT_NEAR(effect_prior(0.01).cost, 1e-4, 1e-8);
  EXPECT_NEAR(effect_prior(20.0).cost, 3.0 * std::log(1.0 + 400.0 / 3.0), 1e-12);
  EXPECT_LT(effect_prior(20.0).cost, 15.0);
}

// A load 6 % too heavy is beyond the 5 % by which machines of one make differ, and the load's own effect says so; one of 4 % is not, and no other effect does.
TEST(Nuisance, WhatIsBeyondItsSpreadIsSaidByItsEffect) {
  const Nuisances nuisances = thesis_nuisances();
  const common::EffectAbout& load_mass = sim::find_effect("load_mass")->about;
  std::vector<double> amount(nuisances.count(1), 0.0);
  std::size_t load = 0;
  while (nuisances.parameters.at(load).name != "load mass") ++load;
  amount[load] = -0.06 / sim::kUnitDeviation;
  EXPECT_TRUE(says_what_is_beyond(nuisances, load_mass, amount));
  EXPECT_FALSE(says_what_is_beyond(nuisances, sim::find_effect("boom_stiffness")->about, amount));
  EXPECT_FALSE(says_what_is_beyond(nuisances, sim::find_effect("bearing_viscous")->about, amount));
  amount[load] = -0.04 / sim::kUnitDeviation;
  EXPECT_FALSE(says_what_is_beyond(nuisances, load_mass, amount));
}

TEST(Nuisance, EffectsSayWhatParametersSay) {
  int said = 0;
  const Nuisances nuisances = thesis_nuisances();
  for (std::size_t k = 0; k < nuisances.count(2); ++k) {
    said += is_said_by(nuisances, sim::find_effect("boom_stiffness")->about, k) ? 1 : 0;
    EXPECT_FALSE(is_said_by(nuisances, sim::find_effect("bearing_coulomb")->about, k));
  }
  EXPECT_EQ(said, 2);  // bending and torsion
}

// What is written is read back as the crane that was meant, laid over the nominal one; what did not change is not written.
TEST(Nuisance, ParametersAreWrittenAsSectionsOfACraneFile) {
  const std::string thesis = SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml";
  const sim::CraneParameters nominal = sim::load_machine_file(thesis).parameters;
  const Nuisances nuisances = thesis_nuisances();
  std::vector<double> amount(nuisances.count(1), 0.0);
  for (std::size_t k = 1; k < nuisances.parameters.size(); ++k) amount[k] = 0.1 * static_cast<double>(k) - 0.85;
  std::vector<AmountInterval> intervals;
  for (const double one : amount) intervals.push_back({one - 0.5, one + 1.0});
  const std::string text = parameters_text(nuisances, nominal, amount, intervals, "test");
  EXPECT_EQ(text.find("motor_inertia"), std::string::npos);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "crane.yaml";
  std::ofstream(file) << "include: " << thesis << "\n" << text;
  sim::CraneParameters read = sim::load_machine_file(file).parameters, meant = with_nuisances(nuisances, nominal, amount);
  for (const sim::Parameter& parameter : nuisances.parameters) {
    for (const sim::FileNumber& number : parameter.numbers) EXPECT_EQ(number.of(read), number.of(meant)) << number.key;
  }
  // Each with its interval in its own unit: half a standard deviation of the spread below, a whole one above.
  const auto load = std::find_if(nuisances.parameters.begin(), nuisances.parameters.end(), [](const sim::Parameter& one) { return one.name == "load mass"; });
  ASSERT_NE(load, nuisances.parameters.end());
  const double at = amount[static_cast<std::size_t>(load - nuisances.parameters.begin())], mass = nominal.load.mass;
  EXPECT_NE(text.find(fmt::format("; 90 %: {:.4g} to {:.4g}\"", mass * (1.0 + load->spread * (at - 0.5)), mass * (1.0 + load->spread * (at + 1.0)))), std::string::npos) << text;
}

// By hand, spreads of 3 %: +4.5 +- 1.5 %, -6 +- 0.9 %; not 6 +- 3.6 % (chance may do it), nor 0.6 +- 0.03 % (worth little). The latency behind them is no number of the file.
TEST(Nuisance, ParametersThatTheRecordsPutElsewhereAreTold) {
  Nuisances nuisances;
  nuisances.parameters = {{"load mass", 0.03, {}}, {"boom angle", 0.03, {}}, {"rope length", 0.03, {}}, {"play", 0.03, {}}};
  const std::vector<double> amount{1.5, 2.0, -2.0, 0.2, 9.0};
  const std::vector<AmountInterval> intervals{{1.0, 2.0}, {0.8, 3.2}, {-2.3, -1.7}, {0.19, 0.21}, {8.9, 9.1}};
  const std::vector<MovedParameter> moved = moved_parameters(nuisances, amount, intervals);
  ASSERT_EQ(moved.size(), 2u);
  EXPECT_EQ(moved[0].name, "rope length");
  EXPECT_NEAR(moved[0].change, -0.06, 1e-12);
  EXPECT_NEAR(moved[0].low, -0.069, 1e-12);
  EXPECT_NEAR(moved[0].high, -0.051, 1e-12);
  EXPECT_EQ(moved[1].name, "load mass");
  EXPECT_NEAR(moved[1].change, 0.045, 1e-12);
}

TEST(Nuisance, LatencyComesBehindTheParameters) {
  const Nuisances nuisances = thesis_nuisances();
  std::vector<double> amount(nuisances.count(1), 0.0);
  amount[nuisances.common_count() - 1] = 2.0;
  EXPECT_DOUBLE_EQ(encoder_latency(nuisances, amount), 6e-4);
  EXPECT_EQ(encoder_latency(nuisances, {}), 0.0);
}

// Two amounts per record behind the others; the rate's goes with the pendulum's frequency sqrt(g / L).
TEST(Nuisance, EachRecordHasItsSwing) {
  Nuisances nuisances = thesis_nuisances();
  nuisances.rope_length = 40.0;
  std::vector<double> amount(nuisances.count(2), 0.0);
  amount[nuisances.count(1)] = 2.0;
  amount[nuisances.count(1) + 1] = -1.0;
  EXPECT_EQ(beginning_of(nuisances, amount, 0).swing, 0.0);
  EXPECT_DOUBLE_EQ(beginning_of(nuisances, amount, 1).swing, 2.0 * kSwingDeviation);
  EXPECT_DOUBLE_EQ(beginning_of(nuisances, amount, 1).swing_rate, -kSwingDeviation * std::sqrt(9.81 / 40.0));
  EXPECT_EQ(beginning_of(nuisances, amount, 2).swing, 0.0);
  EXPECT_EQ(swing_reach(nuisances, amount, 0), 0.0);
  EXPECT_DOUBLE_EQ(swing_reach(nuisances, amount, 1), std::sqrt(5.0) * kSwingDeviation);
  EXPECT_EQ(swing_reach(nuisances, amount, 2), 0.0);
}

// Behind a record that begins in motion lie a rod that swings and a boom that bends; beside it one that begins at rest has none.
// Behind one that begins at rest, the drives on, lie moves whose swing no damping has taken away.
TEST(Nuisance, ARecordInMotionHasItsRodAndItsBoom) {
  Nuisances nuisances = thesis_nuisances();
  nuisances.rope_length = 40.0;
  const std::size_t at_rest = nuisances.per_record();
  nuisances.has_motion = true;
  nuisances.begins = {RecordBegins::unmoved, RecordBegins::in_motion, RecordBegins::at_rest};
  EXPECT_EQ(nuisances.per_record(), at_rest + 4 + 2 * kBeginningBends);
  const std::vector<double> amount(nuisances.count(3), 1.0);
  const Beginning standing = beginning_of(nuisances, amount, 0), moving = beginning_of(nuisances, amount, 1), behind = beginning_of(nuisances, amount, 2);
  EXPECT_EQ(standing.swing, kSwingDeviation);
  EXPECT_EQ(standing.rod, 0.0);
  EXPECT_EQ(standing.bend[0], 0.0);
  EXPECT_EQ(moving.swing, nuisances.swing_behind_moves);
  EXPECT_EQ(behind.swing, nuisances.swing_behind_moves);
  EXPECT_EQ(behind.rod, kSwingDeviation);
  // The rated torque inclines the rope by R theta'' / g.
  const sim::Scales scales = sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml")).scales;
  EXPECT_NEAR(moving.swing, scales.reach * scales.axis_torque / scales.axis_inertia / 9.81, 1e-9);
  EXPECT_EQ(moving.rod, kSwingDeviation);
  for (std::size_t mode = 0; mode < kBeginningBends; ++mode) {
    EXPECT_EQ(moving.bend[mode], kBendDeviation);
    EXPECT_EQ(moving.bend_rate[mode], kBendDeviation);
  }
  // Turning at top speed inclines it outwards by R theta'^2 / g.
  EXPECT_NEAR(moving.outwards, scales.reach * scales.top_speed * scales.top_speed / 9.81, 1e-12);
  EXPECT_NEAR(moving.outward_rate, moving.outwards * std::sqrt(9.81 / 40.0), 1e-12);
  EXPECT_EQ(standing.outwards, 0.0);
  std::size_t outward = 0;
  for (std::size_t part = 0; part < nuisances.per_record(); ++part) outward += nuisances.is_outward(part) ? 1U : 0U;
  EXPECT_EQ(outward, 2U);
  EXPECT_TRUE(nuisances.is_outward(nuisances.per_record() - 1));
  // Nobody's swing outwards where no effect knows of it.
  nuisances.outward_swing = 0.0;
  EXPECT_EQ(nuisances.per_record(), at_rest + 2 + 2 * kBeginningBends);
  EXPECT_EQ(beginning_of(nuisances, amount, 1).outwards, 0.0);
  EXPECT_FALSE(nuisances.is_outward(nuisances.per_record() - 1));
}

// A machine has only the parameters that it has: no load, no swing.
TEST(Nuisance, AMachineWithoutALoadHasNoSwing) {
  const Nuisances nuisances = nuisances_of(sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/no_load.yaml")), 3e-4);
  EXPECT_EQ(nuisances.count(2), nuisances.common_count());
  EXPECT_EQ(thesis_nuisances().parameters.size() - nuisances.parameters.size(), 4U);  // its mass, its rope, its rod, its damping
  EXPECT_EQ(beginning_of(nuisances, std::vector<double>(nuisances.count(2), 1.0), 1).swing, 0.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
