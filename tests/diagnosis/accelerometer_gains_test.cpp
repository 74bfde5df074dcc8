#include "diagnosis/accelerometer_gains.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/admit.h"
#include "diagnosis/coordinates.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;  // [s]

// A sound crane whose tip accelerometer reads by a gain that its file does not have; the other accelerometers are read or not.
Record record_of(double tip_gain, bool has_others) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.crane.boom.element_count = kBoomElements;
  truth.crane.sensors.tip_gain = tip_gain;
  Record record = make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 5, kPeriod), "a", bench().admission);
  for (int a = 0; a < kAccelerometerCount; ++a) {
    if (a != kTip && !has_others) record.acceleration[static_cast<std::size_t>(a)].clear();
  }
  return record;
}

void take(Record record, Problem& problem) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  std::vector<Record> records;
  records.push_back(std::move(record));
  set_machine(nominal, records, problem);
  std::vector<std::string> remarks;
  admit(std::move(records), whitening_for(problem.thresholds, false), problem, remarks);
}

TEST(AccelerometerGains, TheGainOfOneThatReadsTooMuchIsFound) {
  constexpr double kGain = 1.06;
  for (const bool has_others : {false, true}) {
    Problem problem;
    take(record_of(kGain, has_others), problem);
    const FitResult alone = fit_parameters_alone(problem, nominal_fit(problem));
    const std::optional<GainsFit> found = fit_gains(problem, alone);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->gains.size(), has_others ? 3u : 1u);
    const AccelerometerGain& tip = found->gains.back();
    EXPECT_EQ(tip.name, "tip accelerometer gain");
    EXPECT_NEAR(tip.gain, kGain, 0.01);
    EXPECT_LT(tip.deviation, 0.01);
    EXPECT_LT(found->fit.mean_square, 1.0);
    EXPECT_LT(found->fit.cost, alone.cost);
    EXPECT_NE(in_words(found->gains).find("tip accelerometer gain 1.0"), std::string::npos) << in_words(found->gains);
  }
}

TEST(AccelerometerGains, NoneOfARecordWithoutAccelerometers) {
  Record record = record_of(1.0, false);
  record.acceleration[kTip].clear();
  Problem problem;
  take(std::move(record), problem);
  EXPECT_FALSE(fit_gains(problem, nominal_fit(problem)));
}

// By hand: E of the gains is 10 + 2 + ln(1 + 0.5 * 6) = 12 + ln 4, of the cause 11 + 1 + ln(1 + 0.5 * 2) = 12 + ln 2 and what its size costs, which does not count; with T = 2 the odds are
// exp(-ln 2 / 4). They are the answer where they leave noise alone and everything else leaves much more.
TEST(AccelerometerGains, AreWeighedAsHypothesesAre) {
  const BenchProblem problem;
  EvidenceSettings settings;
  settings.independent_share = 0.5;
  settings.temper = 2.0;
  GainsFit gains;
  gains.fit.mean_square = 0.9;
  gains.fit.residual_power = 10.0;
  gains.fit.prior = 2.0;
  gains.fit.information = Eigen::VectorXd::Constant(1, 6.0);
  FitResult cause;
  cause.point.effects = {{"load_mass", {1.6}}};
  const double of_size = effect_prior(effect_coordinates(problem.catalogue, cause.point.effects)(0)).cost;
  ASSERT_GT(of_size, 0.1);
  cause.residual_power = 11.0;
  cause.prior = 1.0 + of_size;
  cause.information = Eigen::VectorXd::Constant(1, 2.0);
  const double odds = std::exp(-std::log(2.0) / 4.0);
  EXPECT_NEAR(chance_of_gains(problem, gains, cause, settings), odds / (1.0 + odds), 1e-12);
  const std::array<const FitResult*, 1> others{&cause};
  EXPECT_FALSE(are_the_answer(problem, gains, others, settings));
  cause.residual_power = 1e4;
  EXPECT_NEAR(chance_of_gains(problem, gains, cause, settings), 1.0, 1e-12);
  EXPECT_TRUE(are_the_answer(problem, gains, others, settings));
  gains.fit.mean_square = 1.1;
  EXPECT_FALSE(are_the_answer(problem, gains, others, settings));
  gains.fit.mean_square = 0.9;
  gains.fit.prior = 400.0;  // of four parameters: 10 deviations each, and still less than 1e4
  gains.fit.information = Eigen::VectorXd::Constant(4, 1e3);
  EXPECT_FALSE(are_the_answer(problem, gains, others, settings));
}

// What the file may be right about is not told; all of them are the machine's.
TEST(AccelerometerGains, NamesThoseThatAreNotTheFiles) {
  std::vector<AccelerometerGain> gains;
  for (const sim::AccelerometerGain& one : sim::accelerometer_gains()) gains.push_back({std::string(one.parameter.name), one.parameter.numbers.front(), 1.01, 0.01});
  gains.back().gain = 0.94;
  EXPECT_EQ(in_words(gains), "tip accelerometer gain 0.940 (+-0.010)");
  sim::CraneParameters machine = bench().crane;
  machine.sensors.tip_gain = 2.0;
  machine = with_gains(machine, gains);
  EXPECT_DOUBLE_EQ(machine.sensors.tip_gain, 1.88);
  EXPECT_DOUBLE_EQ(machine.sensors.pivot_gain, 1.01);
}

}  // namespace
}  // namespace slewlab::diagnosis
