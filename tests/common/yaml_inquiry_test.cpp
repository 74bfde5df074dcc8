#include "common/yaml_inquiry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace slewlab::common {
namespace {

// A reader that takes other ways: a rotary axis has an inertia, a linear one a mass, and only without a travel a motor's mass.
void read_axis(YamlReader& reader) {
  reader.heading("axis");
  const bool is_linear = reader.choice("coordinate", {"rotary", "linear"}) == 1;
  if (is_linear) {
    reader.number("mass", Unit::kilogram, positive());
    if (!reader.optional_number("travel", Unit::metre, positive())) reader.number("motor_mass", Unit::kilogram, positive());
  } else {
    reader.number("inertia", Unit::kilogram_square_metre, positive());
  }
  if (reader.has("brake")) {
    YamlReader brake = reader.map("brake");
    brake.number("torque", Unit::newton_metre, not_negative());
    brake.optional_number("delay", Unit::second, not_negative());
    brake.finish();
  }
  reader.each("moves", [](YamlReader& move) {
    move.number("time", Unit::second, not_negative());
    if (move.has("stop")) move.flag("stop");
    move.finish();
  });
  reader.number("top_speed", is_linear ? Unit::metre_per_second : Unit::radian_per_second, positive());
  const std::vector<double> map = reader.numbers("map", Unit::none, between(0.0, 1.0), 2, 9);
  if (map.front() != 0.0) reader.report("map", "something else", "0 first");
  reader.finish();
}

class YamlInquiryTest : public testing::Test {
 protected:
  const KeyDescription* find(const std::string& path) const {
    const auto found = std::find_if(keys_.begin(), keys_.end(), [&](const KeyDescription& key) { return key.path == path; });
    return found == keys_.end() ? nullptr : &*found;
  }
  bool required(const std::string& path) const { return find(path)->is_required; }

  std::vector<KeyDescription> keys_ = describe_keys(read_axis);
};

TEST_F(YamlInquiryTest, FindsTheKeysOfEveryWay) {
  for (const char* path : {"kind", "description", "coordinate", "mass", "travel", "motor_mass", "inertia", "brake", "brake.torque",
                           "brake.delay", "moves", "moves.*.time", "moves.*.stop", "top_speed", "map"}) {
    EXPECT_NE(find(path), nullptr) << path;
  }
  EXPECT_EQ(keys_.size(), 15u);
}

TEST_F(YamlInquiryTest, KnowsWhatMustBeThere) {
  for (const char* path : {"kind", "coordinate", "map", "brake.torque", "moves.*.time"}) EXPECT_TRUE(required(path)) << path;
  for (const char* path : {"description", "mass", "travel", "motor_mass", "inertia", "brake", "brake.delay", "moves", "moves.*.stop"}) {
    EXPECT_FALSE(required(path)) << path;
  }
}

TEST_F(YamlInquiryTest, KnowsWhatAKeyMayHold) {
  EXPECT_EQ(find("kind")->choices, std::vector<std::string>{"axis"});
  EXPECT_EQ(find("coordinate")->choices, (std::vector<std::string>{"rotary", "linear"}));
  EXPECT_EQ(find("moves.*.stop")->choices, (std::vector<std::string>{"false", "true"}));
  EXPECT_EQ(find("brake.torque")->unit, Unit::newton_metre);
  EXPECT_TRUE(find("brake.torque")->other_units.empty());
  EXPECT_EQ(find("top_speed")->unit, Unit::radian_per_second);
  EXPECT_EQ(find("top_speed")->other_units, std::vector<Unit>{Unit::metre_per_second});
  EXPECT_TRUE(find("brake.torque")->range.lowest_allowed);
  EXPECT_FALSE(find("mass")->range.lowest_allowed);
  EXPECT_EQ(find("map")->kind, KeyDescription::Kind::numbers);
  EXPECT_EQ(find("map")->most, 9u);
}

}  // namespace
}  // namespace slewlab::common
