// A run is recorded in this process - the crane, the controller and the lockstep loop between them, on a bus in memory -
// and replayed. What must come out: the same bits, or exactly what was changed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "controller/controller_file.h"
#include "controller/process/computed_answer.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/codec.h"
#include "msgs/configuration_hash.h"
#include "msgs/memory_bus.h"
#include "msgs/run_identity.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_run.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/replay/stream_of.h"
#include "tools/replay/comparison.h"
#include "tools/replay/controller_replay.h"
#include "tools/replay/plant_replay.h"
#include "tools/commands/replay_command.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SLEWLAB_SOURCE_DIR) / "config";

// 3 s in which the crane starts, is stopped in an emergency, and the gears are under tension all along.
const std::vector<common::Override> kShortRun{
    {"duration", "3"}, {"operator.0.time", "0.5"}, {"operator.1.time", "2"}};

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() {
    for (const char* name : {"crane", "controller"}) {
      fs::copy_file(kConfig / (std::string(name) + "s") / "thesis.yaml", folder_.path() / (std::string(name) + ".yaml"));
    }
    scenario_ = sim::load_scenario_file(kConfig / "scenarios/thesis_slew.yaml", kShortRun);
    controller_ = controller::load_controller_file(kConfig / "controllers/thesis.yaml").settings;
    controller_.period = 0.01;
  }

  // Records the run into `log`.
  void record(const fs::path& log, std::int64_t configuration) {
    sim::LockstepSettings settings;
    settings.duration = scenario_.duration;
    settings.sensors_period = scenario_.sensors_period;
    settings.operator_moves = scenario_.moves;
    settings.status_period = scenario_.status_period;
    settings.configuration_hash = configuration;
    settings.run_identity = msgs::run_identity(configuration);
    sim::DriveRun drive = sim::drive_run(scenario_);
    drive.configuration_hash = configuration;
    drive.run_identity = settings.run_identity;
    sim::CranePlant plant(sim::machine_settings(scenario_), drive);
    msgs::LogWriter writer(log);
    diagnosis::run_wire_loop(settings, controller_, plant, writer);
    writer.finish();
  }
  msgs::RunLog recorded() {
    const fs::path log = folder_.path() / "run.lcmlog";
    record(log, 7);
    return msgs::read_run_logs(log).runs.at(0);
  }
  struct Answers {
    ChannelComparison torque, controller_state;
  };
  Answers ask(const msgs::RunLog& log, const controller::ControllerSettings& settings) {
    const msgs::RunStream run = stream_of(log);
    RunningComparison<msgs::Torque> torque(run);
    RunningComparison<msgs::ControllerState> state(run);
    const Questions questions = recorded_questions(run);
    const Questions::Next next = questions.open();
    for (const Question* question = next(); question != nullptr;) {
      msgs::MemoryWire wire;
      const auto asking = wire.connect();
      const auto answering = wire.connect();
      const controller::AnswerLoop loop(*answering, controller::computed_answer(settings));
      asking->on_wait = [&] { answering->drain(); };
      EXPECT_TRUE(ask_controller(*asking, run, question, next, {},
                                 {[&](const msgs::Torque& message) { torque.add(message); },
                                  [&](const msgs::ControllerState& message) { state.add(message); }}));
    }
    return {torque.finish(), state.finish()};
  }
  struct Motion {
    std::vector<std::string> remarks;
    std::int64_t said = 0;  // ENCODER
    ChannelComparison encoder, sensors, truth;
  };
  Motion move(const msgs::RunLog& log) {
    const msgs::RunStream run = stream_of(log);
    RunningComparison<msgs::Encoder> encoder(run);
    RunningComparison<msgs::Sensors> sensors(run);
    RunningComparison<msgs::Truth> truth(run);
    Motion motion;
    motion.remarks = replay_plant(scenario_, run, arrivals_by_answer(run),
                                  {[&](const msgs::Encoder& message) {
                                     ++motion.said;
                                     encoder.add(message);
                                   },
                                   [&](const msgs::Sensors& message) { sensors.add(message); },
                                   [&](const msgs::Truth& message) { truth.add(message); }, [](const msgs::PlantStatus&) {}});
    motion.encoder = encoder.finish();
    motion.sensors = sensors.finish();
    motion.truth = truth.finish();
    return motion;
  }
  // Apart by starts of the controller.
  static std::vector<std::vector<Question>> starts_of(const Questions& questions) {
    std::vector<std::vector<Question>> starts;
    const Questions::Next next = questions.open();
    for (const Question* question = next(); question != nullptr; question = next()) {
      if (question->is_first) starts.emplace_back();
      starts.back().push_back(*question);
    }
    EXPECT_EQ(static_cast<std::int64_t>(starts.size()), questions.starts);
    return starts;
  }
  int replay_it(const ReplayOptions& options) {
    out_.str("");
    err_.str("");
    return replay(options, {}, out_, err_);
  }
  // A scenario beside the log, as slewlab run leaves it.
  std::int64_t write_scenario() {
    std::ostringstream text;
    text << "include: " << (kConfig / "scenarios/thesis_slew.yaml").string() << "\ncrane: crane.yaml\n"
         << "controller: controller.yaml\nduration: {value: 3, unit: s, source: \"test\"}\n";
    const fs::path file = folder_.path() / "scenario.yaml";
    std::FILE* out = std::fopen(file.c_str(), "w");
    std::fputs(text.str().c_str(), out);
    std::fclose(out);
    return msgs::configuration_hash(sim::load_scenario_file(file).configuration_text);
  }

  TemporaryFolder folder_;
  sim::Scenario scenario_;
  controller::ControllerSettings controller_;
  std::ostringstream out_, err_;
};

