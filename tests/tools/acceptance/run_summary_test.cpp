// Of a summary.json that is there, every slip is told with its path and what would be right; it is never passed over.

#include "tools/acceptance/run_summary.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

class RunSummaryTest : public testing::Test {
 protected:
  RunSummary of(const std::string& text) {
    std::ofstream(folder_.path() / "summary.json") << text;
    return read_run_summary(folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(RunSummaryTest, TellsOfACompleteRunWhichLogItWrote) {
  EXPECT_FALSE(read_run_summary(folder_.path()).is_there);
  const RunSummary summary = of(R"({"outcome": "complete", "run": {"log_digest": "00112233445566ff", "configuration_hash": "e78a261747aaa215"}})");
  EXPECT_TRUE(summary.is_there);
  EXPECT_EQ(summary.problem, "");
  EXPECT_EQ(summary.why_incomplete, "");
  EXPECT_EQ(summary.log_digest, "00112233445566ff");
  EXPECT_EQ(summary.configuration_hash, "e78a261747aaa215");
}

TEST_F(RunSummaryTest, TellsWhyARunDidNotComeToItsEnd) {
  EXPECT_EQ(of(R"({"outcome": "failed", "reason": "the disk is full"})").why_incomplete, "the disk is full");
  EXPECT_EQ(of(R"({"outcome": "failed", "reason": 3})").why_incomplete, "failed");
}

TEST_F(RunSummaryTest, OneThatCannotBeReadIsToldWithWhatWouldBeRight) {
  const std::string object = "a JSON object with outcome and run", digest = "16 hexadecimal digits";
  for (const auto& [text, key, expected] : std::initializer_list<std::tuple<std::string, std::string, std::string>>{
           {"", "", object},
           {R"({"out)", "", object},
           {"null", "found null", object},
           {"[]", "found []", object},
           {"{}", "outcome", "\"complete\""},
           {R"({"outcome": 5})", "key 'outcome': found 5", "\"complete\""},
           {R"({"outcome": "complete"})", "key 'run': found nothing", "an object with log_digest"},
           {R"({"outcome": "complete", "run": []})", "key 'run': found []", "an object with log_digest"},
           {R"({"outcome": "complete", "run": {}})", "key 'run.log_digest': found nothing", digest},
           {R"({"outcome": "complete", "run": {"log_digest": 3}})", "key 'run.log_digest': found 3", digest},
           {R"({"outcome": "complete", "run": {"log_digest": "xyz"}})", "run.log_digest", digest},
           {"{\"outcome\": \"complete\", \"run\": {\"log_digest\": \"\\u001b[31m\"}}", "\\u001b[31m", digest}}) {
    const RunSummary summary = of(text);
    EXPECT_TRUE(summary.is_there) << text;
    EXPECT_TRUE(summary.problem.starts_with((folder_.path() / "summary.json").string())) << text << ": " << summary.problem;
    EXPECT_NE(summary.problem.find(key), std::string::npos) << text << ": " << summary.problem;
    EXPECT_NE(summary.problem.find(expected), std::string::npos) << text << ": " << summary.problem;
    EXPECT_EQ(summary.problem.find('\x1b'), std::string::npos) << text;
    EXPECT_EQ(summary.log_digest, "") << text;
  }
}

}  // namespace
}  // namespace slewlab::tools
