// What a reader of a file asks for, found by letting it read no file: which keys there are, what each may hold, which must be
// there. The code that reads a file is its only description; schemas are made of it.
//
// A reader takes other ways where a choice or an optional key says so. It is asked again with each of these answered
// otherwise, alone and in pairs, and what all ways ask for is joined.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"

namespace slewlab::common {

struct KeyDescription {
  enum class Kind { number, integer, numbers, choice, text, file, map, list, other };

  std::string path;  // dots between keys; * is every entry of a list
  Kind kind = Kind::other;
  Unit unit = Unit::none;
  std::vector<Unit> other_units = {};  // that it has on other ways
  Range range = {};           // of a number
  std::size_t fewest = 0, most = 0;  // of numbers
  std::vector<std::string> choices = {};
  bool is_sourced = true;     // {value, source} around it, and the unit of a number
  bool is_required = false;   // on every way that reads the map in which it stands
};

// In the order in which they are asked for. `read` must not mind what values it gets.
std::vector<KeyDescription> describe_keys(const std::function<void(YamlReader&)>& read);

// One way of a reader: answers it, and notes what it asks. YamlReader alone calls this.
class YamlInquiry {
 public:
  using Answers = std::map<std::string, std::size_t>;  // by path: of a choice its number, of an optional key whether it is there

  explicit YamlInquiry(Answers answers) : answers_(std::move(answers)) {}

  bool has(const std::string& path);
  std::size_t choice(const std::string& path, std::initializer_list<std::string_view> choices);
  void asked(KeyDescription key);
  void entered(const std::string& path) { entered_.insert(path); }

  const Answers& answers() const { return answers_; }
  const std::map<std::string, std::size_t>& alternatives() const { return alternatives_; }
  const std::vector<KeyDescription>& keys() const { return keys_; }
  bool was_optional(const std::string& path) const { return optional_.count(path) != 0; }
  bool was_entered(const std::string& path) const { return entered_.count(path) != 0; }

 private:
  Answers answers_;
  std::map<std::string, std::size_t> alternatives_;  // how many answers there are where the reader chose
  std::set<std::string> optional_, entered_;
  std::vector<KeyDescription> keys_;
};

}  // namespace slewlab::common
