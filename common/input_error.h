// What is wrong in a file or on a command line that a user wrote, in words the user can act on.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace slewlab::common {

// Where a piece of YAML stands. Line and column count from 1; line 0 means the command line, and `file`
// then holds the option as it was given.
struct SourceMark {
  std::string file;
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
