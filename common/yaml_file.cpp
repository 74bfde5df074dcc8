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
#include <unordered_map>

#include "common/near_name.h"
#include "common/number_and_unit.h"
#include "common/unit.h"
#include "common/utf8_text.h"
#include "common/yaml_reader.h"

namespace slewlab::common {
namespace {

// YAML's own limit for a key that stands before its colon is 1024; no name here comes near it.
constexpr std::size_t kLongestKey = 200;
constexpr std::ptrdiff_t kDeepest = 100;  // [names] in the path of a `--set`
// What one input may hold with all its includes; a scenario with 300 000 of the operator's moves has 28 MB.
constexpr std::uintmax_t kMostBytes = 32'000'000;
constexpr int kMostFiles = 1000;
const std::string kShorterName = "a name of at most " + std::to_string(kLongestKey) + " characters";

// Builds the tree from the parser's events. A frame is a map or list that is still open.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(FileName file, InputProblems& problems) : file_(std::move(file)), problems_(problems) {}

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
      if (!is_utf8(value)) {
        node.scalar = utf8_text(value);
        problems_.push_back({at(mark), path(), excerpt(node) + ", which is not UTF-8", "text in UTF-8"});
      }
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
    std::optional<YamlEntry> pending;              // a map's key that still waits for its value
    std::unordered_map<std::string, int> lines;    // of a map's keys so far
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
    node.items.shrink_to_fit();
    node.entries.shrink_to_fit();
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
    const auto [earlier, is_new] = frame.lines.try_emplace(entry.key, entry.mark.line);
    if (!is_new) {
      const std::string above = path();
      problems_.push_back({entry.mark, above.empty() ? entry.key : above + '.' + entry.key,
                           "the key a second time",
                           "it once; it stands in line " + std::to_string(earlier->second) + " already"});
      return;
    }
    frame.node.entries.push_back(std::move(entry));
  }

  FileName file_;
  InputProblems& problems_;
  std::vector<Frame> frames_;
};

// Notices where a document begins, and forgets what is in it.
class DocumentFinder : public YAML::EventHandler {
 public:
  YAML::Mark begin;

  void OnDocumentStart(const YAML::Mark& mark) override { begin = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

void lay_over(YamlNode& base, YamlNode&& top) {
  const bool merge = base.kind == YamlNode::Kind::map && top.kind == YamlNode::Kind::map &&
                     !is_sourced_value(base) && !is_sourced_value(top);
  if (!merge) {
    base = std::move(top);
    return;
  }
  base.mark = top.mark;
  std::unordered_map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < base.entries.size(); ++i) places.emplace(base.entries[i].key, i);
  for (YamlEntry& entry : top.entries) {
    const auto [place, is_new] = places.try_emplace(entry.key, base.entries.size());
    if (is_new) {
      base.entries.push_back(std::move(entry));
    } else {
      lay_over(base.entries[place->second].value, std::move(entry.value));
    }
  }
}

// What an input has read so far, its includes counted as often as they are named.
struct Amount {
  std::uintmax_t bytes = 0;
  int files = 0;
  bool refused = false;
};

enum class Reading { good, impossible, too_large };

Reading read_file(const std::filesystem::path& file, Amount& amount, std::string& text) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return Reading::impossible;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Reading::impossible;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return Reading::impossible;
  amount.bytes += size;
  ++amount.files;
  if (size > kMostBytes || amount.bytes > kMostBytes || amount.files > kMostFiles) return Reading::too_large;
  text.resize(size);
  stream.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(stream.gcount()));  // it may have shrunk meanwhile
  return Reading::good;
}

std::string size_text(std::uintmax_t bytes) {
  std::ostringstream text;
  text.precision(3);
  text << static_cast<double>(bytes) * 1e-6 << " MB";
  return text.str();
}

