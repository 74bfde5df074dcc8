#include "tools/commands/check_command.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

class CheckCommand : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("slewlab_check_") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    fs::copy(SLEWLAB_SOURCE_DIR "/config", folder_ / "config", fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Replaces the first `from` in the thesis's crane by `to`, checks it, and answers with what was said.
  std::string said_after(const std::string& from, const std::string& to) {
    const fs::path file = folder_ / "config/cranes/thesis.yaml";
    std::stringstream content;
    content << std::ifstream(file).rdbuf();
    std::string text = content.str();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at == std::string::npos) return "";
    line_ = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    text.replace(at, from.size(), to);
    std::ofstream(file) << text;
    std::ostringstream out;
    std::ostringstream complaints;
    EXPECT_EQ(check_files({file}, {}, out, complaints), 1);
    EXPECT_EQ(out.str(), "");
    where_ = file.string() + ':' + std::to_string(line_) + ':';
    return complaints.str();
  }

  // File and line first, then key, found, expected: all of it in one line.
  void expect_line(const std::string& said, const std::string& key, const std::string& found,
                   const std::string& expected) {
    EXPECT_EQ(said.rfind(where_, 0), 0u) << said << " should begin with " << where_;
    EXPECT_NE(said.find("key '" + key + "': found " + found + ", expected " + expected), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }

  fs::path written(const std::string& text) {
    std::ofstream(folder_ / "written.yaml") << text;
    return folder_ / "written.yaml";
  }
  static std::string told(const FileFindings& found) {
    std::string said;
    for (const auto& problem : found.problems) said += common::to_text(problem) + '\n';
    return said;
  }

  fs::path folder_;
  long line_ = 0;
  std::string where_;
};

TEST_F(CheckCommand, EveryFileOfTheProjectIsGood) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(SLEWLAB_SOURCE_DIR "/config")) {
    const std::string kind = entry.path().parent_path().filename().string();
    if (entry.path().extension() == ".yaml" && (kind == "cranes" || kind == "axes" || kind == "controllers" || kind == "scenarios")) {
      files.push_back(entry.path());
    }
  }
  ASSERT_GE(files.size(), 10u);
  std::ostringstream out;
  std::ostringstream complaints;
  EXPECT_EQ(check_files(files, {}, out, complaints), 0);
  EXPECT_EQ(complaints.str(), "");
  const std::string said = out.str();
  EXPECT_EQ(static_cast<std::size_t>(std::count(said.begin(), said.end(), '\n')), files.size());
}

TEST_F(CheckCommand, UnknownKey) {
  expect_line(said_after("rope_length", "rope_lenght: 3\n  rope_length"), "load.rope_lenght",
              "a key that is not known here", "'rope_length' (or one of mass, rope_length, rod_length, damping_ratio)");
}

TEST_F(CheckCommand, MissingKey) {
  const std::string said = said_after("  rope_length: {value: 60, unit: m, source: \"thesis Table 4.2\"}\n", "");
  EXPECT_NE(said.find("key 'load.rope_length': found nothing: the key is missing, expected a number above 0 m"),
            std::string::npos)
      << said;
}

TEST_F(CheckCommand, WrongType) {
  expect_line(said_after("value: 46.6", "value: long"), "boom.length", "long", "a number above 0 m");
}

TEST_F(CheckCommand, NegativeMass) {
  expect_line(said_after("value: 81047", "value: -81047"), "boom.mass", "-81047 kg", "a number above 0 kg");
}

TEST_F(CheckCommand, NotANumber) {
  expect_line(said_after("value: 81047", "value: .nan"), "boom.mass", ".nan", "a number above 0 kg");
}

TEST_F(CheckCommand, MixedUnits) {
  expect_line(said_after("value: 6900, unit: kN m/rad", "value: 6900, unit: kN m"), "drive.gearbox_stiffness",
              "the unit 'kN m', which measures something else", "one of N m/rad, kN m/rad, MN m/rad, GN m/rad");
}

TEST_F(CheckCommand, MissingUnit) {
  expect_line(said_after("value: 46.6, unit: m", "value: 46.6"), "boom.length", "46.6 without a unit",
              "unit: one of m, mm, cm, km");
}

