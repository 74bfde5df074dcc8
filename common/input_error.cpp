#include "common/input_error.h"

#include <utility>

namespace slewlab::common {

FileName::~FileName() = default;

std::string to_text(const InputProblem& problem) {
  std::string text = problem.where.file.text();
  if (problem.where.line > 0) {
    text += ':' + std::to_string(problem.where.line) + ':' + std::to_string(problem.where.column);
  }
  text += ": ";
  if (!problem.key.empty()) text += "key '" + problem.key + "': ";
  text += "found " + problem.found + ", expected " + problem.expected;
  return text;
}

namespace {

std::string joined(const InputProblems& problems) {
  std::string text;
  for (const InputProblem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += to_text(problem);
  }
  return text;
}

}  // namespace

InputError::InputError(InputProblems problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

}  // namespace slewlab::common
