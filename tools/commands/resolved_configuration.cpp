#include "tools/commands/resolved_configuration.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

#include "sim/drive/scenario_file.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::Override;
using common::YamlNode;

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
         common::is_sourced_value(node) || (node.kind == YamlNode::Kind::map && node.entries.empty());
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

YamlNode load(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  InputProblems problems;
  YamlNode node = common::load_yaml_file(file, overrides, problems);
  if (!problems.empty()) throw InputError(problems);
  return node;
}

void set_reference(YamlNode& root, std::string_view key, const char* file) {
  YamlNode* node = root.find(key);
  if (node == nullptr) return;
  node->scalar = file;
  node->quoted = false;
}

}  // namespace

std::string to_yaml(const YamlNode& node) {
  if (node.entries.empty() && node.items.empty()) return line_text(node) + "\n";
  std::string text;
  write(node, "", text);
  return text;
}

std::filesystem::path write_resolved_configuration(const std::filesystem::path& scenario_path,
                                                   const std::vector<Override>& overrides,
                                                   const std::filesystem::path& folder) {
  const sim::Scenario scenario = sim::load_scenario_file(scenario_path, overrides);
  std::vector<Override> own = overrides;
  for (const char* way : {"crane.", "axis.", "controller."}) common::take_overrides(way, own);  // laid over files of their own
  YamlNode root = load(scenario_path, own);
  const YamlNode crane = load(scenario.crane_file, scenario.crane_overrides);
  const YamlNode controller = load(scenario.controller_file, scenario.controller_overrides);
  const std::string machine = std::string(sim::name_of(scenario.crane.kind));
  set_reference(root, machine, (machine + ".yaml").c_str());
  set_reference(root, "controller", "controller.yaml");
  write_whole_file(folder / (machine + ".yaml"), to_yaml(crane));
  write_whole_file(folder / "controller.yaml", to_yaml(controller));
  write_whole_file(folder / "scenario.yaml", to_yaml(root));
  return folder / "scenario.yaml";
}

}  // namespace slewlab::tools
