// Expected numbers: the catalogue's own bounds; the withheld machine without any law, which differs from the known one in integrator, mesh and the
// tracking loop's lag alone; the size of a count.
#include "diagnosis/evaluation/known_laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "controller/effects/catalogue.h"
#include "diagnosis/evaluation/make.h"
#include "diagnosis/evaluation/measure.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis::withheld {
namespace {

const std::string kConfig = std::string(SLEWLAB_SOURCE_DIR) + "/config/";

const NominalMachine& thesis() {
  static const NominalMachine kThesis = nominal_machine(sim::describe(sim::load_machine_file(kConfig + "cranes/thesis.yaml")),
                                                        controller::load_controller_file(kConfig + "controllers/thesis.yaml").settings);
  return kThesis;
}

DrawnCase drawn_with(const std::vector<std::string>& names) {
  DrawnCase drawn = draw_cases(1, 5, thesis()).at(0);
  drawn.laws.clear();
  for (const std::string& name : names) {
    const Law& law = law_named(name);
    drawn.laws.push_back({name, std::sqrt(law.low * law.high) * law.unit(thesis().scales)});
  }
  drawn.spread.assign(thesis().description.parameters.size(), 1.0);
  return drawn;
}

KnownMachine known(const DrawnCase& drawn, std::vector<std::vector<TrueSize>>* sizes = nullptr) {
  return known_machine(drawn, thesis(), {}, std::vector<bool>(drawn.laws.size(), true), sizes);
}

const Manoeuvre kSlew{{{0.5, 0.6}, {7.0, 0.0}}, 12.0};

TEST(KnownLaws, EveryLawOfTheCatalogueActsAsItsOwnEffect) {
  int of_the_machine = 0, of_the_controller = 0;
  for (const Law& law : laws()) {
    if (law.effect.empty() || !suits(law, thesis().description.machine, thesis().controller)) continue;
    const DrawnCase drawn = drawn_with({law.name});
    std::vector<std::vector<TrueSize>> sizes;
    const KnownMachine machine = known(drawn, &sizes);
    ASSERT_TRUE(has_known_laws(drawn)) << law.name;
    ASSERT_EQ(sizes.size(), 1u);
    const common::EffectAbout* about = controller::effects_for(thesis().controller).find(law.effect);
    (about != nullptr ? of_the_controller : of_the_machine) += 1;
    ASSERT_EQ(machine.machine.effects.size(), about != nullptr ? 0u : 1u) << law.name;
    if (about != nullptr) continue;
    const common::EffectInstance& instance = machine.machine.effects[0];
    EXPECT_EQ(instance.name, law.effect);
    const common::EffectCatalogue catalogue = sim::effects_for(thesis().description.machine);
    EXPECT_NO_THROW(common::check_instance(catalogue.at(law.effect), instance)) << law.name;
    EXPECT_EQ(instance.values[0], sizes[0][0].value) << law.name;  // the first is the effect's size
    EXPECT_EQ(sizes[0][0].parameter, catalogue.at(law.effect).parameters[0].name) << law.name;
  }
  EXPECT_GE(of_the_machine, 35);
  EXPECT_EQ(of_the_controller, 5);
}

// A controller's law changes the controller that answers.
TEST(KnownLaws, AControllersEffectIsInItsSettings) {
  const KnownMachine plain = known(drawn_with({})), drooping = known(drawn_with({"droop_on"}));
  EXPECT_EQ(plain.controller.speed_control.droop, thesis().controller.speed_control.droop);
  EXPECT_GT(drooping.controller.speed_control.droop, plain.controller.speed_control.droop);
}

TEST(KnownLaws, ALawInNoCatalogueIsNotKnown) {
  for (const Law& law : laws()) {
    if (!law.effect.empty() || !suits(law, thesis().description.machine, thesis().controller)) continue;
    EXPECT_FALSE(has_known_laws(drawn_with({law.name}))) << law.name;
    EXPECT_THROW(known(drawn_with({law.name})), std::invalid_argument) << law.name;
  }
}

// The plant and the reference are the same machine: they differ by the finer mesh, the integrator's tolerance and the lag of the
// tracking loop, 2 / (2 pi 100 Hz) of the acceleration. Less than is called visible.
TEST(KnownLaws, WithoutAnyLawItIsTheWithheldMachine) {
  const DrawnCase drawn = drawn_with({});
  const TruthMachine withheld = build(drawn, thesis(), {});
  const TruthRun truth = run_truth(withheld, kSlew, {.noise_seed = 3, .reference = {.method = sim::ReferenceMethod::kDirk, .tolerance = 1e-5, .order = 3}});
  const TruthRun other = run_known(known(drawn), kSlew, 3);
  ASSERT_EQ(truth.sensors.size(), other.sensors.size());
  ASSERT_EQ(truth.shaft_speed[0].size(), other.shaft_speed[0].size());
  ASSERT_FALSE(other.contact_change_times.empty());
  const Visibility seen = visibility(truth, other, withheld);
  EXPECT_LT(seen.largest, 3.0) << seen.signal;
  // Same sensors: the same noise, drawn by the same seed.
  EXPECT_EQ(truth.sensors[0].tip_acceleration, other.sensors[0].tip_acceleration);
}

TEST(KnownLaws, EncodersCountAndTheDrivesSpeedCarriesWhatCountingAdds) {
  const KnownMachine machine = known(drawn_with({}));
  const TruthRun run = run_known(machine, kSlew, 3);
  double square = 0.0;
  for (std::size_t k = 0; k < run.shaft_speed[0].size(); ++k) {
    const double counts = run.shaft_position[0][k] / machine.counting.resolution;
    ASSERT_NEAR(counts, std::round(counts), 1e-6);
    const double error = run.shaft_speed[0][k] - run.true_speed[0][k];
    square += error * error;
  }
  const double deviation = std::sqrt(square / static_cast<double>(run.shaft_speed[0].size()));
  const double expected = counting_noise(machine.counting, thesis().scales.top_shaft_speed);
  EXPECT_GT(deviation, 0.5 * expected);
  EXPECT_LT(deviation, 2.0 * expected);
}

TEST(KnownLaws, SameSeedSameBits) {
  const KnownMachine machine = known(drawn_with({"two_hops"}));
  const TruthRun one = run_known(machine, kSlew, 3), same = run_known(machine, kSlew, 3), other = run_known(machine, kSlew, 4);
  EXPECT_EQ(one.motor_torque[0], same.motor_torque[0]);
  EXPECT_NE(one.motor_torque[0], other.motor_torque[0]);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
