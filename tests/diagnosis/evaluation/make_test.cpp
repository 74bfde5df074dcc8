// A small set is made, sealed, interrupted and taken up again.
#include "diagnosis/evaluation/make.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common/yaml_file.h"
#include "controller/controller_file.h"
#include "diagnosis/evaluation/score.h"
#include "diagnosis/evaluation/seal.h"
#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "sim/machine/machine_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis::withheld {
namespace {

namespace fs = std::filesystem;

class MakeTest : public testing::Test {
 protected:
  static MakeSettings settings(const fs::path& directory) {
    const std::string config = std::string(SLEWLAB_SOURCE_DIR) + "/config/";
    return {.cases = 2, .seed = 11, .purpose = Purpose::kTune, .directory = directory,
            .crane = config + "cranes/thesis.yaml", .controller = config + "controllers/thesis.yaml",
            .controller_period = 1e-3, .threads = 2};
  }
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    set_ = folder_->path() / "set";
    ASSERT_TRUE(make_cases(settings(set_)));
  }
  static void TearDownTestSuite() { delete folder_; }

  static TemporaryFolder* folder_;
  static fs::path set_;
};
TemporaryFolder* MakeTest::folder_ = nullptr;
fs::path MakeTest::set_;

TEST_F(MakeTest, LogsHoldTheFourChannelsAndNothingMore) {
  for (const char* name : {"a.lcmlog", "b.lcmlog", "unseen.lcmlog"}) {
    std::set<std::string> channels;
    msgs::LogReader reader(set_ / "case_0001" / name);
    msgs::LogEvent event;
    while (reader.next(event)) channels.insert(std::string(event.channel));
    EXPECT_EQ(channels, (std::set<std::string>{"ENCODER", "TORQUE", "OPERATOR", "SENSORS"})) << name;
  }
  const msgs::RunLogs logs = msgs::read_run_logs(set_ / "case_0001" / "a.lcmlog");
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_TRUE(logs.remarks.empty());
  EXPECT_EQ(logs.runs[0].encoder.size(), 30'001u);  // 30 s at 1 kHz, both ends
  EXPECT_EQ(logs.runs[0].torque.size(), 30'001u);
  EXPECT_EQ(logs.runs[0].sensors.size(), 30'001u);
}

// A crane whose file includes others is whole in the set, where those are not.
TEST_F(MakeTest, ACraneThatIncludesOthersStandsAloneInItsSet) {
  const TemporaryFolder folder;
  MakeSettings of_another = settings(folder.path() / "set");
  of_another.cases = 1;
  of_another.crane = std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/knuckle.yaml";
  ASSERT_TRUE(make_cases(of_another));
  const std::string copy = read_whole(of_another.directory / "crane.yaml");
  EXPECT_EQ(copy.find("include:"), std::string::npos);
  const auto text_of = [](const fs::path& file) {
    common::InputProblems problems;
    return common::canonical_text(common::load_yaml_file(file, {}, problems));
  };
  EXPECT_EQ(text_of(of_another.directory / "crane.yaml"), text_of(of_another.crane));
}

// The truth machines have booms that bend: a set of a crane whose boom does not would be one of other machines.
TEST_F(MakeTest, RefusesACraneWhoseBoomDoesNotBend) {
  const TemporaryFolder folder;
  for (const auto& [file, said] : {std::pair("rigid_boom.yaml", "it has a rigid boom"), std::pair("no_boom.yaml", "it has no boom")}) {
    MakeSettings of_another = settings(folder.path() / "set");
    of_another.crane = std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/" + file;
    try {
      make_cases(of_another);
      FAIL() << file;
    } catch (const std::invalid_argument& problem) {
      EXPECT_NE(std::string(problem.what()).find(said), std::string::npos) << problem.what();
    }
    EXPECT_FALSE(fs::exists(of_another.directory));
  }
}

TEST_F(MakeTest, CaseFoldersSayNothingAboutTheAnswer) {
  for (const auto& entry : fs::directory_iterator(set_ / "case_0001")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "a.lcmlog" || name == "b.lcmlog" || name == "unseen.lcmlog" || name == "given.json") << name;
  }
}

TEST_F(MakeTest, AnswersOpenOnlyUnderTheirDigest) {
  EXPECT_EQ(open_answers(set_).size(), 2u);
  const fs::path file = set_ / "sealed" / "answers.json";
  const std::string sealed = read_whole(file);
  std::string changed = sealed;
  changed.back() = ' ';
  write_whole(file, changed);
  EXPECT_THROW(open_answers(set_), std::runtime_error);
  write_whole(file, sealed);
  EXPECT_NO_THROW(open_answers(set_));
}

// What an older version sealed lacks what this one scores: said with case, key and what to do.
TEST_F(MakeTest, AnswersOfAnotherVersionAreNamed) {
  const fs::path file = set_ / "sealed" / "answers.json", digest_file = set_ / "digest.txt";
  const std::string sealed = read_whole(file), digest = read_whole(digest_file);
  nlohmann::json older = nlohmann::json::parse(sealed);
  older.at("cases").at(1).erase("visibility");
  write_whole(file, older.dump());
  write_whole(digest_file, sha256(older.dump()));
  try {
    open_answers(set_);
    ADD_FAILURE() << "opened";
  } catch (const std::runtime_error& problem) {
    const std::string said = problem.what();
    for (const char* part : {"answers.json", "case_0002", "visibility", "Make the set again"}) {
      EXPECT_NE(said.find(part), std::string::npos) << part << " in: " << said;
    }
  }
  write_whole(file, sealed);
  write_whole(digest_file, digest);
  EXPECT_NO_THROW(open_answers(set_));
}

TEST_F(MakeTest, ASecondCallMakesOnlyWhatIsMissingAndTheSameBits) {
  const fs::path log = set_ / "case_0002" / "b.lcmlog";
  const std::string before = sha256(read_whole(log)), digest = read_whole(set_ / "digest.txt");
  fs::remove(log);
  std::vector<std::string> lines;
  ASSERT_TRUE(make_cases(settings(set_), [&](int, int, const std::string& line) { lines.push_back(line); }));
  EXPECT_EQ(std::set<std::string>(lines.begin(), lines.end()),
            (std::set<std::string>{"case_0001: there already", "case_0002: written"}));
  EXPECT_EQ(sha256(read_whole(log)), before);
  EXPECT_EQ(read_whole(set_ / "digest.txt"), digest);
}

TEST_F(MakeTest, StopsBetweenCasesAndDoesNotSealAHalfSet) {
  const fs::path other = folder_->path() / "stopped";
  EXPECT_FALSE(make_cases(settings(other), {}, [] { return true; }));
  EXPECT_FALSE(fs::exists(other / "digest.txt"));
  EXPECT_THROW(case_inputs(other), std::runtime_error);
}

TEST_F(MakeTest, RefusesAnotherSetInTheSameFolderAndASeedOfTheOtherPurpose) {
  MakeSettings other = settings(set_);
  other.seed = 12;
  EXPECT_THROW(make_cases(other), std::invalid_argument);
  other.purpose = Purpose::kScore;
  EXPECT_THROW(make_cases(other), std::invalid_argument);
}

TEST_F(MakeTest, ScoringIsTakenUpWhereItStopped) {
  std::atomic<bool> stop{false};
  std::atomic<int> diagnosed{0};
  const auto diagnose = [&](const CaseInput& input) {
    ++diagnosed;
    stop = true;
    CaseResult result;
    result.name = input.name;
    result.causes = {{{}, 1.0, {}, {}, 0.0, 0.0, {}}};
    return result;
  };
  const ScoreSettings score{.directory = set_, .results = "results", .threads = 1};
  EXPECT_FALSE(score_cases(score, diagnose, {}, {}, [&] { return stop.load(); }).has_value());
  EXPECT_EQ(diagnosed, 1);
  EXPECT_TRUE(score_cases(score, diagnose, {}).has_value());
  EXPECT_EQ(diagnosed, 2);
  EXPECT_TRUE(fs::exists(set_ / "results" / "score.json"));
  // Results of other sensors do not mix with them.
  ScoreSettings other = score;
  other.how = "encoders and torques alone";
  EXPECT_THROW(score_cases(other, diagnose, {}), std::invalid_argument);
  other.results = "encoders";
  EXPECT_TRUE(score_cases(other, diagnose, {}).has_value());
}

TEST_F(MakeTest, InformedFitsAreMadeOnceForNamedEffectsAndNotWhereTheyAreDeclined) {
  const auto diagnose = [](const CaseInput& input) {
    CaseResult result;
    result.name = input.name;
    result.causes = {{{}, 1.0, {}, {}, 0.0, 0.0, {}}};
    return result;
  };
  std::atomic<int> fits{0};
  const auto informed = [&](const CaseInput&, const std::vector<std::string>&) {
    ++fits;
    return 0.5;
  };
  int named = 0;
  for (const CaseAnswer& answer : open_answers(set_)) named += answer.kind == Kind::kOneEffect || answer.kind == Kind::kTwoEffects ? 1 : 0;
  ScoreSettings score{.directory = set_, .results = "informed", .threads = 1, .informed_fits = false};
  EXPECT_TRUE(score_cases(score, diagnose, informed).has_value());
  EXPECT_EQ(fits, 0);
  score.informed_fits = true;
  EXPECT_TRUE(score_cases(score, diagnose, informed).has_value());
  EXPECT_TRUE(score_cases(score, diagnose, informed).has_value());
  EXPECT_EQ(fits, named);
}

// The machine drives what the result proposes and what is drawn, each log goes with the others, and a case that is sure has no second round.
TEST_F(MakeTest, ASecondRoundDrivesWhatIsProposed) {
  std::vector<std::string> diagnosed;
  const Manoeuvre in_ramps{{{0.3, 0.5}, {0.8, 0.0}}, 1.5};
  const auto diagnose = [&](const CaseInput& input) {
    diagnosed.push_back(input.name + ":" + std::to_string(input.logs.size()));
    CaseResult result;
    result.causes = {{{}, 0.6, {}, {}, 0.0, 0.0, {}}};
    if (input.name == "case_0001") result.next = result.drawn = in_ramps;
    return result;
  };
  const ScoreSettings score{.directory = set_, .results = "rounds", .threads = 1, .second_round = true, .informed_fits = false};
  ASSERT_TRUE(score_cases(score, diagnose, {}).has_value());
  EXPECT_EQ(diagnosed, (std::vector<std::string>{"case_0001:2", "case_0002:2", "case_0001:3", "case_0001:3"}));
  ASSERT_TRUE(score_cases(score, diagnose, {}).has_value());
  EXPECT_EQ(diagnosed.size(), 4u);  // all there already
  const msgs::RunLogs log = msgs::read_run_logs(set_ / "rounds" / "case_0001.proposed.lcmlog");
  ASSERT_EQ(log.runs.size(), 1u);
  const double ramp = controller::load_controller_file(settings(set_).controller).settings.ramp.acceleration_time;
  EXPECT_EQ(log.runs[0].torque.size(), static_cast<std::size_t>(std::lround(1.5 * ramp / kBaseStep)) + 1);
  // The lever at rest, then the two requests, at their times in ramps.
  ASSERT_EQ(log.runs[0].operator_moves.size(), 3u);
  EXPECT_NEAR(1e-9 * static_cast<double>(log.runs[0].operator_moves[1].simulated_time), 0.3 * ramp, kBaseStep);
  EXPECT_EQ(log.runs[0].operator_moves[1].speed_request, 0.5);
  // Measured once more with noise of its own.
  EXPECT_NE(read_whole(set_ / "rounds" / "case_0001.proposed.lcmlog"), read_whole(set_ / "rounds" / "case_0001.drawn.lcmlog"));
}

TEST_F(MakeTest, SomeCasesCanBeScoredAloneAndAnImpossibleNumberIsRefused) {
  std::vector<std::string> diagnosed;
  const auto diagnose = [&](const CaseInput& input) {
    diagnosed.push_back(input.name);
    CaseResult result;
    result.name = input.name;
    result.causes = {{{}, 1.0, {}, {}, 0.0, 0.0, {}}};
    return result;
  };
  ScoreSettings score{.directory = set_, .results = "first", .threads = 1, .first = 1};
  EXPECT_TRUE(score_cases(score, diagnose, {}).has_value());
  EXPECT_EQ(diagnosed, std::vector<std::string>{"case_0001"});
  EXPECT_EQ(nlohmann::json::parse(read_whole(set_ / "first" / "score.json")).at("cases"), 1);
  score.first = 0;
  EXPECT_TRUE(score_cases(score, diagnose, {}).has_value());
  EXPECT_EQ(diagnosed, (std::vector<std::string>{"case_0001", "case_0002"}));
  EXPECT_EQ(nlohmann::json::parse(read_whole(set_ / "first" / "score.json")).at("cases"), 2);
  for (const auto& [from, first] : {std::pair{1, 3}, {0, 1}, {2, 2}, {3, 0}}) {
    score.from = from;
    score.first = first;
    EXPECT_THROW(score_cases(score, diagnose, {}), std::invalid_argument) << from << ' ' << first;
  }
  // The second alone, against the second answer: what both have without what the first has.
  const auto truths_of = [&](const std::string& results, int begin, int cases) {
    const std::optional<ScoreTable> table = score_cases({.directory = set_, .results = results, .threads = 1, .from = begin, .first = cases}, diagnose, {});
    std::multiset<std::string> truths;
    for (const auto& [truth, answers] : table.value().confusion) {
      for (std::size_t n = 0; n < answers.size(); ++n) truths.insert(truth);
    }
    return truths;
  };
  diagnosed.clear();
  const std::multiset<std::string> second = truths_of("second", 2, 1);
  EXPECT_EQ(diagnosed, std::vector<std::string>{"case_0002"});
  EXPECT_EQ(nlohmann::json::parse(read_whole(set_ / "second" / "score.json")).at("cases"), 1);
  EXPECT_EQ(nlohmann::json::parse(read_whole(set_ / "second" / "score.json")).at("from"), 2);
  std::multiset<std::string> merged = truths_of("first", 1, 1);
  ASSERT_NE(merged, second);
  merged.merge(std::multiset<std::string>(second));
  EXPECT_EQ(truths_of("first", 1, 2), merged);
}

// Known laws change what the machines are made of, not which are drawn.
TEST_F(MakeTest, KnownLawsMakeTheSameDraw) {
  MakeSettings known = settings(folder_->path() / "known");
  known.laws = Laws::kKnown;
  ASSERT_TRUE(make_cases(known));
  EXPECT_EQ(settings_of(known.directory).laws, Laws::kKnown);
  EXPECT_EQ(settings_of(set_).laws, Laws::kWithheld);
  const std::vector<CaseAnswer> answers = open_answers(known.directory), withheld = open_answers(set_);
  for (std::size_t n = 0; n < answers.size(); ++n) {
    EXPECT_EQ(answers[n].kind, withheld[n].kind);
    ASSERT_EQ(answers[n].effects.size(), withheld[n].effects.size());
    for (std::size_t k = 0; k < answers[n].effects.size(); ++k) EXPECT_EQ(answers[n].effects[k].effect, withheld[n].effects[k].effect);
    EXPECT_NE(read_whole(known.directory / case_name(static_cast<int>(n) + 1) / "a.lcmlog"), read_whole(set_ / case_name(static_cast<int>(n) + 1) / "a.lcmlog"));
  }
  known.directory = set_;
  EXPECT_THROW(make_cases(known), std::invalid_argument);  // another set's folder
}

// One short run, written with each of the options.
class RecordOptions : public testing::Test {
 protected:
  static TruthRun run() {
    const std::string config = std::string(SLEWLAB_SOURCE_DIR) + "/config/";
    controller::ControllerSettings settings = controller::load_controller_file(config + "controllers/thesis.yaml").settings;
    settings.period = 0.01;
    return run_truth(make_truth_machine(sim::load_machine_file(config + "cranes/thesis.yaml").parameters, settings),
                     {{{0.3, 0.5}, {0.9, -0.25}}, 1.5}, {.noise_seed = 1});
  }
  static msgs::RunLog written(const LogSettings& settings) {
    const TemporaryFolder folder;
    write_log(run(), settings, folder.path() / "run.lcmlog");
    const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "run.lcmlog");
    EXPECT_TRUE(logs.remarks.empty());
    return logs.runs.at(0);
  }
};

TEST_F(RecordOptions, SensorsComeAtTheRateOfTheRecord) {
  const msgs::RunLog every = written({}), tenth = written({.sensor_steps = 10});
  ASSERT_EQ(every.sensors.size(), 1501u);  // 1.5 s at 1 kHz, both ends
  ASSERT_EQ(tenth.sensors.size(), 151u);
  EXPECT_EQ(every.encoder.size(), 151u);  // once per controller cycle, either way
  EXPECT_EQ(tenth.encoder.size(), 151u);
  for (std::size_t k = 0; k < tenth.sensors.size(); ++k) {
    EXPECT_EQ(tenth.sensors[k].simulated_time, every.sensors[10 * k].simulated_time);
    EXPECT_EQ(tenth.sensors[k].tip_acceleration, every.sensors[10 * k].tip_acceleration);
    EXPECT_EQ(tenth.sensors[k].sequence, static_cast<std::int64_t>(k));
  }
}

TEST_F(RecordOptions, SensorsThatAreNotThereAreNotRecorded) {
  const msgs::RunLog all = written({}), tip = written({.sensors = Sensors::kTip}), none = written({.sensors = Sensors::kNone});
  EXPECT_TRUE(none.sensors.empty());
  ASSERT_EQ(tip.sensors.size(), all.sensors.size());
  for (std::size_t k = 0; k < all.sensors.size(); ++k) {
    EXPECT_EQ(tip.sensors[k].tip_acceleration, all.sensors[k].tip_acceleration);
    EXPECT_FALSE(std::isnan(all.sensors[k].house_acceleration));
    for (const double value : {tip.sensors[k].house_acceleration, tip.sensors[k].pivot_acceleration,
                               tip.sensors[k].middle_acceleration, tip.sensors[k].slew_angle}) {
      EXPECT_TRUE(std::isnan(value));
    }
  }
}

TEST_F(RecordOptions, ARecordUnderWayIsTheEndOfTheWholeOne) {
  const msgs::RunLog whole = written({}), late = written({.from = 0.5});
  ASSERT_EQ(late.encoder.size(), 101u);
  for (std::size_t k = 0; k < late.encoder.size(); ++k) {
    EXPECT_EQ(late.encoder[k].simulated_time, whole.encoder[50 + k].simulated_time);
    EXPECT_EQ(late.encoder[k].shaft_position, whole.encoder[50 + k].shaft_position);
    EXPECT_EQ(late.torque[k].motor_torque, whole.torque[50 + k].motor_torque);
  }
  ASSERT_EQ(late.operator_moves.size(), 2u);  // the request that stands, and the one to come
  EXPECT_EQ(late.operator_moves[0].speed_request, 0.5);
  EXPECT_EQ(late.operator_moves[0].simulated_time, 500'000'000);  // [ns]
  EXPECT_EQ(late.operator_moves[1].speed_request, -0.25);
}

TEST_F(MakeTest, RefusesARateThatTheRunCannotBeSampledAt) {
  MakeSettings odd = settings(folder_->path() / "odd");
  odd.record_period = 1.0 / 300.0;  // [s] 3.3 ms
  EXPECT_THROW(make_cases(odd), std::invalid_argument);
  odd.record_period = 1.0 / 5000.0;  // shorter than the base step
  EXPECT_THROW(make_cases(odd), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
