#include "common/yaml_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace slewlab::common {

namespace {

// Whether the text needs no quotes.
bool plain(std::string_view text) {
  const auto harmless = [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '+' || c == '/' || c == '-';
  };
  const bool says_nothing = text == "null" || text == "Null" || text == "NULL";
  return !text.empty() && text != "-" && !says_nothing && std::all_of(text.begin(), text.end(), harmless);
}

std::string in_quotes(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      result += "\\x";
      result += kDigits[c >> 4];
      result += kDigits[c & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string scalar_text(const YamlNode& node) {
  return !node.quoted && plain(node.scalar) ? node.scalar : in_quotes(node.scalar);
}

std::string key_text(const std::string& key) { return plain(key) ? key : in_quotes(key); }

bool is_list_of_scalars(const YamlNode& node) {
  return node.kind == YamlNode::Kind::sequence &&
         std::all_of(node.items.begin(), node.items.end(),
                     [](const YamlNode& item) { return item.kind == YamlNode::Kind::scalar; });
}

// What may stand behind "key: " on the same line.
bool fits_line(const YamlNode& node) {
  return node.kind == YamlNode::Kind::scalar || node.kind == YamlNode::Kind::null || is_list_of_scalars(node) ||
         is_sourced_value(node) || (node.kind == YamlNode::Kind::map && node.entries.empty());
}

std::string line_text(const YamlNode& node) {
  std::string text;
  switch (node.kind) {
    case YamlNode::Kind::null: return "null";
    case YamlNode::Kind::scalar: return scalar_text(node);
    case YamlNode::Kind::sequence:
      for (const YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + line_text(item);
      return "[" + text + "]";
    case YamlNode::Kind::map:
      for (const auto& entry : node.entries) {
        text += (text.empty() ? "" : ", ") + key_text(entry.key) + ": " + line_text(entry.value);
      }
      return "{" + text + "}";
  }
  return text;
}

void write(const YamlNode& node, const std::string& indent, std::string& text) {
  if (node.kind == YamlNode::Kind::sequence) {
    for (const YamlNode& item : node.items) {
      if (fits_line(item)) {
        text += indent + "- " + line_text(item) + "\n";
      } else {
        std::string nested;
        write(item, indent + "  ", nested);
        nested[indent.size()] = '-';
        text += nested;
      }
    }
    return;
  }
  for (const auto& entry : node.entries) {
    if (fits_line(entry.value)) {
      text += indent + key_text(entry.key) + ": " + line_text(entry.value) + "\n";
    } else {
      text += indent + key_text(entry.key) + ":\n";
      write(entry.value, indent + "  ", text);
    }
  }
}

}  // namespace

std::string yaml_text(const YamlNode& node) {
  if (node.entries.empty() && node.items.empty()) return line_text(node) + "\n";
  std::string text;
  write(node, "", text);
  return text;
}

}  // namespace slewlab::common
