#include "tools/commands/findings.h"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

// A diagnosis that ends half way leaves no half of an answer.
TEST(FindingsFolder, GoAgainWhereTheWorkEndsBeforeTheyAreWhole) {
  const TemporaryFolder folder;
  const fs::path there = folder.path() / "there", made = folder.path() / "made";
  fs::create_directory(there);
  std::ofstream(there / "notes.txt") << "somebody's own";
  for (const fs::path& out : {there, made}) {
    try {
      FindingsFolder findings(out);
      findings.write("diagnosis.json", "{}");
      EXPECT_TRUE(fs::exists(out / "diagnosis.json"));
      throw std::runtime_error("interrupted");
    } catch (const std::runtime_error&) {
      EXPECT_FALSE(fs::exists(out / "diagnosis.json"));
    }
  }
  EXPECT_TRUE(fs::exists(there / "notes.txt"));
  EXPECT_FALSE(fs::exists(made)) << "a folder that was made for it";
}

TEST(FindingsFolder, StayWhereTheyAreWhole) {
  const TemporaryFolder folder;
  {
    FindingsFolder findings(folder.path() / "out");
    findings.write("summary.txt", "no effect is missing\n");
    findings.keep();
  }
  EXPECT_EQ(fs::file_size(folder.path() / "out/summary.txt"), 21u);
}

}  // namespace
}  // namespace slewlab::tools
