#include "tools/commands/unknown_word.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slewlab::tools {
namespace {

class UnknownWord : public testing::Test {
 protected:
  UnknownWord() {
    CLI::App* run = app_.add_subcommand("run", "");
    run->add_option("SCENARIO", text_);
    run->add_option("--controller", text_);
    run->add_flag("--realtime", flag_);
    CLI::App* withhold = app_.add_subcommand("withhold", "");
    withhold->add_subcommand("make", "");
    withhold->add_subcommand("score", "");
    app_.add_subcommand("report", "")->prefix_command();
    app_.add_subcommand("pages", "not for people")->group("");
  }

  std::string found(std::vector<std::string> words) {
    words.insert(words.begin(), "slewlab");
    return unknown_word(app_, words).value_or("");
  }

  CLI::App app_{"", "slewlab"};
  std::string text_;
  bool flag_ = false;
};

TEST_F(UnknownWord, IsACommandWithTheNearOne) {
  EXPECT_EQ(found({"rnu", "a.yaml"}), "slewlab: 'rnu' is no command of it, expected 'run' (or one of run, withhold, report)");
  EXPECT_EQ(found({"withhold", "scroe"}), "slewlab withhold: 'scroe' is no command of it, expected 'score' (or one of make, score)");
  EXPECT_EQ(found({"calibrate"}), "slewlab: 'calibrate' is no command of it, expected one of run, withhold, report");
}

TEST_F(UnknownWord, IsNoneWhereACommandIsHidden) { EXPECT_EQ(found({"pages"}), ""); }

TEST_F(UnknownWord, IsAnOptionWithTheNearOne) {
  const std::string of_run = "slewlab run: '--contoller' is no option of it, expected '--controller' (or one of --help, --controller, --realtime)";
  EXPECT_EQ(found({"run", "a.yaml", "--contoller", "x"}), of_run);
  EXPECT_EQ(found({"run", "--contoller=x", "a.yaml"}), of_run);
}

// With which help is asked for of no command.
TEST_F(UnknownWord, OfTheFirstPlaceNamesNoCommand) {
  EXPECT_TRUE(names_no_command(app_, {"slewlab", "rnu", "--help"}));
  EXPECT_FALSE(names_no_command(app_, {"slewlab", "run", "rnu", "--help"}));
  EXPECT_FALSE(names_no_command(app_, {"slewlab", "--help"}));
  EXPECT_FALSE(names_no_command(app_, {"slewlab"}));
}

TEST_F(UnknownWord, IsNoValueAndNoWordOfAnotherProgram) {
  EXPECT_EQ(found({"run", "a.yaml", "--controller", "--whatever", "--realtime"}), "");
  EXPECT_EQ(found({"run", "rnu"}), "");  // a scenario of that name
  EXPECT_EQ(found({"report", "--of-python"}), "");
}

}  // namespace
}  // namespace slewlab::tools
