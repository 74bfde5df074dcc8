// A program of st_program.h behind the wire: one of its cycles per ENCODER, as the function that AnswerLoop asks for.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "controller/process/answer_loop.h"
#include "controller/structured_text/st_program.h"

namespace slewlab::controller {

// A shared library with the two functions of st_program.h, for as long as this lives.
class StProgram {
 public:
  // Throws std::runtime_error with what the loader says, or which function the library lacks.
  explicit StProgram(const std::filesystem::path& library);
  ~StProgram();
  StProgram(const StProgram&) = delete;
  StProgram& operator=(const StProgram&) = delete;

  // Throws std::runtime_error with the program's own word where it cannot run with this period [ns].
  void start(std::int64_t period) const;
  void cycle(const slewlab_st_inputs& inputs, slewlab_st_outputs& outputs) const { cycle_(&inputs, &outputs); }

 private:
  void* handle_;
  decltype(&slewlab_st_start) start_ = nullptr;
  decltype(&slewlab_st_cycle) cycle_ = nullptr;
  std::string name_;
};

// A program has one state, its library's: every copy of the function starts it anew with its first ENCODER, so that one run at a time is
// answered.
Compute st_answer(std::shared_ptr<const StProgram> program, std::int64_t period);

}  // namespace slewlab::controller
