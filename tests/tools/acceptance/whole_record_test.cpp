// A record that nothing vouches for has to hold every message that its scenario promises, with numbers in them.

#include "tools/acceptance/whole_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slewlab::tools {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;  // [ns] of the controller and of all telemetry
constexpr int kCycles = 100;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

sim::Scenario scenario() {
  sim::Scenario scenario;
  scenario.duration = kCycles * kPeriod;
  scenario.controller_period = scenario.sensors_period = scenario.truth_period = kPeriod;
  scenario.status_period = 10 * kPeriod;
  return scenario;
}

msgs::RunLog whole() {
  msgs::RunLog run;
  for (int k = 0; k <= kCycles; ++k) {
    msgs::Sensors sensors{};
    sensors.simulated_time = k * kPeriod;
    sensors.tip_acceleration = kNotANumber;  // not fitted
    run.sensors.push_back(sensors);
    msgs::Truth truth{};
    truth.simulated_time = k * kPeriod;
    truth.shear_force = {1.0, 2.0};
    run.truth.push_back(truth);
    if (k % 10 == 0) {
      msgs::PlantStatus status{};
      status.simulated_time = k * kPeriod;
      status.trip_time = -1;
      run.plant_status.push_back(status);
    }
    if (k == kCycles) break;
    msgs::Encoder encoder{};
    encoder.sequence = k;
    encoder.simulated_time = k * kPeriod;
    encoder.shaft_speed = encoder.shaft_position = {0.0, 0.0};
    run.encoder.push_back(encoder);
    msgs::Torque torque{};
    torque.answered_sequence = k;
    torque.simulated_time = k * kPeriod;
    torque.motor_torque = {1.0, -1.0};
    run.torque.push_back(torque);
  }
  return run;
}

std::string why(const msgs::RunLog& run, const sim::Scenario& of = scenario(), bool of_own_plant = false) { return why_not_whole(run, of, of_own_plant); }

void expect_told(const std::string& why, const std::string& words) { EXPECT_NE(why.find(words), std::string::npos) << why; }

TEST(WholeRecord, OneWithEveryMessageIsWhole) { EXPECT_EQ(why(whole()), ""); }

TEST(WholeRecord, AChannelThatIsMissingIsTold) {
  msgs::RunLog run = whole();
  run.sensors.clear();
  expect_told(why(run), "there is no SENSORS in the log, expected one every 0.01 s");
  EXPECT_EQ(why(run, scenario(), true), "");
  run = whole();
  run.truth.clear();
  expect_told(why(run), "there is no TRUTH");
  run = whole();
  run.plant_status.clear();
  expect_told(why(run), "there is no PLANT_STATUS in the log, expected one every 0.1 s");
  run = whole();
  run.encoder.clear();
  expect_told(why(run, scenario(), true), "there is no ENCODER");
}

TEST(WholeRecord, AMessageThatIsMissingIsTold) {
  msgs::RunLog run = whole();
  run.sensors.erase(run.sensors.begin() + 40);
  expect_told(why(run, scenario(), true), "SENSORS of 0.400 s is missing in the log, expected one every 0.01 s up to 1.000 s");
  run = whole();
  run.truth.resize(50);
  expect_told(why(run), "TRUTH of 0.500 s is missing");
  run = whole();
  run.plant_status.erase(run.plant_status.begin());
  expect_told(why(run), "PLANT_STATUS of 0.000 s is missing");
  run = whole();
  run.encoder.pop_back();
  run.torque.pop_back();
  expect_told(why(run), "ENCODER of 0.990 s is missing");
}

TEST(WholeRecord, AnEncoderWithoutItsAnswerIsTold) {
  msgs::RunLog run = whole();
  run.torque.resize(50);
  expect_told(why(run), "there is no TORQUE that answers the ENCODER of 0.500 s");
  sim::Scenario killed = scenario();
  killed.faults.resize(1);
  killed.faults[0].from = 50 * kPeriod;
  EXPECT_EQ(why(run, killed), "");
  run.torque.resize(49);
  expect_told(why(run, killed), "the ENCODER of 0.490 s");
}

TEST(WholeRecord, ANumberThatIsNotFiniteIsTold) {
  msgs::RunLog run = whole();
  run.sensors[30].house_acceleration = INFINITY;
  expect_told(why(run), "house_acceleration of SENSORS is inf at 0.300 s, expected a finite number");
  run = whole();
  run.truth[20].shear_force[1] = kNotANumber;
  expect_told(why(run), "shear_force of TRUTH is nan at 0.200 s");
  run = whole();
  run.encoder[70].shaft_speed[1] = kNotANumber;
  expect_told(why(run), "shaft_speed of ENCODER is nan at 0.700 s");
  run = whole();
  run.torque[70].motor_torque[0] = -INFINITY;
  expect_told(why(run), "motor_torque of TORQUE is -inf at 0.700 s");
  for (msgs::PlantStatus& status : run.plant_status) status.trip_time = status.simulated_time > 700'000'000 ? 700'000'000 : -1;  // the drive refused it
  EXPECT_EQ(why(run), "");
}

}  // namespace
}  // namespace slewlab::tools
