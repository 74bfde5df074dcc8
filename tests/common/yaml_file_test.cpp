#include "common/yaml_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace slewlab::common {
namespace {

class YamlFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("slewlab_yaml_file_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "below");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  YamlNode load(const std::filesystem::path& file, const std::vector<std::string>& options = {}) {
    std::vector<Override> overrides;
    for (const std::string& option : options) overrides.push_back(parse_override(option));
    return load_yaml_file(file, overrides, problems_);
  }
  std::string said() const { return InputError(problems_).what(); }

  std::filesystem::path folder_;
  InputProblems problems_;
};

TEST_F(YamlFile, KeepsFileLineAndColumnOfEveryNode) {
  const auto file = write("a.yaml", "kind: crane\nload:\n  mass: 3\n");
  const YamlNode root = load(file);
  const YamlNode* mass = root.find("load")->find("mass");
  EXPECT_EQ(mass->mark.file, file.string());
  EXPECT_EQ(mass->mark.line, 3);
  EXPECT_EQ(mass->mark.column, 9);
  EXPECT_TRUE(problems_.empty()) << said();
}

TEST_F(YamlFile, LaysAFileOverTheOneItIncludes) {
  write("below/base.yaml",
        "a: {value: 1, unit: m, source: base}\nb: {c: 1, d: 2}\nlist: [1, 2, 3]\ngone: {e: 1}\n");
  const auto file = write("top.yaml",
                          "include: below/base.yaml\na: {value: 5, unit: mm, source: top}\n"
                          "b: {d: 7}\nlist: [9]\ngone: null\n");
  const YamlNode root = load(file);
  EXPECT_TRUE(problems_.empty()) << said();
  EXPECT_EQ(canonical_text(root), R"({"a":{"unit":"mm","value":5},"b":{"c":1,"d":7},"list":[9]})");
  EXPECT_EQ(root.find("b")->find("c")->mark.line, 2);
  EXPECT_EQ(root.find("b")->find("d")->mark.file, file.string());
}

TEST_F(YamlFile, ShowsTheChainOfACircleOfIncludes) {
  write("b.yaml", "x: 1\ninclude: c.yaml\n");
  write("c.yaml", "include:\n  - a.yaml\n");
  load(write("a.yaml", "include: b.yaml\n"));
  ASSERT_EQ(problems_.size(), 1u) << said();
  EXPECT_EQ(said(), (folder_ / "c.yaml").string() +
                        ":2:5: key 'include': found a circle of includes: a.yaml -> b.yaml -> c.yaml -> a.yaml, "
                        "expected files that do not include themselves");
}

TEST_F(YamlFile, NamesAMissingIncludeWhereItIsNamed) {
  const auto file = write("a.yaml", "kind: crane\ninclude: nowhere.yaml\n");
  load(file);
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_EQ(said(), file.string() + ":2:10: key 'include': found '" + (folder_ / "nowhere.yaml").string() +
                        "', which cannot be read, expected the name of a readable file");
}

TEST_F(YamlFile, ReportsADuplicateKey) {
  const auto file = write("a.yaml", "drive:\n  mass: 1\n  ratio: 2\n  mass: 3\n");
  load(file);
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_EQ(said(), file.string() +
                        ":4:3: key 'drive.mass': found the key a second time, expected it once; "
                        "it stands in line 2 already");
}

TEST_F(YamlFile, ReportsWhatIsNotYaml) {
  const auto file = write("a.yaml", "a: 1\nb: [1, 2\nc: 3\n");
  load(file);
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_EQ(problems_[0].where.file, file.string());
  EXPECT_GE(problems_[0].where.line, 2);
  EXPECT_NE(said().find("well-formed YAML"), std::string::npos) << said();
}

TEST_F(YamlFile, RefusesAnchorsAndAliases) {
  load(write("a.yaml", "a: &x 1\nb: *x\n"));
  ASSERT_EQ(problems_.size(), 2u);
  EXPECT_NE(said().find("a.yaml:1:4: key 'a': found an anchor (&)"), std::string::npos) << said();
  EXPECT_NE(said().find("a.yaml:2:4: key 'b': found an alias (*)"), std::string::npos) << said();
}

TEST_F(YamlFile, RefusesAFileThatIsNoMap) {
  const auto file = write("a.yaml", "- 1\n- 2\n");
  load(file);
  EXPECT_EQ(said(), file.string() + ":1:1: found a list of 2, expected a map of keys and values");
}

TEST_F(YamlFile, RefusesAFileThatIsNotThere) {
  load(folder_ / "none.yaml");
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_NE(said().find("which cannot be read"), std::string::npos);
}

TEST_F(YamlFile, OverrideKeepsTheUnitAndNamesTheCommandLineAsSource) {
  const auto file = write("a.yaml", "load:\n  mass: {value: 30, unit: t, source: thesis}\n");
  const YamlNode root = load(file, {"load.mass=20"});
  EXPECT_TRUE(problems_.empty()) << said();
  const YamlNode* mass = root.find("load")->find("mass");
  EXPECT_EQ(mass->find("value")->scalar, "20");
  EXPECT_EQ(mass->find("unit")->scalar, "t");
  EXPECT_EQ(mass->find("source")->scalar, "command line");
}

TEST_F(YamlFile, OverrideReachesListsAndNewKeys) {
  const auto file = write("a.yaml", "moves:\n  - {time: 1}\n  - {time: 2}\n");
  const YamlNode root = load(file, {"moves.1.time=5", "effects.wind={speed: 3}"});
  EXPECT_TRUE(problems_.empty()) << said();
  EXPECT_EQ(canonical_text(root), R"({"effects":{"wind":{"speed":3}},"moves":[{"time":1},{"time":5}]})");
}

TEST_F(YamlFile, OverrideOutsideAListIsExplained) {
  load(write("a.yaml", "moves:\n  - {time: 1}\n"), {"moves.4.time=5"});
  EXPECT_EQ(said(),
            "--set moves.4.time=5: key 'moves.4.time': found '4' as a place in a list, "
            "expected a number from 0 to 0");
}

TEST_F(YamlFile, OverrideWithNamesThatNoFileHasIsExplained) {
  const auto file = write("a.yaml", "load: {mass: 1}\n");
  load(file, {"load..mass=2"});
  EXPECT_EQ(said(), "--set load..mass=2: key 'load..mass': found an empty name, expected names with a dot between each");
  problems_.clear();
  load(file, {std::string(1000, 'x') + "=1"});
  EXPECT_NE(said().find("found a key of 1000 characters, expected a name of at most 200"), std::string::npos) << said();
}

TEST_F(YamlFile, OverrideWithoutEqualsIsExplained) {
  try {
    parse_override("load.mass");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--set: found 'load.mass', expected key.path=value");
  }
}

TEST_F(YamlFile, CanonicalTextIgnoresOrderCommentsSourcesAndSpellingOfNumbers) {
  const YamlNode a = load(write("a.yaml", "# comment\nx: {value: 1.50, unit: m, source: one}\ny: 2e3\n"));
  const YamlNode b = load(write("b.yaml", "y: 2000\ndescription: other\nx: {source: two, unit: m, value: 1.5}\n"));
  EXPECT_EQ(canonical_text(a), canonical_text(b));
  const YamlNode c = load(write("c.yaml", "y: 2000.0000000000002\nx: {source: two, unit: m, value: 1.5}\n"));
  EXPECT_NE(canonical_text(a), canonical_text(c));
}

}  // namespace
}  // namespace slewlab::common
