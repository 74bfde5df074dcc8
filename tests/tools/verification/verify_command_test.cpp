#include "tools/commands/verify_command.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

namespace slewlab::tools {
namespace {

// The identifiers of the reproduction table; every one of them must have a row.
const std::set<std::string> kTable{"T2.1", "2.6.1", "T2.2", "T2.3", "T2.5",  "T3.3",  "2.10",  "T3.2",
                                   "3.26", "3.27",  "F3.12", "F3.13", "T3.4", "3.4.3", "T4.1",  "4.2",
                                   "F4.2", "F4.3",  "F4.6",  "F4.7",  "F4.8", "F4.9",  "F4.11", "F4.12",
                                   "F4.13", "F4.14", "F4.15", "F4.16", "F4.18"};

TEST(VerifyCommand, JsonHoldsEveryRowAndTheExitCodeFollowsTheMisses) {
  std::ostringstream out, complaints;
  const int code = verify({std::string(SLEWLAB_SOURCE_DIR) + "/config", true}, out, complaints);
  const nlohmann::json result = nlohmann::json::parse(out.str());
  std::set<std::string> found;
  int missed = 0;
  for (const auto& row : result["rows"]) {
    found.insert(row["id"].get<std::string>());
    if (row["verdict"] == "misses") ++missed;
  }
  for (const std::string& id : kTable) EXPECT_TRUE(found.contains(id)) << id;
  EXPECT_EQ(result["missed"].get<int>(), missed);
  EXPECT_EQ(code, missed == 0 ? 0 : 1);
  EXPECT_TRUE(complaints.str().empty());
}

TEST(VerifyCommand, AMissingConfigurationIsOneClearComplaint) {
  std::ostringstream out, complaints;
  EXPECT_EQ(verify({"/nowhere", false}, out, complaints), 2);
  EXPECT_NE(complaints.str().find("/nowhere/cranes/thesis.yaml"), std::string::npos);
  EXPECT_TRUE(out.str().empty());
}

}  // namespace
}  // namespace slewlab::tools