TEST_F(ReplayTest, ALockstepLogIsIdenticalToTheBitOnBothSides) {
  const msgs::RunLog run = recorded();
  ASSERT_EQ(run.encoder.size(), 300u);
  ASSERT_EQ(run.sensors.size(), 601u);
  const Motion plant = move(run);
  EXPECT_TRUE(plant.remarks.empty());
  const std::vector<ChannelComparison> motions{plant.encoder, plant.sensors, plant.truth};
  EXPECT_TRUE(identical(motions));
  EXPECT_EQ(motions[0].compared, 300);
  EXPECT_EQ(motions[1].compared, 601);
  EXPECT_EQ(first_difference(motions), nullptr);
  const Answers answers = ask(run, controller_);
  const std::vector<ChannelComparison> torques{answers.torque, answers.controller_state};
  EXPECT_TRUE(identical(torques));
  EXPECT_EQ(torques[0].compared, 300);
  EXPECT_EQ(torques[1].compared, 300);
}

// One bit of one torque: the controller's half finds it where it is, the plant's half from the next ENCODER on.
TEST_F(ReplayTest, OneChangedBitIsFoundWhereItIs) {
  msgs::RunLog run = recorded();
  double& torque = run.torque[150].motor_torque[1];
  const double before = torque;
  torque = std::nextafter(torque, std::numeric_limits<double>::infinity());
  const std::vector<ChannelComparison> torques{ask(run, controller_).torque};
  EXPECT_EQ(torques[0].differing, 1);
  const FieldDifference* first = first_difference(torques);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->channel, "TORQUE");
  EXPECT_EQ(first->field, "motor_torque[1]");
  EXPECT_EQ(first->unit, "Nm");
  EXPECT_EQ(first->first_time, 1'500'000'000);
  EXPECT_EQ(first->largest, torque - before);

  run.torque[150].motor_torque[1] = before + 1.0;  // 1 Nm, so that it shows through rounding
  const ChannelComparison encoders = move(run).encoder;
  ASSERT_FALSE(encoders.differences.empty());
  EXPECT_EQ(encoders.differences.front().first_time, 1'510'000'000);
}

TEST_F(ReplayTest, AnotherGainShowsWithTimeFieldAndSize) {
  const msgs::RunLog run = recorded();
  controller::ControllerSettings changed = controller_;
  changed.ramp.emergency_stop_time *= 2.0;
  const Answers answers = ask(run, changed);
  const std::vector<ChannelComparison> channels{answers.torque, answers.controller_state};
  // Until the emergency stop at 2 s the two are the same; the ramp leaves one period behind it.
  const FieldDifference* first = first_difference(channels);
  ASSERT_NE(first, nullptr);
  EXPECT_GE(first->first_time, 2'000'000'000);
  EXPECT_LE(first->first_time, 2'010'000'000);
  std::ostringstream table;
  print(table, channels);
  EXPECT_NE(table.str().find("first difference: at 2.0"), std::string::npos) << table.str();
  EXPECT_NE(table.str().find("CONTROLLER_STATE.ramped_speed [rad/s]"), std::string::npos) << table.str();
}

TEST_F(ReplayTest, MissingMessagesAreBridgedAndTold) {
  msgs::RunLog run = recorded();
  run.torque.erase(run.torque.begin() + 20);              // lost on its way to the logger
  run.controller_state.erase(run.controller_state.begin() + 20);
  run.encoder.erase(run.encoder.begin() + 40);
  const Questions questions = recorded_questions(stream_of(run));
  const auto starts = starts_of(questions);
  ASSERT_EQ(starts.size(), 1u);
  EXPECT_EQ(starts[0].size(), 300u);                      // the alive counter says that both were computed
  EXPECT_TRUE(starts[0][40].made_up);
  ASSERT_EQ(questions.remarks.size(), 1u);
  EXPECT_NE(questions.remarks[0].find("1 ENCODER that were answered are missing"), std::string::npos);
  const ChannelComparison torques = ask(run, controller_).torque;
  EXPECT_EQ(torques.compared, 298);
  // Before the gap nothing differs, behind it only by what a straight line between two ENCODER is off.
  for (const FieldDifference& difference : torques.differences) {
    EXPECT_GT(difference.first_time, 400'000'000);
    EXPECT_LT(difference.largest, 0.5) << difference.field;
  }
  const Motion plant = move(run);
  ASSERT_EQ(plant.remarks.size(), 1u);
  EXPECT_NE(plant.remarks[0].find("1 TORQUE that were sent are missing in the record, the first answers ENCODER 20"),
            std::string::npos)
      << plant.remarks[0];
  // A torque on a line between its neighbours is off by little, and the crane follows the record closely.
  for (const FieldDifference& difference : plant.encoder.differences) {
    if (difference.field.starts_with("shaft_speed")) {
      EXPECT_LT(difference.largest, 0.1) << difference.field;
    }
  }
}

TEST_F(ReplayTest, AControllerThatWasTooSlowOrStartedAnewIsReplayedLikeThat) {
  msgs::RunLog run = recorded();
  // ENCODER 50 was never answered: the alive counter goes on by one from 49 to 51.
  run.torque.erase(run.torque.begin() + 50);
  for (auto it = run.torque.begin() + 50; it != run.torque.end(); ++it) --it->alive_counter;
  // From ENCODER 101 on another process answered.
  for (msgs::Torque& torque : run.torque) {
    if (torque.answered_sequence > 100) torque.alive_counter = torque.sequence = torque.answered_sequence - 101;
  }
  const Questions questions = recorded_questions(stream_of(run));
  const auto starts = starts_of(questions);
  ASSERT_EQ(starts.size(), 2u);
  EXPECT_EQ(starts[0].size(), 100u);
  EXPECT_EQ(starts[1].size(), 199u);
  EXPECT_EQ(starts[1].front().encoder.sequence, 101);
  EXPECT_EQ(questions.remarks.size(), 2u);
}

TEST_F(ReplayTest, TheCommandReadsWhatLiesBesideTheLog) {
  record(folder_.path() / "run.lcmlog", write_scenario());
  ReplayOptions options;
  options.log = folder_.path();
  EXPECT_EQ(replay_it(options), 0) << err_.str() << out_.str();
  EXPECT_NE(out_.str().find("SENSORS               601 compared, all identical to the bit"), std::string::npos)
      << out_.str();
  options.overrides = {{"controller.speed_control.proportional_gain", "41"}};
  EXPECT_EQ(replay_it(options), 1);
  EXPECT_NE(out_.str().find("TORQUE.motor_torque[0] [Nm]"), std::string::npos) << out_.str();
}

// Cut between two events, and without a channel: nothing differs in what is there.
TEST_F(ReplayTest, ALogOfAPartOfItsRunSaysUpToWhenAndOfWhatItWasCompared) {
  record(folder_.path() / "whole.lcmlog", write_scenario());
  const fs::path log = folder_.path() / "run.lcmlog";
  const auto keep = [&](std::int64_t until_us, std::string_view without) {
    msgs::LogWriter writer(log);
    msgs::LogReader reader(folder_.path() / "whole.lcmlog");
    msgs::LogEvent event;
    while (reader.next(event)) {
      if (event.timestamp_us <= until_us && event.channel != without) writer.append(event.channel, event.timestamp_us, event.data);
    }
    writer.finish();
  };
  ReplayOptions options;
  options.log = log;
  keep(1'000'000, "");
  EXPECT_EQ(replay_it(options), 1);
  EXPECT_NE(out_.str().find("    identical to the bit from 0.000 s to 1.000 s\n"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("not the whole run: the log ends at 1.000 s of the scenario's 3.000 s; what is missing was not compared\n"), std::string::npos) << out_.str();
  // A run that was ended there, as at a desk.
  std::ofstream(folder_.path() / "summary.json") << R"({"outcome": "complete", "run": {"configuration_hash": "0000000000000001", "log_digest": ")"
                                                  << msgs::hash_text(msgs::log_digest(log)) << "\"}}";
  EXPECT_EQ(replay_it(options), 0) << out_.str();
  fs::remove(folder_.path() / "summary.json");

  keep(4'000'000, msgs::kTruthChannel);  // the last plant step ends at 3 s
  EXPECT_EQ(replay_it(options), 0) << out_.str();
  EXPECT_NE(out_.str().find("    identical to the bit from 0.000 s to 3.000 s; of TRUTH nothing was compared\n"), std::string::npos) << out_.str();

  // SENSORS is logged up to 2 s: of the 601 until 3 s, one every 5 ms, 200 are missing.
  msgs::LogWriter writer(log);
  msgs::LogReader reader(folder_.path() / "whole.lcmlog");
  msgs::LogEvent event;
  while (reader.next(event)) {
    if (event.channel != msgs::kSensorsChannel || event.timestamp_us <= 2'000'000) writer.append(event.channel, event.timestamp_us, event.data);
  }
  writer.finish();
  EXPECT_EQ(replay_it(options), 0) << out_.str();
  EXPECT_NE(out_.str().find("; of SENSORS 200 messages are missing, the last compared is that of 2.000 s\n"), std::string::npos) << out_.str();
}

// As lcm-logger leaves a wall-clock run: stamps out of order, holes, other channels, two runs of which one has another
// configuration, and an end that is cut off.
TEST_F(ReplayTest, ADamagedLogIsReplayedAsFarAsItGoesAndSaysWhatItCouldNotUse) {
  const std::int64_t configuration = write_scenario();
  const fs::path first = folder_.path() / "first.lcmlog";
  const fs::path second = folder_.path() / "second.lcmlog";
  record(first, 99);
  record(second, configuration);
  const fs::path log = folder_.path() / "run.lcmlog";
  {
    msgs::LogWriter writer(log);
    std::int64_t count = 0;
    for (const fs::path& part : {first, second}) {
      msgs::LogReader reader(part);
      msgs::LogEvent event;
      while (reader.next(event)) {
        if (++count % 97 == 0 && event.channel == msgs::kSensorsChannel) continue;  // lost
        writer.append(event.channel, 1'700'000'000'000'000 + 10 * count - (count % 5 == 0 ? 25 : 0), event.data);
      }
      writer.append("CAMERA", 1'700'000'000'000'000, std::vector<std::uint8_t>{1, 2, 3});
    }
    writer.finish();
  }
  // Beyond the last event, CAMERA, into the one before.
  fs::resize_file(log, fs::file_size(log) - 100);
  ReplayOptions options;
  options.log = log;
  EXPECT_EQ(replay_it(options), 1) << err_.str() << out_.str();  // the same as far as it goes, and not the whole run
  for (const char* said : {"not the whole run: ", " bytes of the log are no whole event", "run 1 of 2", "not replayed: it was recorded with another configuration", "run 2 of 2",
                           "identical to the bit", "CAMERA", "earlier time stamp", "the end is cut off",
                           "messages are missing"}) {
    EXPECT_NE(out_.str().find(said), std::string::npos) << said << " is not in\n" << out_.str();
  }
}

// A number that speaks of a far future is not simulated until then, and nobody is asked until then.
TEST_F(ReplayTest, AFarFutureIsRefusedInWords) {
  const auto mentions = [](const std::vector<std::string>& remarks, const char* words) {
    return std::any_of(remarks.begin(), remarks.end(), [&](const std::string& remark) { return remark.find(words) != std::string::npos; });
  };
  msgs::RunLog run = recorded();
  run.encoder.back().sequence = run.torque.back().answered_sequence = run.torque.back().alive_counter = std::int64_t{1} << 50;
  const Motion plant = move(run);
  EXPECT_EQ(plant.said, 0);
  EXPECT_TRUE(mentions(plant.remarks, "a number in it must be damaged; not replayed"));
  EXPECT_TRUE(mentions(plant.remarks, "too many to be put in"));
  const Questions questions = recorded_questions(stream_of(run));
  EXPECT_TRUE(starts_of(questions).empty());
  EXPECT_TRUE(mentions(questions.remarks, "nothing is asked"));
  run.encoder.front().sequence = -(std::int64_t{1} << 50);
  EXPECT_EQ(move(run).said, 0);
}

TEST_F(ReplayTest, WhatCannotBeAnsweredIsRefused) {
  ReplayOptions options;
  record(folder_.path() / "alone.lcmlog", 7);
  options.log = folder_.path() / "alone.lcmlog";
  EXPECT_EQ(replay_it(options), 2);
  EXPECT_NE(err_.str().find("there is no scenario.yaml beside"), std::string::npos) << err_.str();
  options.crane = folder_.path() / "crane.yaml";  // enough for one half, with the log's own periods
  EXPECT_EQ(replay_it(options), 0) << err_.str();
  EXPECT_NE(out_.str().find("controller: not replayed"), std::string::npos);
  options.run = 2;
  EXPECT_EQ(replay_it(options), 2);
  EXPECT_NE(err_.str().find("the log holds 1 runs"), std::string::npos) << err_.str();
}

}  // namespace
}  // namespace slewlab::tools
