#include "diagnosis/hidden_commands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/sensor_noise.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kRow = 0.02;        // [s]
constexpr std::size_t kRows = 2000;

// Rows of one group that stands.
Record rows_of(std::vector<double> torque) {
  Record record;
  record.step = record.encoder_period = kRow;
  record.group_count = 1;
  for (auto* series : {&record.shaft_speed[0], &record.shaft_position[0], &record.position_rate[0]}) series->assign(torque.size(), 0.0);
  for (const double value : torque) {
    msgs::Torque& message = record.torque.emplace_back();
    message.group_count = 1;
    message.motor_torque = {value};
  }
  record.motor_torque[0] = std::move(torque);
  return record;
}

// Six rows tell a polynomial of the fifth degree exactly, and its mean of what is held four times in a row. Near the ends the rows stand still.
TEST(HiddenCommands, LieOnPolynomialsThroughTheRows) {
  const auto course = [](double row) { return 3.0 + row - 0.2 * row * row + 1e-3 * std::pow(row, 3) - 1e-5 * std::pow(row, 5); };
  std::vector<double> torque;
  for (int n = 0; n < 12; ++n) torque.push_back(course(n));
  const Record record = with_commands_between(rows_of(torque), 4);
  EXPECT_EQ(record.recorded_per_point, 4U);
  EXPECT_EQ(command_step(record), kRow / 4.0);
  for (std::size_t n = 2; n < 8; ++n) {
    double mean = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double there = course(static_cast<double>(n) + 0.25 * static_cast<double>(j));
      EXPECT_NEAR(record.recorded_torque[0][4 * n + j], there, 1e-12) << n << " " << j;
      mean += 0.25 * there;
    }
    EXPECT_NEAR(record.motor_torque[0][n], mean, 1e-12);
  }
  EXPECT_EQ(record.recorded_torque[0].front(), torque.front());
  EXPECT_EQ(record.recorded_torque[0][4 * 11], torque.back());
}

// A lead is what the course has gone on by in that time, on the average over a row.
TEST(HiddenCommands, ActAheadByTheirSlope) {
  std::vector<double> torque;
  for (int n = 0; n < 10; ++n) torque.push_back(5.0 * n);
  const MoreTorques ahead = torques_ahead(with_commands_between(rows_of(torque), 4), 0.1 * kRow);
  for (std::size_t n = 0; n + 1 < torque.size(); ++n) EXPECT_NEAR(ahead.of_group[0][n], 0.5, 1e-12);
  EXPECT_EQ(ahead.of_group[0].back(), 0.0);
  EXPECT_FALSE(ahead.is_on_house);
}

// Every second command of a white noise about a slow course is written down. The slow part of what a row is off by, its mean over many rows, has the power that is told: half of the noise's.
TEST(HiddenCommands, TellWhatNobodyKnowsOfThem) {
  constexpr double kDeviation = 0.7;  // [Nm]
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0.0, kDeviation);
  std::vector<double> all, written;
  for (std::size_t n = 0; n < 2 * kRows; ++n) all.push_back(100.0 * std::sin(2e-3 * static_cast<double>(n)) + normal(generator));
  for (std::size_t n = 0; n < all.size(); n += 2) written.push_back(all[n]);
  const Record record = with_commands_between(rows_of(written), 2);
  const double told = record.noise->torque - sensor_noise(rows_of(written)).torque;
  EXPECT_NEAR(told, 0.5 * kDeviation * kDeviation, 0.1 * kDeviation * kDeviation);  // 2000 rows tell a variance to 5 %
  constexpr std::size_t kTogether = 20;
  double square = 0.0;
  for (std::size_t first = 0; first + kTogether < kRows; first += kTogether) {
    double off = 0.0;
    for (std::size_t k = first; k < first + kTogether; ++k) off += 0.5 * (all[2 * k] + all[2 * k + 1]) - record.motor_torque[0][k];
    square += off * off / kTogether / (kRows / kTogether - 1);
  }
  EXPECT_NEAR(square / told, 1.0, 0.4);  // a hundred means
  EXPECT_DOUBLE_EQ(record.torque_noise, 2.0 * told);
}

