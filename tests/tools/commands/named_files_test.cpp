// What of a shell command is a file.

#include "tools/commands/named_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

class NamedFilesTest : public testing::Test {
 protected:
  NamedFilesTest() {
    for (const char* name : {"controller.py", "gains.yaml", "with blank.py", "abc"}) std::ofstream(folder_.path() / name) << "abc";
  }
  std::string at(const char* name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

TEST_F(NamedFilesTest, AreTheProgramAndWhatItIsGiven) {
  EXPECT_EQ(files_named_by("/bin/sh " + at("controller.py")), (Files{"/bin/sh", at("controller.py")}));
  EXPECT_EQ(files_named_by("A=b exec /bin/sh '" + at("with blank.py") + "' --gains=" + at("gains.yaml") + " --speed 2 " + at("missing.py")),
            (Files{"/bin/sh", at("with blank.py"), at("gains.yaml")}));
  EXPECT_EQ(files_named_by("/bin/sh -c \"/bin/sh " + at("controller.py") + "\""), (Files{"/bin/sh", at("controller.py")}));
  EXPECT_EQ(files_named_by(""), Files{});
}

// The first word of every command of the line is looked for as the shell does, another word is not.
TEST_F(NamedFilesTest, ProgramsAreFoundInThePath) {
  const Files files = files_named_by("true sh && env X=1 sh abc; cd " + folder_.path().string());
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].filename(), "true");
  EXPECT_EQ(files[1].filename(), "env");
  EXPECT_EQ(files[2].filename(), "sh");
}

// FIPS 180-4: the digest of "abc".
TEST_F(NamedFilesTest, AreKnownByTheirDigest) {
  EXPECT_EQ(sha256_of_file(at("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace slewlab::tools