YamlNode parse_text(std::string text, const FileName& file_name, InputProblems& problems) {
  // yaml-cpp takes such bytes for UTF-16 and tells signs of other scripts.
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n')) + 1;
    problems.push_back({{file_name, line, 1}, "", "a byte of zero, as in UTF-16 or in what is no text", "text in UTF-8"});
    return {};
  }
  std::istringstream stream(std::move(text));
  TreeBuilder builder(file_name, problems);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    DocumentFinder second;
    if (parser.HandleNextDocument(second)) {
      problems.push_back({{file_name, second.begin.line + 1, second.begin.column + 1}, "",
                          "a second YAML document (behind ---)", "one document in a file"});
    }
  } catch (const YAML::Exception& error) {
    problems.push_back({{file_name, error.mark.line + 1, error.mark.column + 1}, "",
                        "what is not YAML (" + utf8_text(error.msg) + ")", "well-formed YAML"});
    return {};
  }
  return std::move(builder.root);
}

// The entry of a root that includes other files. One of a mistyped name is told, and taken: what its files hold is not missing then.
std::vector<YamlEntry>::iterator include_in(YamlNode& tree, InputProblems& problems) {
  const auto named = [&](const auto& is_it) { return std::find_if(tree.entries.begin(), tree.entries.end(), is_it); };
  const auto include = named([](const YamlEntry& entry) { return entry.key == "include"; });
  if (include != tree.entries.end()) return include;
  const auto near = named([](const YamlEntry& entry) { return nearest_name(entry.key, {"include"}).has_value(); });
  if (near != tree.entries.end()) problems.push_back({near->mark, near->key, "a key that is not known here", "'include'"});
  return near;
}

