#pragma once

// A program that a test has started, with its output read line by line as it comes. The test process adopts
// every orphan, so that "nothing is left behind" can be waited for and proved.

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace slewlab {

class RunningProgram {
 public:
  explicit RunningProgram(std::vector<std::string> command);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  pid_t pid() const { return pid_; }

  // Reads lines of standard output until one fits; empty if the output ended before.
  std::string wait_for_line(const std::function<bool(const std::string&)>& fits);
  std::string wait_for_line(const std::string& part);

  // Reads everything and waits for the end; the exit code, or -signal.
  int wait_for_end();

  const std::string& output() const { return output_; }      // all lines so far
  const std::string& complaints() const { return complaints_; }  // complete after wait_for_end

 private:
  pid_t pid_ = -1;
  int output_fd_ = -1;
  std::string complaint_file_;
  std::string unfinished_;
  std::string output_;
  std::string complaints_;
  bool ended_ = false;
  int result_ = 0;
};

// Waits until every child and adopted orphan of this process has ended (a leftover that does not end makes
// the test run into its time limit).
void wait_until_nothing_is_left();

// The number behind `label` in `text`, for pids in a line of output.
pid_t number_after(const std::string& text, const std::string& label);

}  // namespace slewlab
