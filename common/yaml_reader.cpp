#include "common/yaml_reader.h"

#include <algorithm>
#include <cmath>

#include "common/near_name.h"
#include "common/number_and_unit.h"
#include "common/readable_number.h"
#include "common/yaml_file.h"
#include "common/yaml_inquiry.h"

namespace slewlab::common {
namespace {

const YamlNode kNothing{};

// A range as people read it, in the unit that they wrote.
std::string describe(Range range, std::string_view spelling, double factor) {
  const auto limit = [&](double si) { return readable(si / factor); };
  const std::string unit = spelling == "-" ? "" : ' ' + std::string(spelling);
  const bool has_lowest = std::isfinite(range.lowest);
  const bool has_highest = std::isfinite(range.highest);
  if (has_lowest && has_highest) return "a number from " + limit(range.lowest) + " to " + limit(range.highest) + unit;
  if (has_lowest) return (range.lowest_allowed ? "a number of at least " : "a number above ") + limit(range.lowest) + unit;
  if (has_highest) return "a number of at most " + limit(range.highest) + unit;
  return unit.empty() ? "a finite number" : "a finite number in" + unit;
}

std::string describe(Range range, Unit unit) { return describe(range, unit == Unit::none ? "-" : name_of(unit), 1.0); }

bool inside(double number, Range range) {
  if (!std::isfinite(number) || number > range.highest) return false;
  return range.lowest_allowed ? number >= range.lowest : number > range.lowest;
}

// The digits behind a decimal comma, which ends a value within braces: {value: 60,5, unit: t}.
bool is_behind_a_comma(const YamlEntry& entry) {
  return !entry.key.empty() && entry.value.kind == YamlNode::Kind::null && entry.key.find_first_not_of("0123456789") == std::string::npos;
}

// A number that a range allows.
double allowed(Range range) {
  if (std::isfinite(range.lowest) && std::isfinite(range.highest)) return 0.5 * (range.lowest + range.highest);
  if (std::isfinite(range.lowest)) return range.lowest + 1.0;
  return std::isfinite(range.highest) ? range.highest : 1.0;
}

}  // namespace

std::optional<double> parse_share(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar) return std::nullopt;
  std::string_view text = node.scalar;
  double factor = 1.0;
  if (text.ends_with('%')) {
    factor = 0.01;
    text.remove_suffix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
  }
  double number = 0.0;
  if (!parse_number(std::string(text), number)) return std::nullopt;
  number *= factor;
  return number > 0.0 && number <= 1.0 ? std::optional(number) : std::nullopt;
}

YamlReader::YamlReader(const YamlNode& node, std::string path, InputProblems& problems)
    : node_(&node), path_(std::move(path)), problems_(&problems), quiet_(node.kind != YamlNode::Kind::map) {
  const bool unread = node.kind == YamlNode::Kind::null && node.mark.file.empty();
  if (quiet_ && !unread) {
    problems_->push_back({node.mark, path_, excerpt(node), "a map of keys and values"});
  }
}

YamlReader::YamlReader(YamlInquiry& inquiry, std::string path)
    : node_(&kNothing), path_(std::move(path)), problems_(nullptr), inquiry_(&inquiry), quiet_(true) {
  inquiry.entered(path_);
}

std::string YamlReader::path_of(std::string_view key) const {
  if (key.empty()) return path_;
  return path_.empty() ? std::string(key) : path_ + '.' + std::string(key);
}

void YamlReader::report_at(const SourceMark& mark, std::string_view key, std::string found,
                           std::string expected) {
  if (inquiry_ != nullptr) return;
  problems_->push_back({mark, path_of(key), std::move(found), std::move(expected)});
}

void YamlReader::report(std::string_view key, std::string found, std::string expected) {
  if (quiet_) return;
  const YamlNode* entry = node_->find(key);
  report_at(entry != nullptr ? entry->mark : node_->mark, key, std::move(found), std::move(expected));
}