// `chain` holds the files that are being loaded, outermost first; `named_by` is where this one is named.
YamlNode load_with_includes(const std::filesystem::path& file, const SourceMark& named_by,
                            const std::string& key, std::vector<std::filesystem::path>& chain, Amount& amount,
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
  const Reading reading = read_file(file, amount, text);
  if (reading == Reading::impossible) {
    const std::string why = std::filesystem::is_directory(file, no_such_place) ? ", which is a folder" : ", which cannot be read";
    problems.push_back({named_by, key, "'" + file.string() + "'" + why, "the name of a readable file"});
    return {};
  }
  if (reading == Reading::too_large) {
    // Said once: what follows is too large as well.
    if (!amount.refused) {
      problems.push_back({named_by, key,
                          "'" + file.string() + "', with which the input has " + std::to_string(amount.files) +
                              " file(s) and " + size_text(amount.bytes),
                          "at most " + std::to_string(kMostFiles) + " files and " + size_text(kMostBytes) +
                              " with all includes"});
    }
    amount.refused = true;
    return {};
  }
  YamlNode tree = parse_text(std::move(text), file.string(), problems);
  const auto include = include_in(tree, problems);
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
    lay_over(base, load_with_includes(resolve_path(reference), reference.mark, "include", chain, amount, problems));
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

YamlNode number_node(std::string_view text, const SourceMark& mark) {
  YamlNode node = text_node(std::string(text), mark);
  node.quoted = false;
  return node;
}

bool holds_numbers(const YamlNode& node) {
  double number = 0.0;
  if (node.kind == YamlNode::Kind::scalar) return !node.quoted && parse_number(node.scalar, number);
  return node.kind == YamlNode::Kind::sequence && !node.items.empty() &&
         std::all_of(node.items.begin(), node.items.end(), holds_numbers);
}

// Whether a bare number says what it means: messages speak SI, the file its own unit, and where the two are one no one errs.
bool is_plain_unit(const YamlNode& unit) {
  const std::optional<Unit> known = unit_of(unit.scalar);
  return known && factor_to_si(*known, unit.scalar) == 1.0;
}

// What to write instead of a bare number.
std::string with_its_unit(const std::string& value, const YamlNode& unit) {
  std::string text = '"' + value + ' ' + unit.scalar + '"';
  if (const std::optional<Unit> known = unit_of(unit.scalar)) {
    text += " or \"" + value + ' ' + std::string(name_of(*known)) + '"';
  }
  return text;
}

void put_source(YamlNode& node, const SourceMark& mark) {
  if (YamlNode* source = node.find("source")) {
    *source = text_node("command line", mark);
  } else {
    node.entries.push_back({"source", mark, text_node("command line", mark)});
  }
}

// A bare value into {value, unit, source}; null takes all of it away, as it does in a file.
void put_value(YamlNode& node, YamlNode&& value, const Override& change, const SourceMark& mark, InputProblems& problems) {
  if (value.kind == YamlNode::Kind::null) {
    node = std::move(value);
    return;
  }
  YamlNode* unit = node.find("unit");
  if (unit != nullptr && value.kind == YamlNode::Kind::scalar && !value.quoted) {
    if (const auto parts = number_and_unit(value.scalar); parts && !parts->unit.empty()) {
      *unit = text_node(std::string(parts->unit), mark);
      value = number_node(parts->digits, mark);
      unit = nullptr;  // it is told
    }
  }
  if (unit != nullptr && holds_numbers(value) && !is_plain_unit(*unit)) {
    const bool is_list = value.kind == YamlNode::Kind::sequence;
    problems.push_back({mark, change.key, change.value + " without a unit",
                        is_list ? "{value: " + change.value + ", unit: " + unit->scalar + "}"
                                : "the number with its unit, " + with_its_unit(change.value, *unit)});
    return;
  }
  *node.find("value") = std::move(value);
  node.mark = mark;
  put_source(node, mark);
}

std::string option_text(const Override& change) { return "--set " + change.way + change.key + '=' + change.value; }

void apply_override(YamlNode& root, const Override& change, InputProblems& problems) {
  const SourceMark mark{option_text(change), 0, 0};
  InputProblems value_problems;
  YamlNode value = parse_text(change.value, mark.file, value_problems);
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
    put_value(*node, std::move(value), change, mark, problems);
    return;
  }
  if (is_sourced_value(value) && value.find("source") == nullptr) put_source(value, mark);
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

std::vector<Override> take_overrides(std::string_view way, std::vector<Override>& overrides) {
  std::vector<Override> taken;
  std::vector<Override> rest;
  for (Override& change : overrides) {
    if (change.key.starts_with(way)) {
      taken.push_back({change.key.substr(way.size()), std::move(change.value), change.way + std::string(way)});
    } else {
      rest.push_back(std::move(change));
    }
  }
  overrides = std::move(rest);
  return taken;
}

InputProblems as_given(InputProblems problems, const std::vector<Override>& overrides) {
  for (InputProblem& problem : problems) {
    const auto given = std::find_if(overrides.begin(), overrides.end(), [&](const Override& change) {
      return problem.where.line == 0 && problem.where.file.text() == option_text(change);
    });
    if (given != overrides.end() && !problem.key.starts_with(given->way)) problem.key = given->way + problem.key;
  }
  return problems;
}

YamlNode parse_yaml_text(std::string_view text, const std::string& file_name, InputProblems& problems) {
  return parse_text(std::string(text), file_name, problems);
}

YamlNode load_yaml_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                        InputProblems& problems) {
  std::vector<std::filesystem::path> chain;
  Amount amount;
  const std::size_t problems_before = problems.size();
  YamlNode root = load_with_includes(file, {file.string(), 0, 0}, "", chain, amount, problems);
  if (root.kind != YamlNode::Kind::map && problems.size() == problems_before) {
    problems.push_back({{file.string(), std::max(root.mark.line, 1), std::max(root.mark.column, 1)}, "",
                        excerpt(root), "a map of keys and values"});
    return {};
  }
  for (const Override& change : overrides) apply_override(root, change, problems);
  return root;
}

}  // namespace slewlab::common
