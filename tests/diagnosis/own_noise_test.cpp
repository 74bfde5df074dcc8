#include "diagnosis/own_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 1e-2;                           // [s]
constexpr double kEncoder = 1e-6, kAccelerometer = 0.02;  // [rad], [m/s^2]

// The bench's machine without play stands for three minutes; its sensors make white noise.
struct Standing : BenchProblem {
  Standing() {
    nominal.crane.drive.gearbox_play = nominal.crane.drive.pinion_play = 0.0;
    constexpr std::size_t kCount = 18000;
    Record record;
    record.name = "standing";
    record.step = record.encoder_period = record.sensor_period = kPeriod;
    record.group_count = 2;
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal;
    for (std::size_t g = 0; g < 2; ++g) {
      for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(kCount, 0.0);
      for (double& value : record.shaft_position[g]) value = kEncoder * normal(engine);
    }
    for (std::vector<double>& series : record.acceleration) {
      series.assign(kCount, 0.0);
      for (double& value : series) value = kAccelerometer * normal(engine);
    }
    thresholds.whitening.noise_corner = 0.0;
    add(record);
  }
};

TEST(OwnNoise, IsOneInTheNominalMachine) {
  Standing problem;
  const Eigen::VectorXd difference = differences(problem, Point{});
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(difference.size(), 2);
  const ByOwnNoise own = by_own_noise(problem, {}, difference, columns, 1.0);
  const double near = 1e-9 * difference.squaredNorm();
  EXPECT_NEAR(own.square, difference.squaredNorm(), near);
  EXPECT_LT((own.gram - columns.transpose() * columns).cwiseAbs().maxCoeff(), near);
  EXPECT_LT((own.slope - columns.transpose() * difference).cwiseAbs().maxCoeff(), near);
  EXPECT_NEAR(square_by_less_noise(problem, {}, difference, 1.0), difference.squaredNorm(), near);
  EXPECT_NEAR(mean_square_of_noise(problem, Point{}), 1.0, 1e-9);
}

// Nothing but noise is in the record. The residuals of a boom that is damped eight times as much, and of one on a softer ring, are another noise than
// the nominal machine's, without these booms being right. By their own covariance their residuals are as large as the true machine's, within what the
// mean of six times 3600 squares scatters by, four deviations; and as the problem divides them they are as many times the true machine's as it is told. One way by the covariance, one by its root.
TEST(OwnNoise, IsWhatIsLeftOfNoiseAloneByAnotherMachine) {
  Standing problem;
  const double of_truth = differences(problem, Point{}).squaredNorm();
  for (const common::EffectInstance& effect : {common::EffectInstance{"boom_damping", {8.0}}, common::EffectInstance{"boom_stiffness", {0.85}}}) {
    Point point;
    point.effects = {effect};
    const Eigen::VectorXd difference = differences(problem, point);
    const auto count = static_cast<double>(difference.size());
    const double scatter = 4.0 * std::sqrt(2.0 / count);
    EXPECT_NEAR(by_own_noise(problem, point, difference, {}, 1.0).square / count, of_truth / count, scatter) << effect.name;
    EXPECT_GT(std::fabs(difference.squaredNorm() - of_truth) / count, 2.0 * scatter) << effect.name << ": else nothing is shown";
    EXPECT_NEAR(mean_square_of_noise(problem, point) / (difference.squaredNorm() / of_truth), 1.0, scatter) << effect.name;
    const Eigen::VectorXd divided = divided_by_own_noise(problem, point, difference);
    EXPECT_NEAR(divided.squaredNorm(), by_own_noise(problem, point, difference, {}, 1.0).square, 1e-9 * divided.squaredNorm()) << effect.name;
    problem.is_by_own_noise = true;
    EXPECT_EQ(differences(problem, point), divided) << effect.name;
    problem.is_by_own_noise = false;
  }
}

// A force that acts while the machine runs and is not linear, as dry friction, changes nothing, nor does play, whose teeth lie on their flanks; a linear force does.
TEST(OwnNoise, KnowsWhatIsLinear) {
  Standing problem;
  const Eigen::VectorXd difference = differences(problem, Point{});
  const auto change_by = [&](const common::EffectInstance& effect) {
    Point point;
    point.effects = {effect};
    return std::fabs(by_own_noise(problem, point, difference, {}, 1.0).square / difference.squaredNorm() - 1.0);
  };
  common::EffectInstance viscous = common::typical_instance(problem.catalogue.at("bearing_viscous"));
  viscous.values[0] *= 10.0;
  EXPECT_LT(change_by(common::typical_instance(problem.catalogue.at("larger_play"))), 1e-9);
  EXPECT_LT(change_by(common::typical_instance(problem.catalogue.at("bearing_coulomb"))), 1e-9);
  EXPECT_GT(change_by(viscous), 1e-5);
}

// A controller hands its encoders' noise on to the machine, by torques that the record holds. Nothing is missing, so another inertia of the house
// can reduce the residual by chance alone: one parameter more takes away chi squared of one degree of freedom (13 of one machine in three thousand),
// of which the cost counts its share. By the variance of each channel alone it took away 30 to 60, with a house of a tenth of its inertia.
TEST(OwnNoise, OfEncodersThatGoesThroughTheControllerSpeaksForNoOtherMachine) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    BenchProblem problem;
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    problem.gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, kPeriod));
    problem.add(make_record(simulated_log(truth, bench().controller, kInching, kDuration, seed, kPeriod), "inching", bench().admission));
    const FitResult base = fit_parameters_alone(problem, nominal_fit(problem));
    Point start = base.point;
    start.effects = {common::typical_instance(problem.catalogue.at("house_inertia"))};
    FitResult other = fit(problem, base.columns, start);
    settle(problem, other, 10);
    EXPECT_GT(other.cost, base.cost - 13.0 * problem.settings.independent_share) << "house of " << other.point.effects[0].values[0];
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