bool YamlReader::is_told(std::string_view key) const {
  return inquiry_ == nullptr && !problems_->empty() && problems_->back().key == path_of(key);
}

const YamlNode* YamlReader::ask(std::string_view key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
  const YamlNode* entry = node_->find(key);
  return entry != nullptr && entry->kind != YamlNode::Kind::null ? entry : nullptr;
}

const YamlNode* YamlReader::need(std::string_view key, std::string_view expected) {
  const YamlNode* entry = ask(key);
  if (entry == nullptr) report(key, "nothing: the key is missing", std::string(expected));
  return entry;
}

bool YamlReader::has(std::string_view key) {
  if (inquiry_ != nullptr) return inquiry_->has(path_of(key));
  return ask(key) != nullptr;
}

const YamlNode* YamlReader::sourced(const YamlNode& entry, std::string_view key, std::optional<Unit> unit,
                                    const std::string& expected, GivenUnit& given) {
  const std::string unit_part = unit ? ", unit: " + std::string(name_of(*unit)) : "";
  const std::string form = "{value: " + expected + unit_part + ", source: ...}";
  if (entry.kind != YamlNode::Kind::map) {
    report_at(entry.mark, key, excerpt(entry), form);
    return nullptr;
  }
  const YamlNode* value = entry.find("value");
  for (const YamlEntry& part : entry.entries) {
    if (unit && value != nullptr && value->kind == YamlNode::Kind::scalar && is_behind_a_comma(part)) {
      report_at(value->mark, key, value->scalar + ',' + part.key, "a decimal point, " + value->scalar + '.' + part.key);
      return nullptr;
    }
    if (part.key == "value" || part.key == "source" || (unit && part.key == "unit")) continue;
    if (unit && part.key == "spread") {
      if (!parse_share(part.value)) report_at(part.mark, key, "the spread " + excerpt(part.value), "a share above 0, such as 10 %");
      continue;
    }
    std::vector<std::string> known{"value"};
    if (unit) known.insert(known.end(), {"unit", "spread"});
    known.emplace_back("source");
    const bool is_near = nearest_name(part.key, known).has_value();
    report_at(part.mark, key, "the unknown key '" + part.key + "'", is_near ? known_names_text(part.key, known) : form);
  }
  if (value == nullptr) {
    report_at(entry.mark, key, excerpt(entry) + " but no 'value'", form);
    return nullptr;
  }
  const YamlNode* source = entry.find("source");
  if (source == nullptr || source->kind != YamlNode::Kind::scalar || source->scalar.empty()) {
    report_at(entry.mark, key, excerpt(*value) + " without a source",
              "source: the thesis's table or equation, a data sheet, or \"chosen: why\"");
  }
  if (!unit) return value;
  const YamlNode* spelling = entry.find("unit");
  if (spelling == nullptr || spelling->kind != YamlNode::Kind::scalar) {
    report_at(entry.mark, key, excerpt(*value) + " without a unit", "unit: one of " + spellings_of(*unit));
    return nullptr;
  }
  const std::optional<double> known = factor_to_si(*unit, spelling->scalar);
  if (!known && spelling->scalar.starts_with(',')) {  // "60,5 t" of a command line
    report_at(value->mark, key, value->scalar + spelling->scalar, "a decimal point, " + value->scalar + '.' + spelling->scalar.substr(1));
    return nullptr;
  }
  if (!known) {
    const std::optional<Unit> other = unit_of(spelling->scalar);
    const std::string why = other ? ", which measures something else" : ", which is unknown";
    report_at(spelling->mark, key, "the unit '" + spelling->scalar + "'" + why, "one of " + spellings_of(*unit));
    return nullptr;
  }
  given = {spelling->scalar, *known};
  return value;
}

