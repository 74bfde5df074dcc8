// Who may know whom (design.md, "Rooms"): controller/ and sim/ never include each other, diagnosis/ uses both, nothing
// uses tools/, and LCM's own headers are msgs/' business alone. Reads the include lines of every source file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

const std::map<std::string, std::set<std::string>> kForbidden{
    {"common", {"msgs", "controller", "sim", "diagnosis", "tools", "lcm"}},
    {"msgs", {"controller", "sim", "diagnosis", "tools"}},
    {"controller", {"sim", "diagnosis", "tools", "lcm"}},
    {"sim", {"controller", "diagnosis", "tools", "lcm"}},
    {"diagnosis", {"tools", "lcm"}},
    {"tools", {"lcm"}},
};

// The rooms that a source text includes from, first folder of each include line.
std::vector<std::string> included_rooms(const std::string& text) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*["<]([^/">]+)/)");
  std::vector<std::string> rooms;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, kInclude)) rooms.push_back(match[1]);
  }
  return rooms;
}

std::vector<std::string> trespasses(const std::string& room, const std::string& text) {
  std::vector<std::string> found;
  for (const std::string& included : included_rooms(text)) {
    if (kForbidden.at(room).count(included) != 0) found.push_back(included);
  }
  return found;
}

TEST(Rooms, KeepToThemselves) {
  const std::filesystem::path source = SLEWLAB_SOURCE_DIR;
  int files = 0;
  for (const auto& [room, forbidden] : kForbidden) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      ++files;
      std::ifstream file(entry.path());
      std::ostringstream text;
      text << file.rdbuf();
      for (const std::string& other : trespasses(room, text.str())) {
        ADD_FAILURE() << entry.path() << " of " << room << "/ includes from " << other << "/";
      }
    }
  }
  EXPECT_GT(files, 100);
}

TEST(Rooms, ATrespassWouldBeNoticed) {
  EXPECT_EQ(trespasses("controller", "#include <cmath>\n  #  include \"sim/integrate/machine.h\"\n"),
            std::vector<std::string>{"sim"});
  EXPECT_EQ(trespasses("sim", "#include \"controller/ramp.h\"\n"), std::vector<std::string>{"controller"});
  EXPECT_EQ(trespasses("diagnosis", "#include <lcm/lcm-cpp.hpp>\n"), std::vector<std::string>{"lcm"});
  EXPECT_TRUE(trespasses("diagnosis", "#include \"sim/integrate/machine.h\"\n#include \"controller/ramp.h\"\n").empty());
}

}  // namespace
