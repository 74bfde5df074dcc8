#include "tools/commands/command_pages.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/msgs/temporary_folder.h"
#include "tools/commands/option_check.h"

namespace slewlab::tools {
namespace {

class CommandPages : public testing::Test {
 protected:
  CommandPages() {
    app_.footer("Exit codes: 0 done.");
    CLI::App* run = app_.add_subcommand("run", "Run a scenario");
    run->add_option("SCENARIO", text_, "scenario file")->required();
    run->add_option("--controller", text_, "shell command");
    run->add_option("--progress", text_, "how")->check(one_of({"auto", "lines", "none"}));
    CLI::App* make = app_.add_subcommand("new", "Write a file");
    make->add_option("KIND", text_, "what")->check(one_of({"crane", "map"}));
    CLI::App* withhold = app_.add_subcommand("withhold", "Machines nobody has looked at");
    withhold->add_subcommand("make", "Draw machines")->add_option("--cases", text_, "how many");
    app_.add_subcommand("pages", "not for people")->group("");
  }

  CLI::App app_{"A simulated crane", "slewlab"};
  std::string text_;
};

TEST_F(CommandPages, AManualPageForEveryCommandThatIsShown) {
  const std::vector<CommandPage> pages = manual_pages(app_, "0.2.0");
  std::vector<std::string> names;
  for (const CommandPage& page : pages) names.push_back(page.name);
  EXPECT_EQ(names, (std::vector<std::string>{"slewlab.1", "slewlab-run.1", "slewlab-new.1", "slewlab-withhold.1", "slewlab-withhold-make.1"}));
  EXPECT_NE(pages[1].text.find(".SH NAME\nslewlab\\-run \\- Run a scenario\n"), std::string::npos) << pages[1].text;
  EXPECT_NE(pages[1].text.find("\n.B \\-\\-controller"), std::string::npos) << pages[1].text;
  EXPECT_NE(pages[1].text.find(".SH EXIT STATUS\nExit codes: 0 done."), std::string::npos) << pages[1].text;
  EXPECT_NE(pages[0].text.find(".B slewlab withhold\nMachines nobody has looked at"), std::string::npos) << pages[0].text;
  EXPECT_EQ(pages[0].text.find("not for people"), std::string::npos);
}

TEST_F(CommandPages, AProgramsHelpBecomesAPage) {
  const CommandPage page = page_of_help("slewlab-plant", "The crane as a process.\nUsage: slewlab-plant [OPTIONS]\n\nOptions:\n  -h,--help   Print this\n  .first      at a line's beginning\n", "0.2.0");
  EXPECT_EQ(page.name, "slewlab-plant.1");
  EXPECT_EQ(page.text, ".TH slewlab\\-plant 1 \"\" \"slewlab 0.2.0\"\n.SH NAME\nslewlab\\-plant \\- The crane as a process.\n.SH SYNOPSIS\n.B slewlab\\-plant [OPTIONS]\n"
                       ".SH OPTIONS\n.nf\n  \\-h,\\-\\-help   Print this\n  .first      at a line's beginning\n.fi\n");
}

// A command whose command line another program reads: from what that one says of itself, or by a word that it is to be asked.
TEST_F(CommandPages, OfACommandThatAnotherProgramReadsWhatThatOneTakes) {
  app_.add_subcommand("report", "Draw a run")->prefix_command();
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "commands.json") << R"({"report": [["RUN", "folder of a run", true], ["-o,--out", "the page", false]]})";
  const ForeignOptions foreign = read_foreign_options(folder.path() / "commands.json");
  const std::string page = manual_pages(app_, "0.2.0", foreign).back().text;
  EXPECT_NE(page.find(".SH ARGUMENTS\n.TP\n.B RUN\nfolder of a run\n"), std::string::npos) << page;
  EXPECT_NE(page.find(".SH OPTIONS\n.TP\n.B \\-o,\\-\\-out\nthe page\n"), std::string::npos) << page;
  EXPECT_NE(completion_script(app_, foreign).find("report) words=\"--out\""), std::string::npos);
  EXPECT_NE(manual_pages(app_, "0.2.0").back().text.find("slewlab report \\-\\-help"), std::string::npos);
  EXPECT_TRUE(read_foreign_options(folder.path() / "none.json").empty());
  std::ofstream(folder.path() / "broken.json") << "[1]";
  EXPECT_THROW(read_foreign_options(folder.path() / "broken.json"), std::runtime_error);
}

// Asked by bash itself, as it asks at the Tab key.
TEST_F(CommandPages, CompletionAnswersBash) {
  const TemporaryFolder folder;
  app_.add_subcommand("bridge", "To viewers, or to a PLC")->prefix_command();
  const ForeignOptions foreign{{"bridge", {{"--foxglove", "", false}, {"PROTOCOL", "", true, {"modbus", "ads"}}, {"--format", "", false, {"csv", "mcap"}}}},
                               {"bridge modbus", {{"--map", "", false}}}};
  std::ofstream(folder.path() / "completion") << completion_script(app_, foreign, {{"--controller", {"slow", "smooth"}}});
  const auto answer = [&](const std::string& words, int at) {
    const std::string script = "cd " + folder.path().string() + " && . ./completion && COMP_WORDS=(" + words + ") COMP_CWORD=" +
                               std::to_string(at) + "; _slewlab; echo \"${COMPREPLY[*]}\"";
    FILE* pipe = ::popen(("bash -c '" + script + "'").c_str(), "r");  // NOLINT(bugprone-command-processor): bash is what is tested
    char line[1000] = "";
    if (std::fgets(line, sizeof line, pipe) == nullptr) line[0] = '\0';
    ::pclose(pipe);
    return std::string(line);
  };
  EXPECT_EQ(answer("slewlab r", 1), "run\n");
  EXPECT_EQ(answer("slewlab run --c", 2), "--controller\n");
  EXPECT_EQ(answer("slewlab run comp", 2), "completion\n");  // the file
  EXPECT_EQ(answer("slewlab withhold m", 2), "make\n");
  EXPECT_EQ(answer("slewlab withhold make --c", 3), "--cases\n");
  EXPECT_EQ(answer("slewlab run a.yaml --progress \"\"", 4), "auto lines none\n");
  EXPECT_EQ(answer("slewlab run --controller s", 3), "slow smooth\n");
  EXPECT_EQ(answer("slewlab new c", 2), "crane completion\n");
  EXPECT_EQ(answer("slewlab bridge --", 2), "--foxglove --format\n");
  EXPECT_EQ(answer("slewlab bridge m", 2), "modbus\n");
  EXPECT_EQ(answer("slewlab bridge modbus --", 3), "--map\n");
  EXPECT_EQ(answer("slewlab bridge --format m", 3), "mcap\n");
}

}  // namespace
}  // namespace slewlab::tools
