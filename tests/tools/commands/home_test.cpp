// The programs carry no folder of the machine that built them: what lies beside them is found from where they are.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kPrograms = SLEWLAB_BINARY_DIR "/bin/";

TEST(Home, NoFolderOfThisMachineIsBuiltIntoThePrograms) {
#ifdef SLEWLAB_SANITIZED
  GTEST_SKIP() << "the sanitizers' reports name source files";
#endif
  for (const char* name : {"slewlab", "slewlab-plant", "slewlab-controller"}) {
    std::ifstream file(kPrograms + name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    ASSERT_GT(bytes.size(), 100'000u) << name;
    for (const char* folder : {SLEWLAB_SOURCE_DIR, SLEWLAB_BINARY_DIR}) {
      EXPECT_EQ(bytes.find(folder), std::string::npos) << name << " holds " << folder;
    }
  }
}

// A soak of one task needs config/soak, the crane and the controller, none of which it is told.
int soak(const fs::path& program, const fs::path& out, std::string& complaints) {
  RunningProgram run({program.string(), "soak", "--seed", "1", "--task", "0", "--set", "task.duration=18", "--out", out.string()});
  const int code = run.wait_for_end();
  complaints = run.complaints();
  return code;
}

TEST(Home, AnInstalledProgramFindsWhatWasInstalledWithIt) {
  const TemporaryFolder folder;
  const fs::path prefix = folder.path() / "prefix";
  RunningProgram install({CMAKE_COMMAND, "--install", SLEWLAB_BINARY_DIR, "--component", "programs", "--prefix", prefix.string()});
  ASSERT_EQ(install.wait_for_end(), 0) << install.complaints();
  const fs::path moved = folder.path() / "elsewhere";
  fs::rename(prefix, moved);
  std::string complaints;
  EXPECT_EQ(soak(moved / "bin" / "slewlab", folder.path() / "a", complaints), 0) << complaints;

  fs::remove_all(moved / "share" / "slewlab" / "config");
  EXPECT_NE(soak(moved / "bin" / "slewlab", folder.path() / "b", complaints), 0);
  EXPECT_NE(complaints.find("name their folder in SLEWLAB_HOME"), std::string::npos) << complaints;
  ::setenv("SLEWLAB_HOME", SLEWLAB_SOURCE_DIR, 1);
  EXPECT_EQ(soak(moved / "bin" / "slewlab", folder.path() / "c", complaints), 0) << complaints;
  ::setenv("SLEWLAB_HOME", "/nowhere", 1);
  EXPECT_NE(soak(moved / "bin" / "slewlab", folder.path() / "d", complaints), 0);
  EXPECT_NE(complaints.find("SLEWLAB_HOME is /nowhere, which does not hold config and tools/python"), std::string::npos) << complaints;
  ::unsetenv("SLEWLAB_HOME");
}

}  // namespace
}  // namespace slewlab::tools
