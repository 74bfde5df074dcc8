#include "tools/commands/option_check.h"

#include <gtest/gtest.h>

#include <string>

namespace slewlab::tools {
namespace {

std::string said(const CLI::Validator& check, std::string text) { return check(text); }

TEST(OptionCheck, NumbersAreToldAsPeopleWriteThem) {
  EXPECT_EQ(said(positive_number(), "0.5"), "");
  for (const char* text : {"0", "-1", "x", "1h", "inf", "nan", ""}) {
    EXPECT_EQ(said(positive_number(), text), "found '" + std::string(text) + "', expected a number above 0");
  }
  EXPECT_EQ(said(whole_number(0, 256), "256"), "");
  EXPECT_EQ(said(whole_number(0, 256), "257"), "found '257', expected a whole number from 0 to 256");
  EXPECT_EQ(said(whole_number(1), "3"), "");
  EXPECT_EQ(said(whole_number(1), "2.5"), "found '2.5', expected a whole number of at least 1");
}

TEST(OptionCheck, AWordIsAnsweredWithTheNearOne) {
  EXPECT_EQ(said(one_of({"all", "tip", "none"}), "tip"), "");
  EXPECT_EQ(said(one_of({"all", "tip", "none"}), "nome"), "found 'nome', expected 'none' (or one of all, tip, none)");
  std::string word = "lines";
  const CLI::Validator choice = number_of({{"auto", 0}, {"lines", 1}, {"none", 2}});
  EXPECT_EQ(choice(word), "");
  EXPECT_EQ(word, "1");
  EXPECT_EQ(said(choice, "line"), "found 'line', expected 'lines' (or one of auto, lines, none)");
}

TEST(OptionCheck, FilesAndFoldersHaveToBeThere) {
  const std::string folder = SLEWLAB_SOURCE_DIR "/config", file = folder + "/cranes/thesis.yaml";
  EXPECT_EQ(said(readable_file(), file), "");
  EXPECT_EQ(said(readable_file(), folder), "found '" + folder + "', expected the name of a file that is there");
  EXPECT_EQ(said(readable_folder(), folder), "");
  EXPECT_EQ(said(readable_folder(), file), "found '" + file + "', expected the name of a folder that is there");
  EXPECT_EQ(said(readable_path(), folder), "");
  EXPECT_EQ(said(readable_path(), "nowhere"), "found 'nowhere', expected the name of a file or a folder that is there");
}

TEST(OptionCheck, ACommandIsNotEmpty) {
  EXPECT_EQ(said(shell_command(), "exec ./controller --fast"), "");
  for (const char* text : {"", "  "}) EXPECT_EQ(said(shell_command(), text), "found '" + std::string(text) + "', expected a command of the shell");
}

}  // namespace
}  // namespace slewlab::tools
