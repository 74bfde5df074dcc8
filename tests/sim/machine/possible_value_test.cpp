#include "sim/machine/possible_value.h"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>

#include "common/yaml_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::sim {
namespace {

using common::Unit;

struct Read {
  double value = 0.0;
  std::optional<double> optional;
  std::string problem;  // of either
};

Read read(const std::string& torque) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "file.yaml";
  std::ofstream(path) << "first: {value: 1, unit: m, source: test}\ntorque: {value: " << torque << ", unit: kN m, source: test}\n";
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(path, {}, problems);
  common::YamlReader reader(root, "", problems);
  Read found;
  found.value = sized(reader, "torque", Unit::newton_metre, common::any_number(), kTorque);
  found.optional = optional_sized(reader, "torque", Unit::newton_metre, common::any_number(), kTorque);
  if (!problems.empty()) found.problem = common::InputError(problems).what();
  return found;
}

// 1e12 N m are 1e9 kN m; of either sign.
TEST(PossibleValue, WhatNoMachineHasIsToldWithItsPlaceAndWhatWouldBeRight) {
  EXPECT_EQ(read("-1e9").problem, "");
  EXPECT_EQ(read("-1e9").value, -1e12);
  EXPECT_EQ(read("0").problem, "");
  const std::string above = read("2e9").problem;
  EXPECT_NE(above.find("file.yaml:2:"), std::string::npos) << above;
  EXPECT_NE(above.find("torque"), std::string::npos) << above;
  EXPECT_NE(above.find("2e+12 N m, which no machine has"), std::string::npos) << above;
  EXPECT_NE(above.find("from 1e-09 to 1e+12 N m"), std::string::npos) << above;
  EXPECT_NE(read("-2e9").problem.find("or as much below 0"), std::string::npos) << read("-2e9").problem;
  EXPECT_NE(read("1e-13").problem, "");
}

TEST(PossibleValue, AnAbsentNumberIsNone) {
  common::InputProblems problems;
  const common::YamlNode root;
  common::YamlReader reader(root, "", problems);
  const std::size_t before = problems.size();
  EXPECT_FALSE(optional_sized(reader, "torque", Unit::newton_metre, common::any_number(), kTorque));
  EXPECT_EQ(problems.size(), before);
  EXPECT_EQ(*read("3").optional, 3000.0);
}

}  // namespace
}  // namespace slewlab::sim
