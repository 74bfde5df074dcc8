#include "tools/commands/output_folder.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/input_error.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, AFileInTheWayIsRefusedAndNothingIsMade) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  make_output_folder(folder.path() / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder.path() / "a" / "b"));
  EXPECT_THROW(make_output_folder(folder.path() / "file"), common::InputError);
  EXPECT_THROW(make_output_folder(folder.path() / "file" / "c"), common::InputError);
}

TEST(OutputFolder, AFileToBeWrittenIsNoFolderAndGetsOne) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  make_folder_of("");
  make_folder_of("name_alone.csv");
  make_folder_of(folder.path() / "file");  // is written anew
  make_folder_of(folder.path() / "made" / "bode.csv");
  EXPECT_TRUE(fs::is_directory(folder.path() / "made"));
  for (const char* wrong : {"made", "nowhere/", "file/bode.csv"}) {
    EXPECT_THROW(make_folder_of(folder.path() / wrong, "--bode"), common::InputError) << wrong;
  }
  EXPECT_FALSE(fs::exists(folder.path() / "nowhere"));
}

}  // namespace
}  // namespace slewlab::tools
