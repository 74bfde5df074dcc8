#include "common/input_error.h"

#include <utility>

#include "common/utf8_text.h"

namespace slewlab::common {

FileName::~FileName() = default;

std::string to_text(const InputProblem& problem) {
  std::string text = without_control(problem.where.file.text());
  if (problem.where.line > 0) {
    text += ':' + std::to_string(problem.where.line) + ':' + std::to_string(problem.where.column);
  }
  text += ": ";
  if (!problem.key.empty()) text += "key '" + without_control(problem.key) + "': ";
  text += "found " + without_control(problem.found) + ", expected " + without_control(problem.expected);
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