std::optional<double> YamlReader::read_number(const YamlNode& value, std::string_view key, Range range, const GivenUnit& given) {
  double number = 0.0;
  if (value.kind != YamlNode::Kind::scalar || value.quoted || !parse_number(value.scalar, number)) {
    const auto parts = value.kind == YamlNode::Kind::scalar ? number_and_unit(value.scalar) : std::nullopt;
    report_at(value.mark, key, excerpt(value),
              parts && !parts->unit.empty() && unit_of(parts->unit) ? std::string(parts->digits) + " alone: its unit stands under 'unit'" : describe(range, given.spelling, given.factor));
    return std::nullopt;
  }
  number *= given.factor;
  if (!inside(number, range)) {
    std::string found = excerpt(value);
    if (std::isfinite(number) && given.spelling != "-") found += ' ' + given.spelling;
    report_at(value.mark, key, found, describe(range, given.spelling, given.factor));
    return std::nullopt;
  }
  return number;
}

double YamlReader::number(std::string_view key, Unit unit, Range range) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::number, .unit = unit, .range = range});
    return allowed(range);
  }
  const YamlNode* entry = need(key, describe(range, unit));
  GivenUnit given;
  const YamlNode* value = entry == nullptr ? nullptr : sourced(*entry, key, unit, "a number", given);
  return value == nullptr ? 0.0 : read_number(*value, key, range, given).value_or(0.0);
}

std::optional<double> YamlReader::optional_number(std::string_view key, Unit unit, Range range) {
  if (!has(key)) return std::nullopt;
  return number(key, unit, range);
}

int YamlReader::integer(std::string_view key, int lowest, int highest) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::integer, .range = between(lowest, highest)});
    return lowest;
  }
  const std::string expected =
      "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest);
  const YamlNode* entry = need(key, expected);
  GivenUnit given;
  const YamlNode* value =
      entry == nullptr ? nullptr : sourced(*entry, key, Unit::none, "a whole number", given);
  if (value == nullptr) return lowest;
  double number = 0.0;
  const bool is_number =
      value->kind == YamlNode::Kind::scalar && !value->quoted && parse_number(value->scalar, number);
  number *= given.factor;
  if (!is_number || number != std::floor(number) || !inside(number, between(lowest, highest))) {
    report_at(value->mark, key, excerpt(*value), expected);
    return lowest;
  }
  return static_cast<int>(number);
}

std::vector<double> YamlReader::numbers(std::string_view key, Unit unit, Range range, std::size_t fewest,
                                        std::size_t most) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::numbers, .unit = unit, .range = range, .fewest = fewest, .most = most});
    return std::vector<double>(fewest, allowed(range));
  }
  const std::string expected = "a list of " +
                               (fewest == most ? std::to_string(fewest)
                                               : std::to_string(fewest) + " to " + std::to_string(most)) +
                               " numbers";
  const YamlNode* entry = need(key, expected);
  GivenUnit given;
  const YamlNode* value = entry == nullptr ? nullptr : sourced(*entry, key, unit, expected, given);
  if (value == nullptr) return {};
  if (value->kind != YamlNode::Kind::sequence || value->items.size() < fewest || value->items.size() > most) {
    report_at(value->mark, key, excerpt(*value), expected);
    return {};
  }
  std::vector<double> result;
  for (const YamlNode& item : value->items) {
    result.push_back(read_number(item, key, range, given).value_or(0.0));
  }
  return result;
}

bool YamlReader::flag(std::string_view key) { return choice(key, {"false", "true"}) == 1; }

std::size_t YamlReader::choice(std::string_view key, std::initializer_list<std::string_view> choices) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::choice, .choices = {choices.begin(), choices.end()}});
    return inquiry_->choice(path_of(key), choices);
  }
  std::string expected;
  for (const std::string_view choice : choices) {
    expected += (expected.empty() ? "" : " or ") + std::string(choice);
  }
  const YamlNode* entry = need(key, expected);
  GivenUnit given;
  const YamlNode* value = entry == nullptr ? nullptr : sourced(*entry, key, std::nullopt, expected, given);
  if (value == nullptr) return 0;
  const auto found = std::find(choices.begin(), choices.end(), value->scalar);
  if (value->kind != YamlNode::Kind::scalar || found == choices.end()) {
    report_at(value->mark, key, excerpt(*value), expected);
    return 0;
  }
  return static_cast<std::size_t>(found - choices.begin());
}

