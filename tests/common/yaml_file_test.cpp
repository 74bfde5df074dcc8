#include "common/yaml_file.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <filesystem>
#include <fstream>

#include "common/utf8_text.h"

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

TEST_F(YamlFile, AMistypedIncludeIsToldAloneAndTaken) {
  write("base.yaml", "a: 1\n");
  const auto file = write("top.yaml", "b: 2\nincluds: base.yaml\n");
  const YamlNode root = load(file);
  EXPECT_EQ(said(), file.string() + ":2:1: key 'includs': found a key that is not known here, expected 'include'");
  EXPECT_EQ(canonical_text(root), R"({"a":1,"b":2})");
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

// UTF-16 as an editor saves it, and a damaged file.
TEST_F(YamlFile, BytesOfZeroAreNoText) {
  using namespace std::string_literals;
  load(write("wide.yaml", "\xFF\xFEk\0i\0n\0d\0:\0"s));
  load(write("damaged.yaml", "kind: crane\nboom: \0\0\n"s));
  ASSERT_EQ(problems_.size(), 2u);
  EXPECT_EQ(to_text(problems_[0]), (folder_ / "wide.yaml").string() + ":1:1: found a byte of zero, as in UTF-16 or in what is no text, expected text in UTF-8");
  EXPECT_EQ(problems_[1].where.line, 2);
}

// As an editor that saves in Latin-1 writes a degree sign. What is told of it is UTF-8.
TEST_F(YamlFile, TextThatIsNotUtf8IsRefusedAtItsLine) {
  load(write("latin.yaml", "kind: crane\nangle: {value: 53.5, unit: \xB0, source: a}\n"));
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_EQ(to_text(problems_[0]), (folder_ / "latin.yaml").string() + ":2:28: key 'angle.unit': found \xEF\xBF\xBD, which is not UTF-8, expected text in UTF-8");
  problems_.clear();
  load(write("escape.yaml", "kind: \"\\\xB0\"\n"));
  ASSERT_EQ(problems_.size(), 1u);
  EXPECT_TRUE(is_utf8(to_text(problems_[0]))) << to_text(problems_[0]);
}

TEST_F(YamlFile, AnExcerptEndsBetweenCharacters) {
  std::string degrees;
  for (int i = 0; i < 40; ++i) degrees += "\xC2\xB0";
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.scalar = "a" + degrees;
  EXPECT_TRUE(is_utf8(excerpt(node))) << excerpt(node);
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

TEST_F(YamlFile, OverrideWithItsUnitNamesTheCommandLineAsSource) {
  const auto file = write("a.yaml", "load:\n  mass: {value: 30, unit: t, source: thesis}\n");
  const YamlNode root = load(file, {"load.mass=20 t"});
  EXPECT_TRUE(problems_.empty()) << said();
  const YamlNode* mass = root.find("load")->find("mass");
  EXPECT_EQ(mass->find("value")->scalar, "20");
  EXPECT_EQ(mass->find("unit")->scalar, "t");
  EXPECT_EQ(mass->find("source")->scalar, "command line");
}

// A message that speaks of kilograms beside a file in tonnes has made 60 000 t of 60 t.
TEST_F(YamlFile, ABareNumberForAValueThatTheFileGivesInAnotherUnitThanSiIsRefused) {
  const auto file = write("a.yaml", "load:\n  mass: {value: 30, unit: t, source: thesis}\n"
                                    "widths: {value: [1, 2], unit: mm, source: thesis}\n");
  load(file, {"load.mass=60000"});
  EXPECT_EQ(said(), "--set load.mass=60000: key 'load.mass': found 60000 without a unit, "
                    "expected the number with its unit, \"60000 t\" or \"60000 kg\"");
  problems_.clear();
  load(file, {"widths=[3, 4]"});
  EXPECT_EQ(said(), "--set widths=[3, 4]: key 'widths': found [3, 4] without a unit, "
                    "expected {value: [3, 4], unit: mm}");
}

TEST_F(YamlFile, ANumberWithItsUnitReplacesBoth) {
  const auto file = write("a.yaml", "load:\n  mass: {value: 30, unit: t, source: thesis}\n");
  for (const char* text : {"load.mass=60000 kg", "load.mass=60000kg", "load.mass={value: 60000, unit: kg}"}) {
    const YamlNode root = load(file, {text});
    EXPECT_TRUE(problems_.empty()) << said();
    const YamlNode* mass = root.find("load")->find("mass");
    EXPECT_EQ(mass->find("value")->scalar, "60000") << text;
    EXPECT_FALSE(mass->find("value")->quoted);
    EXPECT_EQ(mass->find("unit")->scalar, "kg") << text;
    EXPECT_EQ(mass->find("source")->scalar, "command line");
  }
}

TEST_F(YamlFile, ABareNumberIsTakenWhereTheFileSpeaksSi) {
  const auto file = write("a.yaml", "duration: {value: 30, unit: s, source: x}\nshare: {value: 0.1, unit: '-', source: x}\n"
                                    "shape: {value: linear, source: x}\n");
  const YamlNode root = load(file, {"duration=10", "share=0.2", "shape=s_curve"});
  EXPECT_TRUE(problems_.empty()) << said();
  EXPECT_EQ(root.find("duration")->find("value")->scalar, "10");
  EXPECT_EQ(root.find("share")->find("value")->scalar, "0.2");
  EXPECT_EQ(root.find("shape")->find("value")->scalar, "s_curve");
}

TEST_F(YamlFile, ASecondDocumentIsRefused) {
  const auto file = write("a.yaml", "kind: crane\n---\nkind: controller\n");
  load(file);
  EXPECT_EQ(said(), file.string() + ":2:1: found a second YAML document (behind ---), expected one document in a file");
}

TEST_F(YamlFile, OneDocumentMayBeginAndEndWithItsMarks) {
  load(write("a.yaml", "---\nkind: crane\n...\n"));
  EXPECT_TRUE(problems_.empty()) << said();
}

TEST_F(YamlFile, AFileThatIsTooLargeIsRefusedBeforeItIsRead) {
  const auto file = write("a.yaml", "kind: crane\n");
  std::filesystem::resize_file(file, 50'000'000);
  load(file);
  EXPECT_EQ(said(), file.string() + ": found '" + file.string() + "', with which the input has 1 file(s) and 50 MB, "
                    "expected at most 1000 files and 32 MB with all includes");
}

// Twenty files that each include the next one twice: a million files.
TEST_F(YamlFile, IncludesThatMultiplyAreRefused) {
  for (int i = 0; i < 20; ++i) {
    const std::string next = std::to_string(i + 1) + ".yaml";
    write(std::to_string(i) + ".yaml", std::string("include: [").append(next).append(", ").append(next).append("]\n"));
  }
  write("20.yaml", "a: 1\n");
  load(folder_ / "0.yaml");
  ASSERT_EQ(problems_.size(), 1u) << said();
  EXPECT_NE(said().find("with which the input has 1001 file(s)"), std::string::npos) << said();
}

// Looking every key up among those before it takes the square of their number: 200 000 keys a quarter of an hour, which
// the limit of the test ends.
TEST_F(YamlFile, TimeGrowsWithTheNumberOfKeysAndNotWithItsSquare) {
  std::string base;
  std::string top = "include: base.yaml\n";
  constexpr int kKeys = 200'000;
  for (int i = 0; i < kKeys; ++i) {
    base += "key" + std::to_string(i) + ": 1\n";
    top += "key" + std::to_string(i) + ": 2\n";
  }
  write("base.yaml", base);
  const YamlNode root = load(write("a.yaml", top));
  EXPECT_TRUE(problems_.empty()) << problems_.size();
  ASSERT_EQ(root.entries.size(), static_cast<std::size_t>(kKeys));
  EXPECT_EQ(root.entries.back().value.scalar, "2");
}

TEST_F(YamlFile, AnOverrideByNothingTakesAValueAway) {
  const auto file = write("a.yaml", "mass: {value: 30, unit: t, source: x}\nrope: {value: 60, unit: m, source: x}\n");
  const YamlNode root = load(file, {"mass=null"});
  EXPECT_TRUE(problems_.empty()) << said();
  EXPECT_EQ(root.find("mass")->kind, YamlNode::Kind::null);
  EXPECT_EQ(root.find("rope")->kind, YamlNode::Kind::map);
}

// Of 300 000 moves of an operator: a node holds its place and its text, not the name of its file.
TEST_F(YamlFile, ALongListTakesSomeHundredBytesPerNode) {
#ifdef SLEWLAB_SANITIZED
  GTEST_SKIP() << "a sanitizer's heap is its own";
#endif
  constexpr int kMoves = 20'000, kNodes = 5 * kMoves;  // a map, its time's map and the three values in it
  std::string text = "moves:\n";
  for (int i = 0; i < kMoves; ++i) text += "  - time: {value: " + std::to_string(i) + ", unit: s, source: drawn}\n";
  const auto file = write(std::string(200, 'a') + ".yaml", text);
  const std::size_t before = ::mallinfo2().uordblks;
  const YamlNode root = load(file);
  const double per_node = static_cast<double>(::mallinfo2().uordblks - before) / kNodes;
  ASSERT_EQ(root.find("moves")->items.size(), static_cast<std::size_t>(kMoves)) << said();
  EXPECT_LT(per_node, 500.0);
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

// A key or value with an escape sequence is shown; a terminal does not obey it.
TEST_F(YamlFile, ControlCharactersOfAKeyOrAValueAreTold) {
  const InputProblem problem{{"a\x1b[1m.yaml", 3, 1}, "gear\x1b[31mbox", "'\a'", "one of a\tb"};
  EXPECT_EQ(to_text(problem), "a\\x1b[1m.yaml:3:1: key 'gear\\x1b[31mbox': found '\\x07', expected one of a\\x09b");
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
