#include "common/yaml_node.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "common/utf8_text.h"

namespace slewlab::common {

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const YamlEntry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

YamlNode* YamlNode::find(std::string_view key) {
  return const_cast<YamlNode*>(static_cast<const YamlNode*>(this)->find(key));
}

bool is_sourced_value(const YamlNode& node) {
  return node.kind == YamlNode::Kind::map && node.find("value") != nullptr;
}

bool parse_number(std::string_view text, double& number) {
  const std::string_view unsigned_text =
      !text.empty() && (text[0] == '+' || text[0] == '-') ? text.substr(1) : text;
  const double sign = !text.empty() && text[0] == '-' ? -1.0 : 1.0;
  if (unsigned_text == ".nan" || unsigned_text == ".NaN" || unsigned_text == ".NAN") {
    number = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (unsigned_text == ".inf" || unsigned_text == ".Inf" || unsigned_text == ".INF") {
    number = sign * std::numeric_limits<double>::infinity();
    return true;
  }
  if (unsigned_text.empty()) return false;
  const char first = unsigned_text[0];
  const bool starts_like_a_number = (first >= '0' && first <= '9') || first == '.';
  if (!starts_like_a_number) return false;
  double magnitude = 0.0;
  const char* const end = unsigned_text.data() + unsigned_text.size();
  const auto [stop, error] = std::from_chars(unsigned_text.data(), end, magnitude);
  if (stop != end) return false;
  if (error == std::errc::result_out_of_range) {
    number = sign * std::numeric_limits<double>::infinity();
    return true;
  }
  if (error != std::errc()) return false;
  number = sign * magnitude;
  return true;
}

std::string shortest(double number) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return std::string(buffer.data(), result.ptr);
}

std::string quantity_text(std::string_view value, Unit unit, std::string_view source) {
  std::string text = "{value: ";
  text.append(value).append(", unit: \"").append(name_of(unit)).append("\", source: \"").append(source).append("\"}");
  return text;
}

std::string excerpt(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "nothing";
    case YamlNode::Kind::scalar: {
      constexpr std::size_t kLongest = 60;
      const std::string text =
          node.scalar.size() > kLongest ? std::string(first_characters(node.scalar, kLongest)) + "..." : node.scalar;
      return node.quoted ? '"' + text + '"' : text;
    }
    case YamlNode::Kind::sequence:
      return "a list of " + std::to_string(node.items.size());
    case YamlNode::Kind::map: {
      if (node.entries.empty()) return "an empty map";
      std::string text = "a map with the keys";
      constexpr std::size_t kMost = 6;
      for (std::size_t i = 0; i < std::min(kMost, node.entries.size()); ++i) {
        text += (i == 0 ? " " : ", ") + node.entries[i].key;
      }
      if (node.entries.size() > kMost) text += ", ...";
      return text;
    }
  }
  return "";
}

namespace {

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char character : text) {
    if (character == '"' || character == '\\') result += '\\';
    if (character == '\n') {
      result += "\\n";
    } else {
      result += character;
    }
  }
  return result + '"';
}

void append_canonical(const YamlNode& node, std::string& text) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      text += "null";
      return;
    case YamlNode::Kind::scalar: {
      double number = 0.0;
      if (!node.quoted && parse_number(node.scalar, number)) {
        text += shortest(number);
      } else {
        text += in_quotes(node.scalar);
      }
      return;
    }
    case YamlNode::Kind::sequence: {
      text += '[';
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        if (i > 0) text += ',';
        append_canonical(node.items[i], text);
      }
      text += ']';
      return;
    }
    case YamlNode::Kind::map: {
      std::vector<const YamlEntry*> sorted;
      for (const YamlEntry& entry : node.entries) {
        if (entry.key == "source" || entry.key == "description") continue;
        if (entry.value.kind == YamlNode::Kind::null) continue;
        sorted.push_back(&entry);
      }
      std::sort(sorted.begin(), sorted.end(),
                [](const YamlEntry* a, const YamlEntry* b) { return a->key < b->key; });
      text += '{';
      for (std::size_t i = 0; i < sorted.size(); ++i) {
        if (i > 0) text += ',';
        text += in_quotes(sorted[i]->key) + ':';
        append_canonical(sorted[i]->value, text);
      }
      text += '}';
      return;
    }
  }
}

}  // namespace

std::string canonical_text(const YamlNode& node) {
  std::string text;
  append_canonical(node, text);
  return text;
}

}  // namespace slewlab::common
