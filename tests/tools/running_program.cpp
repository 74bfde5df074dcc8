#include "tests/tools/running_program.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace slewlab {

RunningProgram::RunningProgram(std::vector<std::string> command) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  complaint_file_ = (std::filesystem::temp_directory_path() / "slewlab-complaints.XXXXXX").string();
  const int complaints = ::mkstemp(complaint_file_.data());
  int output[2];
  if (complaints < 0 || ::pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("cannot start a program");
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::dup2(output[1], 1);
    ::dup2(complaints, 2);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(output[1]);
  ::close(complaints);
  output_fd_ = output[0];
}

RunningProgram::~RunningProgram() {
  if (!ended_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(output_fd_);
  std::error_code ignored;
  std::filesystem::remove(complaint_file_, ignored);
}

std::string RunningProgram::wait_for_line(const std::function<bool(const std::string&)>& fits) {
  for (;;) {
    const std::size_t end = unfinished_.find('\n');
    if (end != std::string::npos) {
      const std::string line = unfinished_.substr(0, end);
      unfinished_.erase(0, end + 1);
      output_ += line + '\n';
      if (fits(line)) return line;
      continue;
    }
    char buffer[4096];
    const ssize_t count = ::read(output_fd_, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return {};
    unfinished_.append(buffer, static_cast<std::size_t>(count));
  }
}

std::string RunningProgram::wait_for_line(const std::string& part) {
  return wait_for_line([&](const std::string& line) { return line.find(part) != std::string::npos; });
}

int RunningProgram::wait_for_end() {
  if (ended_) return result_;
  wait_for_line([](const std::string&) { return false; });
  int status = 0;
  ::waitpid(pid_, &status, 0);
  ended_ = true;
  result_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  std::ifstream file(complaint_file_);
  complaints_.assign(std::istreambuf_iterator<char>(file), {});
  return result_;
}

void wait_until_nothing_is_left() {
  while (::waitpid(-1, nullptr, 0) > 0 || errno == EINTR) {
  }
}

pid_t number_after(const std::string& text, const std::string& label) {
  const std::size_t at = text.find(label);
  if (at == std::string::npos) throw std::runtime_error("no '" + label + "' in '" + text + "'");
  return static_cast<pid_t>(std::stol(text.substr(at + label.size())));
}

}  // namespace slewlab
