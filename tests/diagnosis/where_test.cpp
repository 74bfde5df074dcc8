#include "diagnosis/where.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "diagnosis/record.h"
#include "tests/diagnosis/bench.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kSlow = 0.3;  // [Hz]

// One record, and differences of 1 everywhere, of which a fit takes away what `takes` says.
class SlowPart : public testing::Test {
 protected:
  SlowPart() {
    sim::MachineSettings truth;
    truth.crane = bench().crane;
    problem.add(make_record(simulated_log(truth, bench().controller, kThereAndBack, kDuration, 3, 1e-2), "a", bench().admission));
    difference = left = Eigen::VectorXd::Ones(difference_count(problem));
  }
  template <typename Takes>
  void take(const Takes& takes) {
    const Whitening& whitening = problem.whitening.front();
    Eigen::Index row = 0;
    for (const Channel& channel : whitening.channels) {
      for (std::size_t b = 0; b < whitening.bin_count; ++b, row += 2) {
        if (takes(channel, static_cast<double>(whitening.first_bin + b) * whitening.bin_width)) left.segment<2>(row).setZero();
      }
    }
  }
  ChannelShare found() const { return largest_slow_share(problem, difference, left, kSlow); }

  BenchProblem problem;
  Eigen::VectorXd difference, left;
};

TEST_F(SlowPart, IsAllWhereOneAccelerometerHasSeenItSlowly) {
  take([](const Channel& channel, double frequency) { return !channel.is_torque && channel.index == static_cast<int>(kTip) && frequency < kSlow; });
  EXPECT_EQ(found().channel, "tip acceleration");
  EXPECT_DOUBLE_EQ(found().share, 1.0);
}

TEST_F(SlowPart, IsLessWhereTheTorquesHaveSeenItAsWell) {
  take([](const Channel& channel, double frequency) { return (channel.is_torque || channel.index == static_cast<int>(kTip)) && frequency < kSlow; });
  EXPECT_DOUBLE_EQ(found().share, 1.0 / 3.0);  // of two groups and one accelerometer, as many bins each
}

TEST_F(SlowPart, IsNoneOfWhatIsFastOrOfNothing) {
  EXPECT_EQ(found().share, 0.0);
  take([](const Channel& channel, double frequency) { return !channel.is_torque && frequency >= kSlow; });
  EXPECT_EQ(found().share, 0.0);
}

TEST(ChannelOfMost, HasTwiceAsMuchAsAllOthers) {
  const std::vector<BandShare> bands{{"torque of group 1", 0.0, 1.0, 0.5, 9.0}, {"torque of group 2", 0.0, 1.0, 0.2, 4.0}, {"torque of group 1", 1.0, 3.0, 0.2, 5.0}, {"tip acceleration", 0.0, 1.0, 0.1, 2.0}};
  const std::optional<ChannelShare> found = channel_of_most(bands);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->channel, "torque of group 1");
  EXPECT_NEAR(found->share, 0.7, 1e-12);
  EXPECT_FALSE(channel_of_most({{"torque of group 1", 0.0, 1.0, 0.6, 9.0}, {"torque of group 2", 0.0, 1.0, 0.4, 9.0}}));
  EXPECT_FALSE(channel_of_most({}));
}

}  // namespace
}  // namespace slewlab::diagnosis