std::string YamlReader::text(std::string_view key) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::text, .is_sourced = false});
    return {};
  }
  const YamlNode* entry = need(key, "a text");
  if (entry == nullptr) return {};
  if (entry->kind != YamlNode::Kind::scalar || entry->scalar.empty()) {
    report_at(entry->mark, key, excerpt(*entry), "a text");
    return {};
  }
  return entry->scalar;
}

std::string YamlReader::optional_text(std::string_view key) { return has(key) ? text(key) : std::string{}; }

void YamlReader::heading(std::string_view kind) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of("kind"), .kind = KeyDescription::Kind::choice, .choices = {std::string(kind)}, .is_sourced = false});
  }
  const std::string found = text("kind");
  optional_text("description");
  if (found.empty() || found == kind) return;
  report("kind", found, std::string(kind));
  if (nearest_name(found, {std::string(kind)})) return;  // a slip of the pen
  // What a file of another kind lacks and has is of no interest.
  node_ = &kNothing;
  quiet_ = true;
}

std::filesystem::path YamlReader::file(std::string_view key) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::file, .is_sourced = false});
    return {};
  }
  const YamlNode* entry = need(key, "the name of a file");
  if (entry == nullptr) return {};
  if (entry->kind != YamlNode::Kind::scalar || entry->scalar.empty()) {
    report_at(entry->mark, key, excerpt(*entry), "the name of a file");
    return {};
  }
  return resolve_path(*entry);
}

YamlReader YamlReader::map(std::string_view key) {
  if (inquiry_ != nullptr) {
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::map, .is_sourced = false});
    return YamlReader(*inquiry_, path_of(key));
  }
  const YamlNode* entry = need(key, "a map of keys and values");
  return YamlReader(entry == nullptr ? kNothing : *entry, path_of(key), *problems_);
}

void YamlReader::each(std::string_view key, const std::function<void(YamlReader&)>& read) {
  if (inquiry_ != nullptr) {
    inquiry_->has(path_of(key));  // an absent key is an empty list
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::list, .is_sourced = false});
    YamlReader reader(*inquiry_, path_of(key) + ".*");
    read(reader);
    return;
  }
  const YamlNode* entry = ask(key);
  if (entry == nullptr) return;
  if (entry->kind != YamlNode::Kind::sequence) {
    report_at(entry->mark, key, excerpt(*entry), "a list");
    return;
  }
  const std::string path = path_of(key) + '.';
  for (std::size_t i = 0; i < entry->items.size(); ++i) {
    YamlReader reader(entry->items[i], path + std::to_string(i), *problems_);
    read(reader);
  }
}

const YamlNode* YamlReader::raw(std::string_view key) {
  if (inquiry_ != nullptr) {
    inquiry_->has(path_of(key));
    inquiry_->asked({.path = path_of(key), .kind = KeyDescription::Kind::other, .is_sourced = false});
    return nullptr;
  }
  return ask(key);
}

void YamlReader::finish() {
  if (quiet_) return;
  for (const YamlEntry& entry : node_->entries) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
    report_at(entry.mark, entry.key, "a key that is not known here", known_names_text(entry.key, asked_));
  }
}

std::filesystem::path resolve_path(const YamlNode& reference) {
  std::filesystem::path named = reference.scalar;
  const bool on_command_line = reference.mark.line == 0;
  if (named.is_absolute() || on_command_line) return named;
  return (std::filesystem::path(reference.mark.file.text()).parent_path() / named).lexically_normal();
}

}  // namespace slewlab::common
