#include "diagnosis/where.h"

#include <gtest/gtest.h>

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
  SlowShare found() const { return largest_slow_share(problem, difference, left, kSlow); }

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

}  // namespace
}  // namespace slewlab::diagnosis
