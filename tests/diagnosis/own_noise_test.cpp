#include "diagnosis/own_noise.h"

#include <gtest/gtest.h>

#include <random>

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

struct Channels {
  double left = 0.0;      // mean square of the differences
  double expected = 0.0;  // mean of v
};
// Of one channel.
Channels of_channel(Problem& problem, const Point& point, std::size_t channel) {
  const auto rows = static_cast<Eigen::Index>(2 * problem.whitening.front().bin_count);
  const Eigen::VectorXd difference = differences(problem, point).segment(rows * static_cast<Eigen::Index>(channel), rows);
  const Eigen::VectorXd variance = own_noise(problem, point).segment(rows * static_cast<Eigen::Index>(channel), rows);
  return {difference.squaredNorm() / static_cast<double>(rows), variance.mean()};
}

TEST(OwnNoise, IsOneInTheNominalMachine) {
  Standing problem;
  const Eigen::VectorXd variance = own_noise(problem, {});
  EXPECT_EQ(variance.size(), difference_count(problem));
  EXPECT_LT((variance.array() - 1.0).abs().maxCoeff(), 1e-9);
}

// Nothing but noise is in the record. A boom that is damped eight times as much, and one on a softer ring, leave less of it than the nominal one, without being right; that is what
// is expected of them, channel by channel, within what the means of 2 times 3600 squares scatter by.
TEST(OwnNoise, IsWhatIsLeftOfNoiseAloneByAnotherMachine) {
  Standing problem;
  for (const common::EffectInstance& effect : {common::EffectInstance{"boom_damping", {8.0}}, common::EffectInstance{"boom_stiffness", {0.85}}}) {
    Point point;
    point.effects = {effect};
    const std::size_t channels = problem.whitening.front().channels.size();
    double least = 1.0;
    for (std::size_t c = 0; c < channels; ++c) {
      const Channels channel = of_channel(problem, point, c);
      EXPECT_NEAR(channel.left, channel.expected, 0.1 * channel.expected) << effect.name << ", channel " << c;
      least = std::min(least, channel.expected);
    }
    if (effect.name == "boom_damping") {
      EXPECT_LT(least, 0.9) << "the tip's accelerometer shakes a damped boom less";
    }
  }
}

// A force that acts while the machine runs and is not linear, as dry friction, changes nothing, nor does play, whose teeth lie on their flanks; a linear force does.
TEST(OwnNoise, KnowsWhatIsLinear) {
  Standing problem;
  Point dry, viscous, play;
  play.effects = {common::typical_instance(problem.catalogue.at("larger_play"))};
  EXPECT_LT((own_noise(problem, play).array() - 1.0).abs().maxCoeff(), 1e-9);
  dry.effects = {common::typical_instance(problem.catalogue.at("bearing_coulomb"))};
  viscous.effects = {common::typical_instance(problem.catalogue.at("bearing_viscous"))};
  viscous.effects.front().values[0] *= 10.0;
  EXPECT_LT((own_noise(problem, dry).array() - 1.0).abs().maxCoeff(), 1e-9);
  EXPECT_GT((own_noise(problem, viscous).array() - 1.0).abs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace slewlab::diagnosis
