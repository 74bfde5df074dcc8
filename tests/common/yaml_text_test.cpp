#include "common/yaml_text.h"

#include <gtest/gtest.h>

#include <fstream>

#include "common/yaml_file.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::common {
namespace {

// Words that YAML would read as something else, text of several lines, lists and maps within maps come back as they were.
TEST(YamlText, ReadsBackAsTheSameTree) {
  InputProblems problems;
  const YamlNode root = parse_yaml_text(
      "text: \"a: b # c\\n'd'\"\nnumber_as_text: '12'\nnothing: null\ndash: '-'\nempty: {}\nlist: [1, 2.5, x]\n"
      "mass: {value: 30, unit: t, source: \"a, b\"}\nmoves:\n  - {at: 1}\n  - at: 2\n    how:\n      fast: true\n",
      "a.yaml", problems);
  const YamlNode again = parse_yaml_text(yaml_text(root), "b.yaml", problems);
  ASSERT_TRUE(problems.empty()) << InputError(problems).what();
  EXPECT_EQ(canonical_text(again), canonical_text(root));
}

TEST(YamlText, HoldsWhatTheFileIncludes) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "base.yaml") << "load: {mass: 3, rope: 4}\nboom: 5\n";
  std::ofstream(folder.path() / "own.yaml") << "include: base.yaml\nload: {mass: 6}\nboom: null\n";
  InputProblems problems;
  const std::string text = yaml_text(load_yaml_file(folder.path() / "own.yaml", {}, problems));
  const YamlNode alone = parse_yaml_text(text, "alone.yaml", problems), meant = parse_yaml_text("load: {mass: 6, rope: 4}", "meant.yaml", problems);
  ASSERT_TRUE(problems.empty()) << InputError(problems).what();
  EXPECT_EQ(canonical_text(alone), canonical_text(meant)) << text;
}

}  // namespace
}  // namespace slewlab::common