// Kinks of a ramp and torques that are switched are no noise.
TEST(HiddenCommands, HaveNoNoiseWhereTheRowsHaveNone) {
  std::vector<double> torque;
  for (std::size_t n = 0; n < kRows; ++n) torque.push_back(n < kRows / 2 ? 40.0 : 40.0 + 0.1 * static_cast<double>(n - kRows / 2));
  torque[7] = -40.0;
  EXPECT_NEAR(with_commands_between(rows_of(torque), 4).torque_noise, 0.0, 1e-12);
}

TEST(HiddenCommands, AreNoneWhereTheRecordTellsAll) {
  const std::vector<double> torque{1.0, 3.0, 2.0, 2.0, 5.0, 4.0, 1.0};
  Record sensors_between = rows_of(torque), coarser = rows_of(torque), measured = rows_of(torque);
  sensors_between.encoder_period = 2.0 * kRow;
  coarser.recorded_per_point = 2;
  measured.has_measured_torque = true;
  for (const Record& record : {sensors_between, coarser, measured}) {
    EXPECT_FALSE(can_have_commands_between(record));
    EXPECT_EQ(with_commands_between(record, 4).motor_torque[0], torque);
  }
  EXPECT_TRUE(can_have_commands_between(rows_of(torque)));
  EXPECT_EQ(with_commands_between(rows_of(torque), 1).motor_torque[0], torque);
  const std::vector<double> held{1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0};
  const std::vector<Record> changing{rows_of(torque)}, standing{rows_of(held)};
  EXPECT_TRUE(may_hide_commands(changing, std::nullopt));
  EXPECT_FALSE(may_hide_commands(standing, std::nullopt));
  controller::ControllerSettings controller;
  controller.period = kRow;
  EXPECT_FALSE(may_hide_commands(changing, controller));
  controller.period = 0.5 * kRow;
  EXPECT_TRUE(may_hide_commands(changing, controller));
}

// A recorder that writes down every second command of a PLC of 10 ms. What is missing without the others is none of the catalogue's; with them it is the friction that acts, with its size.
TEST(HiddenCommands, LeaveTheCauseThatActs) {
  sim::MachineSettings truth, nominal;
  truth.crane = nominal.crane = bench().crane;
  truth.effects = {{"bearing_viscous", {5e6, 0.0}}};  // [Nms/rad]
  controller::ControllerSettings controller = bench().controller;
  controller.period = 0.01;
  std::vector<Record> records;
  for (const auto& [moves, seed] : {std::pair(kThereAndBack, 11u), std::pair(kInching, 12u)}) {
    const msgs::RunLog every = simulated_log(truth, controller, moves, kDuration, seed, controller.period);
    msgs::RunLog written;
    for (std::size_t n = 0; n < every.encoder.size(); n += 2) {
      written.encoder.push_back(every.encoder[n]);
      written.torque.push_back(every.torque[n]);
    }
    for (const msgs::Sensors& message : every.sensors) {
      if (message.simulated_time % 20'000'000 == 0) written.sensors.push_back(message);
    }
    records.push_back(make_record(written, "every second row", bench().admission));
  }
  DiagnosisSettings settings;
  for (const common::EffectAbout& about : sim::effects_for(nominal).effects) {
    const std::vector<std::string> kept{"bearing_viscous", "bearing_coulomb", "command_loss", "command_jitter", "dead_time", "encoder_delay", "load_mass"};
    if (std::find(kept.begin(), kept.end(), about.name) == kept.end()) settings.without.emplace_back(about.name);
  }
  const Diagnosis found = diagnose(nominal, std::nullopt, std::move(records), settings);
  EXPECT_EQ(found.commands_per_row, kSomeCommands);
  EXPECT_FALSE(found.is_unknown);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].effects, std::vector<std::string>{"bearing_viscous"}) << found.verdict;
  EXPECT_GT(found.causes[0].probability, 0.8);
  EXPECT_NEAR(found.causes[0].sizes[0].value, 5e6, 0.1 * 5e6);
  EXPECT_LT(found.causes[0].mean_square, kNoiseAlone);
}

}  // namespace
}  // namespace slewlab::diagnosis
