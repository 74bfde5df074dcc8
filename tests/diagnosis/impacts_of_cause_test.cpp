#include "diagnosis/impacts_of_cause.h"

#include <gtest/gtest.h>

#include <vector>

#include "diagnosis/fit.h"
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

}  // namespace
}  // namespace slewlab::diagnosis