TEST_F(CheckCommand, MissingSource) {
  expect_line(said_after("value: 46.6, unit: m, source: \"thesis Table 2.4\"", "value: 46.6, unit: m"), "boom.length",
              "46.6 without a source", "source:");
}

TEST_F(CheckCommand, DuplicateKey) {
  const std::string said = said_after("  brake_inertia", "  motor_inertia: 3\n  brake_inertia");
  expect_line(said, "drive.motor_inertia", "the key a second time",
              "it once; it stands in line " + std::to_string(line_ - 1) + " already");
}

TEST_F(CheckCommand, CyclicInclude) {
  const std::string said = said_after("kind: crane", "include: no_load.yaml\nkind: crane");
  where_ = (folder_ / "config/cranes/no_load.yaml:1:10:").string();
  expect_line(said, "include", "a circle of includes: thesis.yaml -> no_load.yaml -> thesis.yaml",
              "files that do not include themselves");
}

TEST_F(CheckCommand, MissingKind) {
  expect_line(said_after("kind: crane\n", ""), "kind", "nothing: the key is missing", "one of crane, axis, controller, scenario, acceptance, acceptance_plan, campaign, soak, import_map, plc_map");
}

TEST_F(CheckCommand, AKeyThatWasMeantToBeKind) {
  expect_line(said_after("kind: crane", "kidn: crane"), "kidn", "a key that is not known here", "'kind'");
}

TEST_F(CheckCommand, UnknownKind) {
  expect_line(said_after("kind: crane", "kind: ship"), "kind", "ship", "one of crane, axis, controller, scenario, acceptance, acceptance_plan, campaign, soak, import_map, plc_map");
}

TEST_F(CheckCommand, AKindThatIsMistypedHasTheNearOne) {
  const auto problems = examine(written("kind: crain\n"), {}).problems;
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].expected.rfind("'crane' (or one of crane, axis, ", 0), 0u) << problems[0].expected;
}

TEST_F(CheckCommand, LimitsAndSoaksAreCheckedToo) {
  for (const char* file : {"acceptance/thesis.yaml", "soak/thesis.yaml"}) EXPECT_TRUE(examine(folder_ / "config" / file, {}).problems.empty()) << file;
  EXPECT_EQ(told(examine(folder_ / "config/acceptance/thesis.yaml", {{"overshoot", "-3 %"}})),
            "--set overshoot=-3 %: key 'overshoot': found -3 %, expected a number of at least 0 %\n");
  EXPECT_NE(told(examine(folder_ / "config/soak/thesis.yaml", {{"taskk", "1"}})).find("key 'taskk'"), std::string::npos);
}

TEST_F(CheckCommand, AnUnknownEffectIsToldBesideWhatElseIsWrong) {
  const fs::path crane = folder_ / "config/cranes/thesis.yaml";
  const std::vector<common::Override> changes{{"load.mass", "-1 t"}, {"effects", "[{effect: bearing_stribek}]"}};
  const std::string said = told(examine(crane, changes));
  EXPECT_NE(said.find("key 'load.mass'"), std::string::npos) << said;
  EXPECT_NE(said.find("key 'effects.0.effect': found bearing_stribek, expected the name of an effect; 'bearing_stribeck' is near"), std::string::npos) << said;
  const std::string of_scenario = told(examine(folder_ / "config/scenarios/thesis_slew.yaml", {{"crane.load.mass", "-1 t"}, {"crane.effects", "[{effect: bearing_stribek}]"}}));
  EXPECT_NE(of_scenario.find("key 'crane.effects.0.effect': found bearing_stribek"), std::string::npos) << of_scenario;
}

// A template's sources stand until somebody says where his numbers are from.
TEST_F(CheckCommand, WhatATemplateLeavesToItsUserIsRemarkedOn) {
  const fs::path crane = folder_ / "config/templates/crane.yaml";
  std::ostringstream out, complaints;
  EXPECT_EQ(check_files({crane}, {}, out, complaints), 0);
  std::stringstream text;
  text << std::ifstream(crane).rdbuf();
  std::size_t sources = 0;
  for (std::size_t at = 0; (at = text.str().find("replace by your own", at)) != std::string::npos; ++at) ++sources;
  EXPECT_EQ(complaints.str(), crane.string() + ":8:14: warning: key 'description': still the template's, 'replace by what tells this crane from others'\n" +
                                  crane.string() + ":13:41: warning: " + std::to_string(sources) +
                                  " values have the template's source still, 'example: replace by your own'; here is the first\n");
}

