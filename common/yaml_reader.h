// Reads typed values out of a YAML tree and collects every problem with file, line, key, what was found
// and what is allowed.
//
// Form of a value in a file:
//   motor_torque_rated: {value: 400, unit: N m, source: "chosen: ..."}   number(), numbers()
//   mass: {value: 95, unit: kg, spread: 10 %, source: ...}   a number may say its spread: parse_share()
//   boom_elements: {value: 6, unit: "-", source: "thesis 4.2"}           integer()
//   shape: {value: s_curve, source: "thesis 4.5"}                        choice(), flag(): no unit
//   description: any text                                                text()
// A reader asked for a key that is missing or wrong records the problem and answers with a harmless value
// (0, the first choice, an empty list), so that one pass finds all problems. finish() reports the keys
// nobody asked for. What was read may only be used when `problems` is empty.
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/input_error.h"
#include "common/unit.h"
#include "common/yaml_node.h"

namespace slewlab::common {

// What a number may be, in SI.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_allowed = true;  // whether the lowest itself is allowed
};

constexpr Range any_number() { return {}; }
constexpr Range positive() { return {0.0, std::numeric_limits<double>::infinity(), false}; }
constexpr Range not_negative() { return {0.0, std::numeric_limits<double>::infinity(), true}; }
constexpr Range between(double lowest, double highest) { return {lowest, highest, true}; }

class YamlInquiry;

class YamlReader {
 public:
  // `path` is the key path of the node, empty for the root. Reports a node that is no map.
  YamlReader(const YamlNode& node, std::string path, InputProblems& problems);
  // Reads nothing: what is asked of it is noted (yaml_inquiry.h) and answered with values that are allowed.
  YamlReader(YamlInquiry& inquiry, std::string path);

  // Whether the key is there and not null. Counts as asked for.
  bool has(std::string_view key);

  double number(std::string_view key, Unit unit, Range range);
  std::optional<double> optional_number(std::string_view key, Unit unit, Range range);
  int integer(std::string_view key, int lowest, int highest);
  std::vector<double> numbers(std::string_view key, Unit unit, Range range, std::size_t fewest,
                              std::size_t most);
  bool flag(std::string_view key);
  // Answers with the index of the choice.
  std::size_t choice(std::string_view key, std::initializer_list<std::string_view> choices);
  std::string text(std::string_view key);
  std::string optional_text(std::string_view key);
  // What every file begins with: its kind, which must be this one, and perhaps a description.
  void heading(std::string_view kind);
  // A file named relative to the file in which the key stands.
  std::filesystem::path file(std::string_view key);

  // A map below the key; where it is missing or no map, a reader that answers everything quietly.
  YamlReader map(std::string_view key);
  // Hands every entry of a list of maps to `read`, one after the other; an absent key is an empty list.
  void each(std::string_view key, const std::function<void(YamlReader&)>& read);
  // A part kept as it is, for a reader elsewhere; nullptr where it is absent.
  const YamlNode* raw(std::string_view key);

  // Whether the last problem so far is one of this key: what was read in its place means nothing.
  bool is_told(std::string_view key) const;
  // Records a problem with the value of a key.
  void report(std::string_view key, std::string found, std::string expected);
  // Reports the keys that were not asked for.
  void finish();

  const YamlNode& node() const { return *node_; }

 private:
  // The unit as the file spells it, and its factor to SI.
  struct GivenUnit {
    std::string spelling = "-";
    double factor = 1.0;
  };

  const YamlNode* ask(std::string_view key);
  const YamlNode* need(std::string_view key, std::string_view expected);
  // The value of {value, unit, source} after its form was checked; nullptr after a problem.
  const YamlNode* sourced(const YamlNode& entry, std::string_view key, std::optional<Unit> unit,
                          const std::string& expected, GivenUnit& given);
  std::optional<double> read_number(const YamlNode& value, std::string_view key, Range range, const GivenUnit& given);
  std::string path_of(std::string_view key) const;
  void report_at(const SourceMark& mark, std::string_view key, std::string found, std::string expected);

  const YamlNode* node_;
  std::string path_;
  InputProblems* problems_;
  YamlInquiry* inquiry_ = nullptr;
  bool quiet_;  // stands in for a map that could not be read
  std::vector<std::string> asked_;
};

// A share above 0 and at most 1, as "10 %" or 0.1; nothing where the node holds none.
std::optional<double> parse_share(const YamlNode& node);

// The path that a file reference means: relative to the file in which it stands, or to the working
// directory where it was given on the command line.
std::filesystem::path resolve_path(const YamlNode& reference);

}  // namespace slewlab::common
