#include "common/yaml_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "common/yaml_file.h"

namespace slewlab::common {
namespace {

// Reads `text` as the file crane.yaml and answers with all that was said about it.
template <typename Read>
std::string complaints(const std::string& text, Read read) {
  InputProblems problems;
  const YamlNode root = parse_yaml_text(text, "crane.yaml", problems);
  YamlReader reader(root, "", problems);
  read(reader);
  reader.finish();
  return InputError(problems).what();
}

std::string complaints_about_mass(const std::string& text) {
  return complaints(text, [](YamlReader& reader) {
    YamlReader load = reader.map("load");
    load.number("mass", Unit::kilogram, positive());
    load.finish();
  });
}

TEST(YamlReader, ConvertsToSi) {
  InputProblems problems;
  const YamlNode root = parse_yaml_text(
      "mass: {value: 30, unit: t, source: thesis}\nangle: {value: 180, unit: deg, source: thesis}\n"
      "widths: {value: [1, 2.5], unit: mm, source: thesis}\ncount: {value: 6, unit: '-', source: thesis}\n"
      "on: {value: true, source: thesis}\n",
      "crane.yaml", problems);
  YamlReader reader(root, "", problems);
  EXPECT_DOUBLE_EQ(reader.number("mass", Unit::kilogram, positive()), 30e3);
  EXPECT_DOUBLE_EQ(reader.number("angle", Unit::radian, any_number()), std::numbers::pi);
  EXPECT_EQ(reader.numbers("widths", Unit::metre, positive(), 2, 2), (std::vector<double>{1e-3, 2.5e-3}));
  EXPECT_EQ(reader.integer("count", 0, 10), 6);
  EXPECT_TRUE(reader.flag("on"));
  EXPECT_FALSE(reader.optional_number("absent", Unit::second, positive()).has_value());
  reader.finish();
  EXPECT_TRUE(problems.empty()) << InputError(problems).what();
}

TEST(YamlReader, UnknownKeyWithTheNearestName) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 1, unit: kg, source: s}\n  mas: 3\n"),
            "crane.yaml:3:3: key 'load.mas': found a key that is not known here, expected 'mass' (or one of mass)");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 1, unit: kg, source: s}\nweather: 3\n"),
            "crane.yaml:3:1: key 'weather': found a key that is not known here, expected one of load");
}

TEST(YamlReader, MissingKey) {
  EXPECT_EQ(complaints_about_mass("load: {}\n"),
            "crane.yaml:1:7: key 'load.mass': found nothing: the key is missing, expected a number above 0 kg");
}

TEST(YamlReader, MissingMapIsSaidOnce) {
  EXPECT_EQ(complaints_about_mass("{}\n"),
            "crane.yaml:1:1: key 'load': found nothing: the key is missing, expected a map of keys and values");
}

TEST(YamlReader, MapOfAnotherType) {
  EXPECT_EQ(complaints_about_mass("load: heavy\n"),
            "crane.yaml:1:7: key 'load': found heavy, expected a map of keys and values");
}

TEST(YamlReader, WrongType) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: heavy, unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found heavy, expected a number above 0 kg");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: '5', unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found \"5\", expected a number above 0 kg");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: [5], unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found a list of 1, expected a number above 0 kg");
}

TEST(YamlReader, NegativeMass) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: -3, unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found -3 kg, expected a number above 0 kg");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: -3, unit: t, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found -3 t, expected a number above 0 t");
}

// Found and allowed stand in the unit that the user wrote: a right angle is 90 deg.
TEST(YamlReader, LimitsAreInTheUnitOfTheFile) {
  InputProblems problems;
  const YamlNode root = parse_yaml_text("angle: {value: 153.5, unit: deg, source: s}\nlength: {value: 46.6 m, unit: m, source: s}\n", "crane.yaml", problems);
  YamlReader reader(root, "", problems);
  reader.number("angle", Unit::radian, between(0.0, 1.5707963267948966));
  reader.number("length", Unit::metre, positive());
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(to_text(problems[0]), "crane.yaml:1:16: key 'angle': found 153.5 deg, expected a number from 0 to 90 deg");
  EXPECT_EQ(to_text(problems[1]), "crane.yaml:2:17: key 'length': found 46.6 m, expected 46.6 alone: its unit stands under 'unit'");
}

