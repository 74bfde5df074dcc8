// What is wrong in a file or on a command line that a user wrote, in words the user can act on.
#pragma once

#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace slewlab::common {

// The name of a file, one text for all the marks that name it: a tree has several marks for every line.
class FileName {
 public:
  FileName() = default;
  FileName(std::string name) : name_(std::make_shared<const std::string>(std::move(name))) {}
  FileName(const char* name) : FileName(std::string(name)) {}
  FileName(const FileName&) = default;
  FileName(FileName&&) = default;
  FileName& operator=(const FileName&) = default;
  FileName& operator=(FileName&&) = default;
  ~FileName();  // not inline: GCC 12 warns wrongly of its pointer wherever a list of problems is written in braces

  operator const std::string&() const { return text(); }
  const std::string& text() const {
    static const std::string kNone;
    return name_ ? *name_ : kNone;
  }
  bool empty() const { return text().empty(); }

  friend bool operator==(const FileName& a, const FileName& b) { return a.text() == b.text(); }
  friend std::ostream& operator<<(std::ostream& stream, const FileName& name) { return stream << name.text(); }

 private:
  std::shared_ptr<const std::string> name_;
};

// Where a piece of YAML stands. Line and column count from 1; line 0 means the command line, and `file`
// then holds the option as it was given.
struct SourceMark {
  FileName file;
  int line = 0;
  int column = 0;
};

// "file:line:column: key 'a.b': found X, expected Y"
struct InputProblem {
  SourceMark where;
  std::string key;       // path from the root of the file, dots between; empty for the file as a whole
  std::string found;     // the value as the user wrote it
  std::string expected;  // what would be right
};

std::string to_text(const InputProblem& problem);

using InputProblems = std::vector<InputProblem>;

// Thrown when all problems of an input have been collected; what() has one line per problem.
class InputError : public std::runtime_error {
 public:
  explicit InputError(InputProblems problems);
  const InputProblems& problems() const { return problems_; }

 private:
  InputProblems problems_;
};

}  // namespace slewlab::common
