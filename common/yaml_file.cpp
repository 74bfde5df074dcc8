#include "common/yaml_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

namespace slewlab::common {
namespace {

// YAML's own limit for a key that stands before its colon is 1024; no name here comes near it.
constexpr std::size_t kLongestKey = 200;
constexpr std::ptrdiff_t kDeepest = 100;  // [names] in the path of a `--set`
const std::string kShorterName = "a name of at most " + std::to_string(kLongestKey) + " characters";

// Builds the tree from the parser's events. A frame is a map or list that is still open.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, InputProblems& problems) : file_(std::move(file)), problems_(problems) {}

  YamlNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    YamlNode node;
    node.mark = at(mark);
    add(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    problems_.push_back({at(mark), path(), "an alias (*)", "the value itself, or an `include:`"});
    YamlNode node;
    node.mark = at(mark);
    add(std::move(node));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    YamlNode node;
    node.mark = at(mark);
    node.quoted = tag == "!";
    const bool says_null = value == "~" || value == "null" || value == "Null" || value == "NULL";
    const bool is_null = !node.quoted && says_null;
    if (!is_null) {
      node.kind = YamlNode::Kind::scalar;
      node.scalar = value;
    }
    add(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::sequence);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::map);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Frame {
    YamlNode node;
    std::optional<YamlEntry> pending;  // a map's key that still waits for its value
  };

  SourceMark at(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }

  std::string path() const {
    std::string text;
    for (const Frame& frame : frames_) {
      std::string part;
      if (frame.node.kind == YamlNode::Kind::sequence) {
        part = std::to_string(frame.node.items.size());
      } else if (frame.pending) {
        part = frame.pending->key;
      } else {
        continue;
      }
      text += (text.empty() ? "" : ".") + part;
    }
    return text;
  }

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) {
      problems_.push_back({at(mark), path(), "an anchor (&)", "the value itself, or an `include:`"});
    }
  }

  void open(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind) {
    refuse_anchor(mark, anchor);
    Frame frame;
    frame.node.kind = kind;
    frame.node.mark = at(mark);
    frames_.push_back(std::move(frame));
  }

  void close() {
    YamlNode node = std::move(frames_.back().node);
    frames_.pop_back();
    add(std::move(node));
  }

  void add(YamlNode node) {
    if (frames_.empty()) {
      root = std::move(node);
      return;
    }
    Frame& frame = frames_.back();
    if (frame.node.kind == YamlNode::Kind::sequence) {
      frame.node.items.push_back(std::move(node));
      return;
    }
    if (!frame.pending) {
      if (node.kind != YamlNode::Kind::scalar) {
        problems_.push_back({node.mark, path(), excerpt(node) + " as a key", "a name as a key"});
      } else if (node.scalar.size() > kLongestKey) {
        problems_.push_back({node.mark, path(), excerpt(node) + " as a key", kShorterName});
      }
      frame.pending = YamlEntry{node.scalar, node.mark, {}};
      return;
    }
    YamlEntry entry = std::move(*frame.pending);
    frame.pending.reset();
    entry.value = std::move(node);
    for (const YamlEntry& earlier : frame.node.entries) {
      if (earlier.key != entry.key) continue;
      const std::string above = path();
      problems_.push_back({entry.mark, above.empty() ? entry.key : above + '.' + entry.key,
                           "the key a second time",
                           "it once; it stands in line " + std::to_string(earlier.mark.line) + " already"});
      return;
    }
    frame.node.entries.push_back(std::move(entry));
  }

  std::string file_;
  InputProblems& problems_;
  std::vector<Frame> frames_;
};

void lay_over(YamlNode& base, YamlNode&& top) {
  const bool merge = base.kind == YamlNode::Kind::map && top.kind == YamlNode::Kind::map &&
                     !is_sourced_value(base) && !is_sourced_value(top);
  if (!merge) {
    base = std::move(top);
    return;
  }
  base.mark = top.mark;
  for (YamlEntry& entry : top.entries) {
    if (YamlNode* below = base.find(entry.key)) {
      lay_over(*below, std::move(entry.value));
    } else {
      base.entries.push_back(std::move(entry));
    }
  }
}

bool read_file(const std::filesystem::path& file, std::string& text) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return false;
  std::ostringstream content;
  content << stream.rdbuf();
  text = content.str();
  return true;
}

// `chain` holds the files that are being loaded, outermost first; `named_by` is where this one is named.
YamlNode load_with_includes(const std::filesystem::path& file, const SourceMark& named_by,
                            const std::string& key, std::vector<std::filesystem::path>& chain,
                            InputProblems& problems) {
  std::error_code no_such_place;  // read_file below tells
  const std::filesystem::path identity = std::filesystem::weakly_canonical(file, no_such_place);
  if (std::find(chain.begin(), chain.end(), identity) != chain.end()) {
    std::string circle;
    for (const std::filesystem::path& link : chain) circle += link.filename().string() + " -> ";
    problems.push_back({named_by, key, "a circle of includes: " + circle + identity.filename().string(),
                        "files that do not include themselves"});
    return {};
  }
  std::string text;
  if (!read_file(file, text)) {
    problems.push_back({named_by, key, "'" + file.string() + "', which cannot be read",
                        "the name of a readable file"});
    return {};
  }
  YamlNode tree = parse_yaml_text(text, file.string(), problems);
  const auto include = std::find_if(tree.entries.begin(), tree.entries.end(),
                                    [](const YamlEntry& entry) { return entry.key == "include"; });
  if (include == tree.entries.end()) return tree;

  const YamlNode names = std::move(include->value);
  tree.entries.erase(include);
  std::vector<YamlNode> references;
  if (names.kind == YamlNode::Kind::sequence) {
    references = names.items;
  } else {
    references.push_back(names);
  }
  chain.push_back(identity);
  YamlNode base;
  base.kind = YamlNode::Kind::map;
  for (const YamlNode& reference : references) {
    if (reference.kind != YamlNode::Kind::scalar) {
      problems.push_back(
          {reference.mark, "include", excerpt(reference), "the name of a file, or a list of them"});
      continue;
    }
    lay_over(base, load_with_includes(resolve_path(reference), reference.mark, "include", chain, problems));
    if (base.kind == YamlNode::Kind::null) base.kind = YamlNode::Kind::map;
  }
  chain.pop_back();
  lay_over(base, std::move(tree));
  return base;
}

