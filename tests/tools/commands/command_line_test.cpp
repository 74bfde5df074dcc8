// Words of a command line, as the commands see them.

#include "tools/commands/command_line.h"

#include <gtest/gtest.h>

namespace slewlab::tools {
namespace {

using Words = std::vector<std::string>;

TEST(CommandLine, SettingsTakeNoWordThatIsNone) {
  EXPECT_EQ(with_one_setting_each({"slewlab", "run", "--set", "crane.load.mass=3t", "scenario.yaml"}), (Words{"slewlab", "run", "--set", "crane.load.mass=3t", "scenario.yaml"}));
  EXPECT_EQ(with_one_setting_each({"slewlab", "run", "--set", "a=1", "b=2", "runs/c=3/scenario.yaml", "--out", "d=4"}),
            (Words{"slewlab", "run", "--set", "a=1", "--set", "b=2", "runs/c=3/scenario.yaml", "--out", "d=4"}));
  EXPECT_EQ(with_one_setting_each({"slewlab", "run", "--set", "a=1", "--realtime"}), (Words{"slewlab", "run", "--set", "a=1", "--realtime"}));
  EXPECT_EQ(with_one_setting_each({"slewlab", "run", "--", "--set", "a=1", "b=2"}), (Words{"slewlab", "run", "--", "--set", "a=1", "b=2"}));
}

TEST(CommandLine, ASettingMayStandBeforeTheFile) {
  for (const Words& words : {Words{"run", "--set", "a=1", "b=/x y", "scenario.yaml"}, Words{"run", "scenario.yaml", "--set", "a=1", "--set", "b=/x y"},
                             Words{"run", "--set=a=1", "--set", "b=/x y", "scenario.yaml"}}) {
    CLI::App app{"", "slewlab"};
    std::string scenario;
    Words settings;
    CLI::App* run = app.add_subcommand("run", "");
    run->add_option("SCENARIO", scenario)->required();
    add_settings(*run, settings, "");
    Words line{"slewlab"};
    line.insert(line.end(), words.begin(), words.end());
    EXPECT_EQ(act(app, line, [] { return 0; }), 0);
    EXPECT_EQ(scenario, "scenario.yaml");
    EXPECT_EQ(settings, (Words{"a=1", "b=/x y"}));
  }
}

TEST(CommandLine, AnOptionThatIsGivenTwiceIsTold) {
  const auto said = [](const Words& words) {
    CLI::App app{"", "slewlab"};
    std::string machine, out;
    CLI::App* make = app.add_subcommand("new", "");
    make->add_option("--crane,--axis", machine);
    make->add_option("--out", out);
    testing::internal::CaptureStderr();
    EXPECT_EQ(act(app, words, [] { return 0; }), 2);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(said({"slewlab", "new", "--crane", "a", "--axis", "b"}), "slewlab new: --crane,--axis, one option by several names, is given 2 times, expected once\n");
  EXPECT_EQ(said({"slewlab", "new", "--out", "a", "--out", "b", "--out", "c"}), "slewlab new: --out is given 3 times, expected once\n");
}

TEST(CommandLine, WhatIsWrongIsToldOfItsCommand) {
  CLI::App app{"", "slewlab"};
  std::string kind, out;
  CLI::App* schema = app.add_subcommand("schema", "");
  CLI::Option* first = schema->add_option("KIND", kind);
  first->excludes(schema->add_option("--out", out));
  testing::internal::CaptureStderr();
  EXPECT_EQ(act(app, {"slewlab", "schema", "crane", "--out", "x"}, [] { return 0; }), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "slewlab schema: found KIND beside --out, expected one of the two\n");
}

}  // namespace
}  // namespace slewlab::tools
