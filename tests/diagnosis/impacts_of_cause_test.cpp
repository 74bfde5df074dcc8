#include "diagnosis/impacts_of_cause.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "sim/machine/machine_file.h"
#include "tests/diagnosis/admitted.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;  // [s] of a PLC
const common::EffectInstance kLag{"torque_lag", {0.03, 0.2}};
const common::EffectInstance kHeavierLoad{"load_mass", {1.3}};

std::vector<msgs::RunLog> quiet_logs(const std::vector<common::EffectInstance>& effects) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = 20;
  truth.effects = effects;
  return {quiet_log(truth, bench().controller, kThereAndBack, kDuration, kPeriod)};
}

// A log without any noise of a crane with such effects, its boom cut finer than the one that is to follow it, admitted on the nominal crane.
struct AdmittedWith : Admitted {
  explicit AdmittedWith(const std::vector<common::EffectInstance>& effects) : Admitted(quiet_logs(effects)), admitted(problem.nominal) {
    problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
  }
  double left(const Point& point) { return mean_square(differences(problem, point)); }

  sim::MachineSettings admitted;
};

// With a late torque and a heavier load the gears let go in the middle of the record, where those of the nominal crane, and of a crane with the late
// torque alone, just do not. The residual there outweighs the rest of the load's until it is taken out; the nominal crane is judged there no more
// either. Judge: where the true crane's teeth are apart.
TEST(ImpactsOfCause, AreTakenOutWhereTheCauseMayHaveThem) {
  AdmittedWith record({kLag, kHeavierLoad});
  const Point lag = record.at({kLag});
  const std::vector<bool> apart = shadow_at(record.problem, record.at({kLag, kHeavierLoad}), 0).contact_lost;
  const auto judged = [&](std::size_t n) { return record.problem.whitening[0].window[n] > 0.0; };
  std::vector<std::size_t> struck;
  for (std::size_t n = 0; n < apart.size(); ++n) {
    if (apart[n] && judged(n)) struck.push_back(n);
  }
  ASSERT_FALSE(struck.empty());
  const double before = record.left(lag);
  const double share = take_out_impacts(record.problem, record.admitted, record.whitening, lag);
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 0.15);  // what the observer needs to forget one impact
  EXPECT_LT(record.left(lag), 0.1 * before);
  for (const std::size_t n : struck) EXPECT_FALSE(judged(n)) << n;
  EXPECT_LT(record.left(record.at({kLag, kHeavierLoad})), 1.0);
}

// Nothing is judged elsewhere where a machine's residual is not at impacts, or is noise alone.
TEST(ImpactsOfCause, LeaveWhatLiesElsewhereAsItIs) {
  const common::EffectInstance friction{"bearing_viscous", {1e7, 0.0}};
  AdmittedWith record({friction});
  const std::vector<double> window = record.problem.whitening[0].window;
  for (const Point& point : {record.at({}), record.at({friction})}) {
    EXPECT_EQ(take_out_impacts(record.problem, record.admitted, record.whitening, point), 0.0);
    EXPECT_EQ(record.problem.whitening[0].window, window);
    EXPECT_TRUE(record.problem.records[0].impacts_of_cause.empty());
  }
}

// A crane cut out of a slew, without noise: its load swings by no one's doing, and what it does to the gears comes at moments that a machine whose load
// hangs still does not have. What lies before them tells the swing to the rounding of the log, and the fit of the whole record starts there.
TEST(ImpactsOfCause, AreThoseOfALoadThatSwingsWhenTheRecordBegins) {
  sim::MachineSettings truth;
  truth.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/harbour_5t.yaml").parameters;
  const controller::ControllerSettings controller = controller::load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/harbour_5t.yaml").settings;
  const std::vector<Move> moves{{2.0, 1.0}, {16.0, 0.0}, {25.0, -1.0}, {38.0, 0.0}};
  msgs::RunLog log = quiet_log(truth, controller, moves, 50.0, kPeriod);
  leave_out_beginning(log, std::lround(10.0 / kPeriod));
  Admitted record({log}, truth.crane);
  Problem& problem = record.problem;
  const sim::MachineSettings admitted = problem.nominal;
  const std::vector<double> window = problem.whitening[0].window;
  const std::optional<FitResult> begun = begun_before_impacts(problem, admitted, record.whitening);
  ASSERT_TRUE(begun);
  EXPECT_LT(begun->mean_square, 0.1);
  EXPECT_EQ(problem.whitening[0].window, window);
  EXPECT_TRUE(problem.records[0].impacts_of_cause.empty());
  const auto there = [&] { return fit_at(problem, begun->point); };
  const double before = there().mean_square;
  EXPECT_GT(before, 1.0) << "its impacts must outweigh the rest for the test to say anything";
  EXPECT_GT(take_out_impacts(problem, admitted, record.whitening, begun->point), 0.0);
  EXPECT_LT(there().mean_square, 0.1 * before);
  EXPECT_LT(fit_parameters_alone(problem, there()).mean_square, 0.1);
}

TEST(ImpactsOfCause, OfABeginningThatNothingMovedBeforeAreNotAskedFor) {
  AdmittedWith record({kLag, kHeavierLoad});
  EXPECT_FALSE(begun_before_impacts(record.problem, record.admitted, record.whitening));
}

}  // namespace
}  // namespace slewlab::diagnosis