TEST(YamlReader, NotANumberAndInfinity) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: .nan, unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found .nan, expected a number above 0 kg");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: .inf, unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found .inf, expected a number above 0 kg");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 1e999, unit: kg, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found 1e999, expected a number above 0 kg");
}

TEST(YamlReader, MixedUnits) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, unit: kN, source: s}\n"),
            "crane.yaml:2:26: key 'load.mass': found the unit 'kN', which measures something else, "
            "expected one of kg, t");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, unit: stone, source: s}\n"),
            "crane.yaml:2:26: key 'load.mass': found the unit 'stone', which is unknown, expected one of kg, t");
}

TEST(YamlReader, MissingUnitAndMissingSource) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, source: s}\n"),
            "crane.yaml:2:9: key 'load.mass': found 3 without a unit, expected unit: one of kg, t");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, unit: kg}\n"),
            "crane.yaml:2:9: key 'load.mass': found 3 without a source, "
            "expected source: the thesis's table or equation, a data sheet, or \"chosen: why\"");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: 3\n"),
            "crane.yaml:2:9: key 'load.mass': found 3, expected {value: a number, unit: kg, source: ...}");
}

TEST(YamlReader, UnknownKeyBesideValueAndUnit) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, unit: kg, source: s, untit: kg}\n"),
            "crane.yaml:2:41: key 'load.mass': found the unknown key 'untit', "
            "expected 'unit' (or one of value, unit, spread, source)");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 3, unit: kg, source: s, tolerance: 10 %}\n"),
            "crane.yaml:2:41: key 'load.mass': found the unknown key 'tolerance', "
            "expected {value: a number, unit: kg, source: ...}");
}

TEST(YamlReader, ADecimalCommaIsToldAsOne) {
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 60,5, unit: t, source: s}\n"),
            "crane.yaml:2:17: key 'load.mass': found 60,5, expected a decimal point, 60.5");
  EXPECT_EQ(complaints_about_mass("load:\n  mass: {value: 60, unit: ',5 t', source: s}\n"),  // as --set takes "60,5 t" apart
            "crane.yaml:2:17: key 'load.mass': found 60,5 t, expected a decimal point, 60.5 t");
}

TEST(YamlReader, WholeNumbers) {
  const auto read = [](YamlReader& reader) { reader.integer("groups", 1, 8); };
  EXPECT_EQ(complaints("groups: {value: 2.5, unit: '-', source: s}\n", read),
            "crane.yaml:1:17: key 'groups': found 2.5, expected a whole number from 1 to 8");
  EXPECT_EQ(complaints("groups: {value: 9, unit: '-', source: s}\n", read),
            "crane.yaml:1:17: key 'groups': found 9, expected a whole number from 1 to 8");
}

// A limit that follows from a machine's scales has as many digits as a double has.
TEST(YamlReader, ALimitIsToldInSixDigits) {
  const auto read = [](YamlReader& reader) { reader.number("lag", Unit::second, between(0.0, 0.50001210826349)); };
  EXPECT_EQ(complaints("lag: {value: 2, unit: s, source: s}\n", read),
            "crane.yaml:1:14: key 'lag': found 2 s, expected a number from 0 to 0.500012 s");
}

TEST(YamlReader, Choices) {
  const auto read = [](YamlReader& reader) { reader.choice("shape", {"s_curve", "linear"}); };
  EXPECT_EQ(complaints("shape: {value: round, source: s}\n", read),
            "crane.yaml:1:16: key 'shape': found round, expected s_curve or linear");
}

TEST(YamlReader, Lists) {
  const auto read = [](YamlReader& reader) { reader.numbers("widths", Unit::metre, positive(), 2, 3); };
  EXPECT_EQ(complaints("widths: {value: [1], unit: m, source: s}\n", read),
            "crane.yaml:1:17: key 'widths': found a list of 1, expected a list of 2 to 3 numbers");
  EXPECT_EQ(complaints("widths: {value: [1, -2], unit: m, source: s}\n", read),
            "crane.yaml:1:21: key 'widths': found -2 m, expected a number above 0 m");
}

TEST(YamlReader, AllProblemsOfAFileAtOnce) {
  const std::string said = complaints_about_mass("load:\n  mass: {value: -1, unit: kg}\n  rope: 2\nwind: 3\n");
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 3) << said;
}

}  // namespace
}  // namespace slewlab::common
