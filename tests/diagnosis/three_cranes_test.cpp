// Cranes of three makers' proportions, a 5 t harbour crane, the thesis's 30 t and a 900 t offshore crane, each with nothing missing and
// with the same effects at the typical size that its own description gives: the right first cause on all three. What is not right on all
// three yet stands in docs/diagnosis/limits.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/diagnose.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/machine_file.h"
#include "sim/machine/scales.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

struct ThreeCranesCase {
  const char* crane;
  const char* effect;  // "": nothing is missing
};

void PrintTo(const ThreeCranesCase& one, std::ostream* out) { *out << one.crane << ' ' << one.effect; }

class ThreeCranes : public testing::TestWithParam<ThreeCranesCase> {};

// To one side and back, each with a stop, in 2.6 periods of the load: what a crane does on any day.
std::vector<Move> there_and_back(double swing) { return {{0.13 * swing, 1.0}, {0.9 * swing, 0.0}, {1.3 * swing, -1.0}, {2.1 * swing, 0.0}}; }

TEST_P(ThreeCranes, AreDiagnosedAlike) {
  const std::string config = SLEWLAB_SOURCE_DIR "/config/", effect = GetParam().effect;
  const sim::MachineFile file = sim::load_machine_file(config + "cranes/" + GetParam().crane + ".yaml");
  const controller::ControllerSettings controller = [&] {
    controller::ControllerSettings settings = controller::load_controller_file(config + "controllers/" + GetParam().crane + ".yaml").settings;
    settings.period = kStep;
    return settings;
  }();
  const sim::MachineSettings nominal = sim::machine_settings(file);
  sim::MachineSettings truth = nominal;
  if (!effect.empty()) truth.effects.push_back(common::typical_instance(sim::effects_for(nominal).at(effect)));
  const double swing = 1.0 / sim::pendulum_modes(file.parameters).front();  // [s]
  const msgs::RunLog log = simulated_log(truth, controller, there_and_back(swing), 2.6 * swing, 3);
  const Thresholds thresholds = thresholds_of(sim::describe(file));
  DiagnosisSettings settings;
  settings.hold_out = true;
  settings.threads = 2;
  const Diagnosis found = diagnose(nominal, controller, {make_record(log, "there and back", thresholds.admission)}, settings);
  std::string table = fmt::format(" | residual variance ratio nominal {:.3g}, best parameters {:.3g}", found.mean_square_nominal, found.mean_square_parameters);
  for (std::size_t i = 0; i < std::min<std::size_t>(3, found.causes.size()); ++i) {
    table += fmt::format(" | {} {:.3f} (residual variance ratio {:.3g})", name_of(found.causes[i]), found.causes[i].probability, found.causes[i].mean_square);
  }
  if (effect.empty()) {
    EXPECT_FALSE(found.gap) << found.verdict << table;
    return;
  }
  EXPECT_TRUE(found.gap) << table;
  ASSERT_FALSE(found.causes.empty()) << found.verdict;
  EXPECT_EQ(name_of(found.causes.front()), effect) << found.verdict << table;
}

std::vector<ThreeCranesCase> cases() {
  std::vector<ThreeCranesCase> all;
  for (const char* crane : {"harbour_5t", "thesis", "offshore_900t"}) {
    for (const char* effect : {"", "bearing_viscous", "torque_lag", "dragging_brake"}) all.push_back({crane, effect});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Cranes, ThreeCranes, testing::ValuesIn(cases()), [](const auto& one) {
  std::string name = std::string(one.param.crane) + "_" + (*one.param.effect == '\0' ? "nothing" : one.param.effect);
  return name;
});

}  // namespace
}  // namespace slewlab::diagnosis
