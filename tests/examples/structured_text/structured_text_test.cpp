// The host of programs in Structured Text with the example of examples/structured_text; how it answers in the loop is
// example_controllers_test's affair.
#include "controller/structured_text/st_answer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "tests/tools/running_program.h"

namespace slewlab::controller {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;  // [ns] of the example's task
const std::string kHost = SLEWLAB_BINARY_DIR "/bin/slewlab-st-host";
const std::string kLibrary = SLEWLAB_BINARY_DIR "/tests/slewing_controller.so";
const std::string kStrucppLibrary = SLEWLAB_BINARY_DIR "/tests/slewing_controller_strucpp.so";

// By each adapter.
class StructuredTextTest : public testing::TestWithParam<std::string> {
 protected:
  // A crane that stands; `cycle` counts from 0.
  const msgs::Torque& answer(std::int64_t cycle, double speed = 0.0, bool acknowledge = false) {
    msgs::Encoder encoder{};
    encoder.sequence = cycle;
    encoder.simulated_time = cycle * kPeriod;
    encoder.group_count = 2;
    encoder.shaft_speed = {speed, speed};
    encoder.shaft_position = {0.0, 0.0};
    msgs::Operator operator_move{};
    operator_move.acknowledge = acknowledge;
    begin_answer(encoder, cycle, torque_, state_);
    compute_(encoder, operator_move, torque_, state_);
    return torque_;
  }
  std::shared_ptr<const StProgram> program_ = std::make_shared<const StProgram>(GetParam());
  Compute compute_ = st_answer(program_, kPeriod);
  msgs::Torque torque_{};
  msgs::ControllerState state_{};
};

// The TON of 50 ms runs on the time of the ENCODER, whatever a clock on the wall says: five readings are held, the sixth is not.
TEST_P(StructuredTextTest, TimersRunOnSimulatedTime) {
  constexpr double kImpossible = 100.0;  // [rad/s] from one reading to the next
  for (int cycle = 0; cycle < 10; ++cycle) EXPECT_TRUE(answer(cycle).enable);
  for (int cycle = 10; cycle < 15; ++cycle) EXPECT_TRUE(answer(cycle, kImpossible).enable) << cycle;
  EXPECT_FALSE(answer(15, kImpossible).enable);
  EXPECT_TRUE(torque_.brake);
  EXPECT_EQ(state_.mode, 3);
  // Plausible again for as long, and acknowledged: the first such cycle is the sixth.
  for (int cycle = 16; cycle < 21; ++cycle) EXPECT_FALSE(answer(cycle + 1000, 0.0, true).enable) << cycle;
}

TEST_P(StructuredTextTest, NoSignalIsLetGoOfAtOnceAndAcknowledged) {
  EXPECT_TRUE(answer(0).enable);
  EXPECT_FALSE(answer(1, std::numeric_limits<double>::quiet_NaN()).enable);
  EXPECT_EQ(torque_.motor_torque, (std::vector<double>{0.0, 0.0}));
  for (int cycle = 2; cycle < 7; ++cycle) EXPECT_FALSE(answer(cycle, 0.0, true).enable) << cycle;
  EXPECT_TRUE(answer(7, 0.0, true).enable);
  EXPECT_TRUE(answer(8).enable);
}

TEST_P(StructuredTextTest, ARunBeginsAsAtPowerUp) {
  const std::vector<double> first = answer(0, 1.0).motor_torque;
  for (int cycle = 1; cycle < 20; ++cycle) answer(cycle, 1.0);
  EXPECT_NE(torque_.motor_torque, first);
  compute_ = st_answer(program_, kPeriod);
  EXPECT_EQ(answer(0, 1.0).motor_torque, first);
}

INSTANTIATE_TEST_SUITE_P(, StructuredTextTest, testing::Values(kLibrary, kStrucppLibrary),
                         [](const auto& each) { return each.param == kLibrary ? "Matiec" : "Strucpp"; });

// Moved by the same readings, the two adapters command the same to the bit.
TEST(StructuredTextAdapters, AnswerTheSame) {
  Compute one = st_answer(std::make_shared<const StProgram>(kLibrary), kPeriod);
  Compute other = st_answer(std::make_shared<const StProgram>(kStrucppLibrary), kPeriod);
  msgs::Operator operator_move{};
  operator_move.speed_request = 1.0;
  for (std::int64_t cycle = 0; cycle < 500; ++cycle) {
    msgs::Encoder encoder{};
    encoder.sequence = cycle;
    encoder.simulated_time = cycle * kPeriod;
    encoder.group_count = 2;
    encoder.shaft_speed = {0.1 * static_cast<double>(cycle), 0.1 * static_cast<double>(cycle)};
    encoder.shaft_position = {5e-4 * static_cast<double>(cycle * cycle), 5e-4 * static_cast<double>(cycle * cycle)};
    msgs::Torque torque{}, other_torque{};
    msgs::ControllerState state{}, other_state{};
    one(encoder, operator_move, torque, state);
    other(encoder, operator_move, other_torque, other_state);
    ASSERT_EQ(torque.motor_torque, other_torque.motor_torque) << cycle;
    ASSERT_EQ(state.mode, other_state.mode) << cycle;
    ASSERT_EQ(state.integral_torque, other_state.integral_torque) << cycle;
    ASSERT_TRUE(torque.enable) << cycle;
  }
}

std::string refusal(const std::string& library, const std::string& period_ms) {
  RunningProgram host({kHost, library, "--bus", "udpm://239.255.76.67:7667?ttl=0", "--period-ms", period_ms});
  EXPECT_EQ(host.wait_for_end(), 2);
  return host.complaints();
}

TEST(StructuredTextHost, RefusesInWords) {
  EXPECT_NE(refusal(kLibrary, "20").find("its task has an interval of 10 ms, the run asks every 20 ms"), std::string::npos);
  EXPECT_NE(refusal(kStrucppLibrary, "5").find("its task has an interval of 10 ms, the run asks every 5 ms"), std::string::npos);
  EXPECT_NE(refusal("/nowhere.so", "10").find("/nowhere.so: cannot open shared object file"), std::string::npos);
  EXPECT_NE(refusal("/proc/self/exe", "10").find("slewlab-st-host: "), std::string::npos);
}

}  // namespace
}  // namespace slewlab::controller
