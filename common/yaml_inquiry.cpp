#include "common/yaml_inquiry.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace slewlab::common {
namespace {

constexpr std::size_t kMostOtherAnswers = 2;  // on one way

std::string parent_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

}  // namespace

bool YamlInquiry::has(const std::string& path) {
  optional_.insert(path);
  if (std::any_of(keys_.begin(), keys_.end(), [&](const KeyDescription& key) { return key.path == path; })) return true;
  alternatives_.emplace(path, 2);
  const auto given = answers_.find(path);
  return given == answers_.end() || given->second == 0;  // 0: it is there
}

std::size_t YamlInquiry::choice(const std::string& path, std::initializer_list<std::string_view> choices) {
  alternatives_[path + '='] = choices.size();
  const auto given = answers_.find(path + '=');
  return given == answers_.end() ? 0 : std::min(given->second, choices.size() - 1);
}

void YamlInquiry::asked(KeyDescription key) {
  const auto known = std::find_if(keys_.begin(), keys_.end(), [&](const KeyDescription& other) { return other.path == key.path; });
  if (known == keys_.end()) keys_.push_back(std::move(key));
}

std::vector<KeyDescription> describe_keys(const std::function<void(YamlReader&)>& read) {
  std::vector<YamlInquiry> ways;
  std::deque<YamlInquiry::Answers> open{{}};
  std::set<YamlInquiry::Answers> seen{{}};
  while (!open.empty()) {
    YamlInquiry& way = ways.emplace_back(std::move(open.front()));
    open.pop_front();
    YamlReader reader(way, "");
    read(reader);
    if (way.answers().size() == kMostOtherAnswers) continue;
    for (const auto& [path, count] : way.alternatives()) {
      for (std::size_t other = 1; other < count; ++other) {
        YamlInquiry::Answers answers = way.answers();
        if (answers.emplace(path, other).second && seen.insert(answers).second) open.push_back(answers);
      }
    }
  }
  std::vector<KeyDescription> all;
  for (const YamlInquiry& way : ways) {
    for (const KeyDescription& key : way.keys()) {
      const auto known = std::find_if(all.begin(), all.end(), [&](const KeyDescription& other) { return other.path == key.path; });
      if (known == all.end()) {
        all.push_back(key);
      } else if (key.unit != known->unit && std::find(known->other_units.begin(), known->other_units.end(), key.unit) == known->other_units.end()) {
        known->other_units.push_back(key.unit);
      }
    }
  }
  for (KeyDescription& key : all) {
    key.is_required = std::all_of(ways.begin(), ways.end(), [&](const YamlInquiry& way) {
      if (!way.was_entered(parent_of(key.path))) return true;
      const auto& keys = way.keys();
      return !way.was_optional(key.path) &&
             std::any_of(keys.begin(), keys.end(), [&](const KeyDescription& other) { return other.path == key.path; });
    });
  }
  return all;
}

}  // namespace slewlab::common
