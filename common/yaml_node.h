// A piece of YAML as a plain tree in which every node remembers the file, line and column it came from,
// so that trees of several files can be laid over each other and still be explained.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/unit.h"

namespace slewlab::common {

struct YamlEntry;

struct YamlNode {
  enum class Kind { null, scalar, sequence, map };

  Kind kind = Kind::null;
  std::string scalar;               // as written, without quotes
  bool quoted = false;              // a quoted scalar is text, never a number
  std::vector<YamlNode> items;      // of a sequence
  std::vector<YamlEntry> entries;   // of a map, in the order of the file
  SourceMark mark;

  const YamlNode* find(std::string_view key) const;
  YamlNode* find(std::string_view key);
};

struct YamlEntry {
  std::string key;
  SourceMark mark;
  YamlNode value;
};

// A value with unit and source stands in the file as {value: ..., unit: ..., source: ...}.
bool is_sourced_value(const YamlNode& node);

// Reads a whole number or a decimal one, also .nan and .inf, as YAML 1.2's core schema spells them.
// Returns false for anything else.
bool parse_number(std::string_view text, double& number);

// The shortest text that reads back as the same double.
std::string shortest(double number);

// A quantity as yaml_reader.h wants it: {value: 1.5, unit: "m", source: "data sheet"}. `value` is a number or a list's text.
std::string quantity_text(std::string_view value, Unit unit, std::string_view source);

// What the node holds, short enough for a message.
std::string excerpt(const YamlNode& node);

// The tree as text in which everything that does not change a run is gone: keys sorted, numbers in their
// shortest form, no comments, no sources, no descriptions. Equal text means equal configuration.
std::string canonical_text(const YamlNode& node);

}  // namespace slewlab::common
