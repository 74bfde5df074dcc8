// Generic code asks effects for their traits and knows none by name: no source outside the catalogues holds the name of an
// effect as a text, and an effect's own source no other's. The laws of the evaluation do, as the answers that they are.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "controller/effects/catalogue.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {
namespace {

// What writes effects by their names: a machine's friction as a bearing's, and the laws of an axis' torque balance.
const std::set<std::string, std::less<>> kWriters{"sim/effects/bearing_friction.h", "sim/effects/balance_effects.cpp"};

// Names of effects that are also keys of machine files, of run.json or of soaks, faults or families.
const std::set<std::string, std::less<>> kOrdinaryWords{"boom_angle", "hoisting", "rope_length", "torque_limit", "wind", "droop", "speed_filter"};

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (const sim::EffectDescription* effect : sim::effect_catalogue()) names.emplace_back(effect->about.name);
  for (const controller::ControllerEffect* effect : controller::effect_catalogue()) names.emplace_back(effect->about.name);
  std::erase_if(names, [](const std::string& name) { return kOrdinaryWords.contains(name); });
  return names;
}

std::vector<std::string> named_in(const std::string& text, const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& name : names) {
    for (const char quote : {'"', '\''}) {
      if (text.find(quote + name + quote) != std::string::npos) found.push_back(name);
    }
  }
  return found;
}

TEST(EffectNames, StandInNoGenericSource) {
  const std::vector<std::string> names = effect_names();
  const std::filesystem::path source = SLEWLAB_SOURCE_DIR;
  int files = 0;
  for (const char* room : {"common", "msgs", "controller", "sim", "diagnosis", "tools"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / room)) {
      const std::set<std::string> kinds{".h", ".cpp", ".py"};
      const std::string file = std::filesystem::relative(entry.path(), source).string();
      if (!kinds.contains(entry.path().extension().string()) || kWriters.contains(file) || file.starts_with("diagnosis/evaluation/laws_")) {
        continue;
      }
      ++files;
      std::ifstream stream(entry.path());
      std::ostringstream text;
      text << stream.rdbuf();
      const bool is_effect = file.starts_with("sim/effects/") || file.starts_with("controller/effects/");
      for (const std::string& name : named_in(text.str(), names)) {
        if (is_effect && entry.path().stem() == name) continue;
        ADD_FAILURE() << file << " knows the effect " << name << " by its name";
      }
    }
  }
  EXPECT_GT(files, 100);
}

TEST(EffectNames, WouldBeNoticed) {
  EXPECT_EQ(named_in("if (effect == \"command_delay\")", effect_names()), std::vector<std::string>{"command_delay"});
  EXPECT_EQ(named_in("kind = 'gusts'", effect_names()), std::vector<std::string>{"gusts"});
  EXPECT_TRUE(named_in("// gusts, command_delay", effect_names()).empty());
}

}  // namespace
}  // namespace slewlab::diagnosis
