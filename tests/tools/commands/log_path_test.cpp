#include "tools/commands/log_path.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/input_error.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

TEST(LogPath, IsTheFileOrTheLogOfARunsFolder) {
  const TemporaryFolder folder;
  EXPECT_THROW(log_in(folder.path()), common::InputError);
  std::ofstream(folder.path() / "run.lcmlog.partial") << "x";
  EXPECT_EQ(log_in(folder.path()), folder.path() / "run.lcmlog.partial");
  std::ofstream(folder.path() / "run.lcmlog") << "x";
  EXPECT_EQ(log_in(folder.path()), folder.path() / "run.lcmlog");
  EXPECT_EQ(log_in(folder.path() / "run.lcmlog.partial"), folder.path() / "run.lcmlog.partial");
  EXPECT_THROW(log_in("/nowhere/site.lcmlog"), common::InputError);
}

}  // namespace
}  // namespace slewlab::tools
