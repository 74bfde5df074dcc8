// Expected numbers: those of the machine that made the log.
#include "diagnosis/own_noise_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/parameters_alone.h"
#include "sim/machine/machine_file.h"
#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

const std::string kConfig = SLEWLAB_SOURCE_DIR "/config/";
constexpr double kPeriod = 5e-3, kLong = 24.0;  // [s]

// The first fit of one effect, by the nominal machine's noise.
FitResult fitted_alone(Problem& problem, const char* effect) {
  const FitResult base = fit_parameters_alone(problem, nominal_fit(problem));
  Point start = base.point;
  start.effects = {common::typical_instance(problem.catalogue.at(effect))};
  FitResult fitted = fit(problem, base.columns, start);
  settle(problem, fitted, 10);
  conclude(problem, fitted);
  return fitted;
}

// A light crane whose house twists so easily that it shakes with the encoders' noise. By the nominal machine's noise the fit ends where the house makes less of that.
TEST(OwnNoiseFit, FindsWhatTheNominalMachinesNoiseHides) {
  const common::EffectInstance twists{"house_compliance", {3e8, 0.43}};  // [Nm/rad], [-]
  sim::MachineSettings truth;
  truth.crane = sim::load_machine_file(kConfig + "cranes/harbour_5t.yaml").parameters;
  const sim::CraneParameters nominal = truth.crane;
  truth.crane.boom.element_count = kBoomElements;
  truth.effects = {twists};
  controller::ControllerSettings controller = controller::load_controller_file(kConfig + "controllers/harbour_5t.yaml").settings;
  const std::vector<Move> moves{{2.0, 0.6}, {9.0, 0.0}, {12.0, -0.4}, {18.0, 0.0}};
  Admitted admitted({simulated_log(truth, controller, moves, kLong, 4, kPeriod)}, nominal);
  Problem& problem = admitted.problem;
  problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
  whiten_again(problem, admitted.whitening);
  std::vector<FitResult> fits{fitted_alone(problem, "house_compliance")};
  const std::vector<double> before = fits.front().point.effects.front().values;
  fit_by_own_noise(problem, fits);
  const FitResult& found = fits.front();
  const std::vector<double>& values = found.point.effects.front().values;
  EXPECT_NEAR(values[0] / twists.values[0], 1.0, 0.1) << before[0];
  EXPECT_NEAR(values[1] / twists.values[1], 1.0, 0.15) << before[1];
  EXPECT_GT(std::fabs(before[1] / twists.values[1] - 1.0), 0.3) << "else nothing is shown";
  EXPECT_LT(found.mean_square, kNoiseAlone);
  EXPECT_GT(mean_square(found.difference), kNoiseAlone) << "by the nominal machine's noise";
  EXPECT_EQ(differences(problem, found.point), found.difference);
  EXPECT_FALSE(problem.is_by_own_noise);
}

// Friction that is not linear makes nothing else of the noise: its fit stays where it is.
TEST(OwnNoiseFit, LeavesWhatHasTheNominalMachinesNoise) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {common::typical_instance(sim::effects_for(truth).at("bearing_coulomb"))};
  Admitted admitted({simulated_log(truth, bench().controller, kInching, kDuration, 2, kPeriod)});
  std::vector<FitResult> fits{fitted_alone(admitted.problem, "bearing_coulomb")};
  const FitResult before = fits.front();
  EXPECT_FALSE(makes_other_noise(admitted.problem, before.point));
  fit_by_own_noise(admitted.problem, fits);
  EXPECT_EQ(fits.front().point.effects.front().values, before.point.effects.front().values);
  EXPECT_EQ(fits.front().cost, before.cost);
  // A boom that buckles makes no noise at all.
  Problem& problem = admitted.problem;
  problem.nominal.crane.boom.youngs_modulus *= 1e-3;  // whose Euler load is beyond 4 MN no more
  EXPECT_FALSE(makes_other_noise(problem, admitted.at({{"compression_softening", {4e6}}})));
  fits.front().point = admitted.at({{"compression_softening", {4e6}}});
  EXPECT_NO_THROW(fit_by_own_noise(problem, fits));
}

}  // namespace
}  // namespace slewlab::diagnosis