void set_mark(YamlNode& node, const SourceMark& mark) {
  node.mark = mark;
  for (YamlNode& item : node.items) set_mark(item, mark);
  for (YamlEntry& entry : node.entries) {
    entry.mark = mark;
    set_mark(entry.value, mark);
  }
}

YamlNode text_node(std::string text, const SourceMark& mark) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.scalar = std::move(text);
  node.quoted = true;
  node.mark = mark;
  return node;
}

void apply_override(YamlNode& root, const Override& change, InputProblems& problems) {
  const SourceMark mark{"--set " + change.key + '=' + change.value, 0, 0};
  InputProblems value_problems;
  YamlNode value = parse_yaml_text(change.value, mark.file, value_problems);
  if (!value_problems.empty()) {
    problems.push_back({mark, change.key, "'" + change.value + "'", "a value written as YAML"});
    return;
  }
  set_mark(value, mark);

  if (std::count(change.key.begin(), change.key.end(), '.') >= kDeepest) {
    problems.push_back({mark, change.key.substr(0, kLongestKey), "more than " + std::to_string(kDeepest) + " names",
                        "the path of a key of the file"});
    return;
  }
  YamlNode* node = &root;
  std::string_view rest = change.key;
  while (!rest.empty()) {
    const std::size_t dot = rest.find('.');
    const std::string part(rest.substr(0, dot));
    rest = dot == std::string_view::npos ? std::string_view{} : rest.substr(dot + 1);
    if (node->kind == YamlNode::Kind::sequence) {
      std::size_t index = 0;
      const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc() || stop != part.data() + part.size() || index >= node->items.size()) {
        const std::string last = std::to_string(node->items.size() - 1);
        problems.push_back({mark, change.key, "'" + part + "' as a place in a list",
                            node->items.empty() ? "a list that has entries" : "a number from 0 to " + last});
        return;
      }
      node = &node->items[index];
      continue;
    }
    if (node->kind != YamlNode::Kind::map) {
      if (node->kind == YamlNode::Kind::scalar) {
        problems.push_back({mark, change.key, "'" + part + "' below " + excerpt(*node),
                            "a key that has keys below it"});
        return;
      }
      *node = YamlNode{};
      node->kind = YamlNode::Kind::map;
      node->mark = mark;
    }
    if (part.empty()) {
      problems.push_back({mark, change.key, "an empty name", "names with a dot between each"});
      return;
    }
    if (part.size() > kLongestKey) {
      problems.push_back({mark, change.key, "a key of " + std::to_string(part.size()) + " characters", kShorterName});
      return;
    }
    if (node->find(part) == nullptr) node->entries.push_back({part, mark, {}});
    node = node->find(part);
  }

  if (is_sourced_value(*node) && !is_sourced_value(value)) {
    *node->find("value") = std::move(value);
    node->mark = mark;
    if (YamlNode* source = node->find("source")) {
      *source = text_node("command line", mark);
    } else {
      node->entries.push_back({"source", mark, text_node("command line", mark)});
    }
    return;
  }
  *node = std::move(value);
}

}  // namespace

Override parse_override(std::string_view option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw InputError({{{"--set", 0, 0}, "", "'" + std::string(option) + "'", "key.path=value"}});
  }
  return {std::string(option.substr(0, equals)), std::string(option.substr(equals + 1))};
}

YamlNode parse_yaml_text(std::string_view text, const std::string& file_name, InputProblems& problems) {
  std::istringstream stream{std::string(text)};
  TreeBuilder builder(file_name, problems);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& error) {
    problems.push_back({{file_name, error.mark.line + 1, error.mark.column + 1}, "",
                        "what is not YAML (" + error.msg + ")", "well-formed YAML"});
    return {};
  }
  return std::move(builder.root);
}

std::filesystem::path resolve_path(const YamlNode& reference) {
  const std::filesystem::path named = reference.scalar;
  const bool on_command_line = reference.mark.line == 0;
  if (named.is_absolute() || on_command_line) return named;
  return (std::filesystem::path(reference.mark.file).parent_path() / named).lexically_normal();
}

YamlNode load_yaml_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                        InputProblems& problems) {
  std::vector<std::filesystem::path> chain;
  const std::size_t problems_before = problems.size();
  YamlNode root = load_with_includes(file, {file.string(), 0, 0}, "", chain, problems);
  if (root.kind != YamlNode::Kind::map && problems.size() == problems_before) {
    problems.push_back({{file.string(), std::max(root.mark.line, 1), std::max(root.mark.column, 1)}, "",
                        excerpt(root), "a map of keys and values"});
    return {};
  }
  for (const Override& change : overrides) apply_override(root, change, problems);
  return root;
}

}  // namespace slewlab::common