TEST_F(CheckCommand, ControllerThatDoesNotFitTheCrane) {
  const fs::path file = folder_ / "config/scenarios/thesis_slew.yaml";
  const auto problems =
      examine(file, {{"controller", (folder_ / "config/controllers/one_group.yaml").string()}}).problems;
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(common::to_text(problems[0])
                .find("key 'controller': found a controller for 1 motor group(s), expected one for the crane's 2"),
            std::string::npos)
      << common::to_text(problems[0]);
}

TEST_F(CheckCommand, ScenarioIsCheckedWithItsCraneAndItsController) {
  const auto problems = examine(folder_ / "config/scenarios/thesis_slew.yaml",
                                    {{"crane.load.mass", "-1 t"}, {"controller.ramp.top_speed", "-1"}, {"seed", "-1"}}).problems;
  std::string said;
  for (const auto& problem : problems) said += common::to_text(problem) + '\n';
  EXPECT_EQ(problems.size(), 3u) << said;
  for (const char* key : {"key 'crane.load.mass'", "key 'controller.ramp.top_speed'", "key 'seed'"}) {
    EXPECT_NE(said.find(key), std::string::npos) << said;
  }
}

// What the plant refuses of the effects is told of the file and line where the user wrote it, not of the run's own copy.
TEST_F(CheckCommand, UnknownEffect) {
  expect_line(said_after("kind: crane\n", "effects: [{effect: dead_tim}]\nkind: crane\n"), "effects.0.effect", "dead_tim",
              "the name of an effect; 'dead_time' is near");
}

TEST_F(CheckCommand, EffectWithAWrongUnit) {
  expect_line(said_after("kind: crane\n", "effects: [{effect: dead_time, delay: {value: 3, unit: mm, source: s}}]\nkind: crane\n"),
              "effects.0.delay", "the unit 'mm', which measures something else", "one of s, ms, us, min, h");
}

TEST_F(CheckCommand, EffectWithoutItsParameter) {
  expect_line(said_after("kind: crane\n", "effects: [{effect: dead_time}]\nkind: crane\n"), "effects.0.delay",
              "nothing: the key is missing", "a number from");
}

TEST_F(CheckCommand, EffectsOfAnIncludedFileOfAScenariosCrane) {
  std::ofstream(folder_ / "config/cranes/base.yaml") << "include: thesis.yaml\n\neffects:\n  - effect: no_such_effect\n";
  std::ofstream(folder_ / "config/cranes/top.yaml") << "include: base.yaml\n";
  for (const ControllerBy by : {ControllerBy::slewlab, ControllerBy::user}) {
    const auto problems = examine(folder_ / "config/scenarios/thesis_slew.yaml",
                                      {{"crane", (folder_ / "config/cranes/top.yaml").string()}}, by).problems;
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(common::to_text(problems[0]).rfind((folder_ / "config/cranes/base.yaml:4:13: key 'effects.0.effect'").string(), 0), 0u)
        << common::to_text(problems[0]);
  }
}

// Each value is within its bounds; together they are more than Euler's load of the boom.
TEST_F(CheckCommand, EffectThatTheCraneCannotHave) {
  const auto problems =
      examine(folder_ / "config/cranes/thesis.yaml",
                  {{"effects", "[{effect: compression_softening, compression: {value: 4, unit: MN, source: s}}]"},
                   {"boom.youngs_modulus", "1 GPa"}}).problems;
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(common::to_text(problems[0]).find("key 'effects': found a machine that cannot be built (effect "
                                              "compression_softening: the boom buckles under this compression)"),
            std::string::npos)
      << common::to_text(problems[0]);
}

