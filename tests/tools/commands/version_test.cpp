#include "tools/commands/version.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace slewlab::tools {
namespace {

// Slewlab's own stands in CMakeLists.txt alone; SUNDIALS's is what CMake found.
TEST(Version, IsThatOfTheProjectAndOfItsLibraries) {
  std::ifstream file(SLEWLAB_SOURCE_DIR "/CMakeLists.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::smatch own;
  ASSERT_TRUE(std::regex_search(text, own, std::regex(R"(project\(slewlab VERSION (\d+\.\d+\.\d+) )")));
  const std::regex form("slewlab " + own[1].str() + R"(\nLCM 1\.\d+\.\d+\nSUNDIALS )" SUNDIALS_PACKAGE ".*");
  EXPECT_TRUE(std::regex_match(version_text(), form)) << version_text();
}

}  // namespace
}  // namespace slewlab::tools
