// The checks on made-up runs whose numbers are known in closed form.

#include "tools/acceptance/checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace slewlab::tools {
namespace {

constexpr double kRatio = 100.0;
constexpr double kTopSpeed = 0.05;  // [rad/s]

// The speed [share of top speed] and the halves' torques [share of T100] as functions of time [s].
struct MadeUp {
  std::function<double(double)> speed = [](double) { return 0.0; };
  std::function<double(double)> half_1 = [](double) { return 0.1; };
  std::function<double(double)> half_2 = [](double) { return -0.1; };
  std::vector<std::pair<double, double>> requests;  // [s], share
  double stop = -1.0;                               // [s]
  double trip = -1.0;                               // [s]
  int status_every = 1;                             // PLANT_STATUS with every so many ENCODER
  double duration = 20.0;                           // [s]
};

msgs::RunLog log_of(const MadeUp& run) {
  msgs::RunLog log;
  const auto nanoseconds = [](double time) { return static_cast<std::int64_t>(std::llround(time * 1e9)); };
  double angle = 0.0;
  for (int k = 0; k * 0.01 < run.duration; ++k) {
    const double time = 0.01 * k;
    msgs::Encoder encoder{};
    encoder.sequence = k;
    encoder.simulated_time = nanoseconds(time);
    encoder.group_count = 2;
    const double speed = run.speed(time) * kTopSpeed;
    encoder.shaft_speed = {speed * kRatio, speed * kRatio};
    encoder.shaft_position = {angle * kRatio, angle * kRatio};
    angle += 0.01 * 0.5 * (speed + run.speed(time + 0.01) * kTopSpeed);
    log.encoder.push_back(encoder);
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = k;
    torque.simulated_time = encoder.simulated_time;
    torque.enable = 1;
    torque.group_count = 2;
    torque.motor_torque = {run.half_1(time) * 250.0, run.half_2(time) * 250.0};
    log.torque.push_back(torque);
    if (k % run.status_every != 0) continue;
    msgs::PlantStatus status{};
    status.simulated_time = encoder.simulated_time;
    status.trip_time = -1;
    if (run.trip >= 0.0 && time >= run.trip) {
      status.drive_state = 2;
      status.trip_cause = 13;
      status.trip_time = nanoseconds(run.trip);
    }
    log.plant_status.push_back(status);
  }
  msgs::Operator move{};
  log.operator_moves.push_back(move);
  for (const auto& [time, request] : run.requests) {
    move.sequence++;
    move.simulated_time = nanoseconds(time);
    move.speed_request = request;
    log.operator_moves.push_back(move);
  }
  if (run.stop >= 0.0) {
    move.sequence++;
    move.simulated_time = nanoseconds(run.stop);
    move.emergency_stop = 1;
    log.operator_moves.push_back(move);
  }
  return log;
}

AcceptanceLimits limits() {
  AcceptanceLimits limits = load_acceptance_limits(SLEWLAB_SOURCE_DIR "/config/acceptance/thesis.yaml");
  limits.top_speed = kTopSpeed;
  return limits;
}

CheckResult check(const MadeUp& run, const std::string& name, std::optional<double> first_fault = {}) {
  for (const CheckResult& result : acceptance_checks(log_of(run), limits(), {kRatio, first_fault})) {
    if (result.name == name) return result;
  }
  ADD_FAILURE() << "no check " << name;
  return {};
}

// A ramp of 4 s from 2 s on, and a decaying overshoot of 10 % behind it.
TEST(AcceptanceChecks, OvershootAndSettlingAreMeasured) {
  MadeUp run;
  run.requests = {{2.0, 1.0}};
  run.speed = [](double t) {
    return t < 2.0 ? 0.0 : t < 6.0 ? (t - 2.0) / 4.0 : 1.0 + 0.1 * std::exp(-(t - 6.25)) * std::sin(2 * std::numbers::pi * (t - 6.0));
  };
  const CheckResult overshoot = check(run, "overshoot");
  EXPECT_EQ(overshoot.verdict, Verdict::fail);
  // e^(1/4 - t) sin(2 pi t) is largest at tan(2 pi t) = 2 pi: t = 0.2249, where it is 1.0128.
  EXPECT_NEAR(overshoot.measured, 10.13, 0.02);
  EXPECT_NEAR(overshoot.time, 6.22, 0.011);
  EXPECT_NE(overshoot.reason.find("more than the allowed 3 % of top speed, at 6.22 s"), std::string::npos)
      << overshoot.reason;
  // It leaves the band of 5 % last where 0.1 e^(1/4 - t) |sin(2 pi t)| = 0.05 for the last time: t = 0.826 (by bisection).
  const CheckResult settling = check(run, "settling");
  EXPECT_NEAR(settling.measured, 4.826, 0.011);
  EXPECT_EQ(settling.verdict, Verdict::pass);
}

TEST(AcceptanceChecks, ACraneThatGoesTheWrongWayOrNeverArrivesIsCaught) {
  MadeUp run;
  run.requests = {{2.0, -1.0}};
  run.speed = [](double t) { return t < 2.0 ? 0.0 : 0.2 * (t - 2.0); };
  EXPECT_EQ(check(run, "direction").verdict, Verdict::fail);
  const CheckResult settling = check(run, "settling");
  EXPECT_EQ(settling.verdict, Verdict::fail);
  EXPECT_EQ(settling.reason, "the request at 2.00 s is never settled within 5 % of top speed");
  // A reversal under way still moves the old way, and that is right.
  run.requests = {{0.0, 1.0}, {8.0, -1.0}};
  run.speed = [](double t) { return t < 4.0 ? t / 4.0 : t < 8.0 ? 1.0 : std::max(-1.0, 1.0 - (t - 8.0) / 2.0); };
  EXPECT_EQ(check(run, "direction").verdict, Verdict::pass);
}

TEST(AcceptanceChecks, TheEmergencyStopIsMeasured) {
  MadeUp run;
  run.requests = {{1.0, 1.0}};
  run.stop = 10.0;
  // Linear to zero in 1.5 s, then 8 % past it, decaying.
  run.speed = [](double t) {
    return t < 1.0 ? 0.0 : t < 5.0 ? (t - 1.0) / 4.0 : t < 10.0 ? 1.0 : t < 11.5 ? 1.0 - (t - 10.0) / 1.5
                                                                                  : -0.32 * (t - 11.5) * std::exp(-(t - 11.5) / 0.68);
  };
  // The triangle 0.05 rad/s * 1.5 s / 2 is 2.149 deg.
  EXPECT_NEAR(check(run, "stop distance").measured, 2.149, 0.005);
  EXPECT_EQ(check(run, "stop distance").verdict, Verdict::pass);
  // x e^(-x/T) is largest at x = T, T/e: 0.32 * 0.68 / e = 8.005 %.
  const CheckResult overshoot = check(run, "stop overshoot");
  EXPECT_NEAR(overshoot.measured, 8.005, 0.005);
  EXPECT_EQ(overshoot.verdict, Verdict::fail);
  EXPECT_EQ(check(run, "stop time").verdict, Verdict::pass);
  EXPECT_EQ(check(run, "tip acceleration").verdict, Verdict::not_applicable);  // no SENSORS in this log
}

TEST(AcceptanceChecks, SwappedHalvesAndTooMuchTorqueAreCaught) {
  MadeUp run;
  run.requests = {{1.0, 1.0}};
  EXPECT_EQ(check(run, "play offset").verdict, Verdict::pass);
  EXPECT_NEAR(check(run, "play offset").measured, 10.0, 1e-9);
  EXPECT_EQ(check(run, "torque share").verdict, Verdict::pass);
  std::swap(run.half_1, run.half_2);
  EXPECT_NE(check(run, "play offset").reason.find("the halves are swapped"), std::string::npos);
  run.half_1 = [](double t) { return t < 3.0 ? 0.5 : 0.99; };
  const CheckResult share = check(run, "torque share");
  EXPECT_EQ(share.verdict, Verdict::fail);
  EXPECT_NEAR(share.measured, 99.0, 1e-9);
  EXPECT_NEAR(share.time, 3.0, 1e-9);
}

TEST(AcceptanceChecks, ATripIsAFailureOrTheReactionToAFault) {
  MadeUp run;
  run.requests = {{1.0, 1.0}};
  run.trip = 10.0;
  run.speed = [](double t) { return t < 1.0 ? 0.0 : t < 5.0 ? (t - 1.0) / 4.0 : t < 10.0 ? 1.0 : std::max(0.0, 1.0 - (t - 10.0) / 2.0); };
  EXPECT_EQ(check(run, "trips").verdict, Verdict::fail);
  EXPECT_NE(check(run, "trips").reason.find("at 10.00 s, cause: silence"), std::string::npos) << check(run, "trips").reason;
  // With a fault on purpose the same trip is right, if the crane then stands: 5 % are reached 1.9 s behind it.
  const CheckResult reaction = check(run, "reaction", 9.5);
  EXPECT_EQ(reaction.verdict, Verdict::pass);
  EXPECT_NEAR(reaction.measured, 1.9, 0.011);
  // The same, however seldom the plant tells: the next PLANT_STATUS comes at 12 s.
  run.status_every = 300;
  EXPECT_NEAR(check(run, "reaction", 9.5).measured, 1.9, 0.011);
  EXPECT_EQ(check(run, "reaction", 9.5).verdict, Verdict::pass);
  run.status_every = 1;
  run.speed = [](double t) { return t < 1.0 ? 0.0 : std::min(1.0, (t - 1.0) / 4.0); };
  EXPECT_EQ(check(run, "reaction", 9.5).verdict, Verdict::fail);
}

TEST(AcceptanceChecks, WhatIsNotInTheLogIsNotPassed) {
  MadeUp run;
  run.requests = {{1.0, 1.0}};
  run.stop = 0.005;       // between the first ENCODER and the second, which never comes
  run.duration = 0.009;
  const std::vector<CheckResult> results = acceptance_checks(log_of(run), limits(), {kRatio, {}});
  for (const CheckResult& result : results) {
    EXPECT_TRUE(std::isfinite(result.measured)) << result.name << ": " << result.reason;
    EXPECT_EQ(result.reason.find("inf"), std::string::npos) << result.reason;
  }
  EXPECT_FALSE(accepted({}));
  EXPECT_NE(not_judged(results).find("direction"), std::string::npos) << not_judged(results);
  std::vector<CheckResult> three(3);
  three[0].name = "overshoot", three[0].verdict = Verdict::pass;
  three[1].name = "settling";
  three[2].name = "reaction";
  EXPECT_EQ(not_judged(three), "settling, reaction");
}

TEST(AcceptanceChecks, ARunThatDidNotComeToItsEndGetsNoVerdict) {
  MadeUp run;
  run.requests = {{1.0, 1.0}};
  const auto why = [](const msgs::RunLog& log) {
    msgs::RunLogs logs;
    logs.runs = {log};
    return why_no_verdict(logs, {20'000'000'000, 10'000'000, 1'000'000, 1'000'000'000});
  };
  const msgs::RunLog whole = log_of(run);
  EXPECT_EQ(why(whole), "");
  msgs::RunLog cut = whole;
  cut.encoder.resize(cut.encoder.size() * 2 / 5);
  EXPECT_NE(why(cut).find("ends at 7.990 s of 20.000 s"), std::string::npos) << why(cut);
  msgs::RunLog hole = whole;
  hole.encoder.erase(hole.encoder.begin() + 500, hole.encoder.begin() + 700);
  EXPECT_NE(why(hole).find("hole of 2.010 s behind 4.990 s"), std::string::npos) << why(hole);
  msgs::RunLog late = whole;
  late.encoder.erase(late.encoder.begin(), late.encoder.begin() + 300);
  EXPECT_NE(why(late).find("begins at 3.000 s"), std::string::npos) << why(late);
  EXPECT_NE(why(msgs::RunLog{}).find("never started"), std::string::npos);
  msgs::RunLogs damaged;
  damaged.runs = {whole};
  damaged.lost_bytes = 7;
  EXPECT_NE(why_no_verdict(damaged, {20'000'000'000, 10'000'000, 1'000'000, 1'000'000'000}).find("7 bytes"), std::string::npos);
}

TEST(AcceptanceChecks, JUnitTellsPassFailAndSkipped) {
  MadeUp run;
  run.requests = {{2.0, -1.0}};
  const std::string xml = junit_xml("a <run>", acceptance_checks(log_of(run), limits(), {kRatio, {}}));
  EXPECT_NE(xml.find("<testsuite name=\"a &lt;run&gt;\" tests=\"13\" failures=\"1\" errors=\"0\" skipped=\"7\">"), std::string::npos)
      << xml;
  EXPECT_NE(xml.find("name=\"settling\"><failure message=\"the request at 2.00 s is never settled"), std::string::npos) << xml;
  EXPECT_NE(xml.find("name=\"stop time\"><skipped message=\"no emergency stop in the run\"/>"), std::string::npos) << xml;
}

// Noise of 0.2 rad/s on the encoders from 5 s on, and a torque of -40 N m s/rad times the reading of `lag` cycles before.
CheckResult dead_time_of(int lag, double trip = -1.0) {
  MadeUp made;
  made.trip = trip;
  msgs::RunLog log = log_of(made);
  std::mt19937_64 draw(1);
  std::normal_distribution<double> noise(0.0, 0.2);  // [rad/s]
  for (std::size_t k = 500; k < log.encoder.size(); ++k) {
    for (double& speed : log.encoder[k].shaft_speed) speed += noise(draw);
  }
  for (std::size_t k = 500; k < log.torque.size(); ++k) {
    const std::vector<double>& speed = log.encoder[k - static_cast<std::size_t>(lag)].shaft_speed;
    for (std::size_t i = 0; i < speed.size(); ++i) log.torque[k].motor_torque[i] = -40.0 * speed[i];
  }
  const AcceptedMachine machine{.total_ratio = kRatio, .first_fault = 5.0, .encoder_noise = {{5.0, 18.0}}, .controller_period = 0.01};
  for (const CheckResult& result : acceptance_checks(log, limits(), machine)) {
    if (result.name == "dead time") return result;
  }
  ADD_FAILURE() << "no dead time";
  return {};
}

TEST(AcceptanceChecks, ATorqueOfAnEarlierReadingIsCaught) {
  EXPECT_EQ(dead_time_of(0).verdict, Verdict::pass) << dead_time_of(0).reason;
  const CheckResult late = dead_time_of(1);
  EXPECT_EQ(late.verdict, Verdict::fail);
  EXPECT_NEAR(late.measured, 10.0, 1e-9);  // [ms]
  EXPECT_EQ(dead_time_of(1, 5.0).verdict, Verdict::not_applicable);  // tripped when the noise begins
  EXPECT_EQ(check({}, "dead time").reason, "the scenario puts no noise on the encoders");
}

}  // namespace
}  // namespace slewlab::tools