TEST_F(CheckCommand, WhatNoMachineHasIsRefused) {
  const struct {
    const char* key;
    const char* value;
    const char* found;
  } kSlips[] = {{"load.mass", "30000000 t", "3e+10 kg, which no machine has, expected from 1e-06 to 1e+09 kg"},
                {"boom.mass", "1e308 kg", "1e+308 kg, which no machine has, expected from 1e-06 to 1e+09 kg"},
                {"load.rope_length", "1e-12 m", "1e-12 m, which no machine has, expected from 1e-04 to 10000 m"}};
  for (const auto& slip : kSlips) {
    const auto problems = examine(folder_ / "config/cranes/thesis.yaml", {{slip.key, slip.value}}).problems;
    ASSERT_EQ(problems.size(), 1u) << slip.key;
    EXPECT_EQ(common::to_text(problems[0]),
              std::string("--set ") + slip.key + "=" + slip.value + ": key '" + slip.key + "': found " + slip.found);
  }
}

// What is set on the command line is told with the key that stood there, whichever file it is a key of.
TEST_F(CheckCommand, AnOptionIsToldAsItWasGiven) {
  const fs::path scenario = folder_ / "config/scenarios/thesis_slew.yaml";
  const std::pair<const char*, const char*> options[] = {{"crane.load.mass", "30000000 t"}, {"crane.load.mass", "60000"},
                                                         {"crane.boom.angel", "1 deg"}, {"controller.ramp.top_speed", "-1"},
                                                         {"crane.effects", "[{effect: gust}]"}};
  for (const auto& [key, value] : options) {
    const auto problems = examine(scenario, {{key, value}}).problems;
    ASSERT_FALSE(problems.empty()) << key;
    const std::string told = common::to_text(problems[0]);
    EXPECT_EQ(told.rfind(std::string("--set ") + key + "=" + value + ": key '" + key, 0), 0u) << told;
  }
}

TEST_F(CheckCommand, WhatIsUnlikelyOrTakesLongIsAWarning) {
  const fs::path scenario = folder_ / "config/scenarios/thesis_slew.yaml";
  std::ostringstream out;
  std::ostringstream complaints;
  EXPECT_EQ(check_files({scenario}, {{"crane.load.mass", "60000 t"}, {"plant_step", "1 us"}}, out, complaints), 0);
  EXPECT_EQ(out.str(), scenario.string() + ": OK\n");
  EXPECT_EQ(complaints.str().rfind("--set crane.load.mass=60000 t: warning: key 'crane.load.mass': a load of 740 times the boom's mass; usual: a "
                                   "hundredth to five times\n", 0), 0u) << complaints.str();
  EXPECT_EQ(examine(scenario, {{"plant_step", "1e-6 ms"}}).warnings,
            std::vector<std::string>{scenario.string() + ": warning: about 60 000 000 000 plant steps, some 4 hours of computing in "
                                     "lockstep, with a plant_step of 1e-06 ms and 6 boom elements"});
  EXPECT_EQ(examine(scenario, {{"crane.boom.elements", "1000"}}).warnings,
            std::vector<std::string>{scenario.string() + ": warning: about 60 000 plant steps, some 100 seconds of computing in "
                                     "lockstep, with a plant_step of 1 ms and 1000 boom elements"});
}

TEST_F(CheckCommand, WhatBeginsBehindTheEndIsAWarning) {
  const fs::path scenario = folder_ / "config/scenarios/thesis_slew.yaml";
  EXPECT_TRUE(examine(scenario, {}).warnings.empty());
  const auto warnings = examine(scenario, {{"duration", "20"}}).warnings;  // the emergency stop comes at 30 s
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find(": warning: key 'operator.1.time': 30 s, when the run is over: it lasts 20 s"), std::string::npos) << warnings[0];
  EXPECT_EQ(warnings[0].rfind(scenario.string() + ":", 0), 0u) << warnings[0];
}

TEST_F(CheckCommand, OneBadFileDoesNotHideTheOthers) {
  std::ostringstream out;
  std::ostringstream complaints;
  EXPECT_EQ(check_files({folder_ / "none.yaml", folder_ / "config/cranes/thesis.yaml"}, {}, out, complaints), 1);
  EXPECT_NE(out.str().find("thesis.yaml: OK"), std::string::npos);
  EXPECT_NE(complaints.str().find("none.yaml', which cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace slewlab::tools
