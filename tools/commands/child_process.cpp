#include "tools/commands/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace slewlab::tools {
namespace {

constexpr std::size_t kLastWords = 10;            // [lines]
constexpr std::size_t kMostComplaints = 1 << 20;  // [bytes] kept of a child's standard error

void close_if_open(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

void unblock_signals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace

ChildProcess::ChildProcess(ChildOptions options) : options_(std::move(options)) { start(); }

void ChildProcess::start() {
  // Everything that allocates happens before the fork.
  std::vector<char*> arguments;
  for (std::string& argument : options_.command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  int input[2];
  int output[2];
  int complaint[2];
  int failure[2];  // carries errno where the program cannot be started; closes itself where it can
  if (::pipe2(input, O_CLOEXEC) != 0 || ::pipe2(output, O_CLOEXEC) != 0 || ::pipe2(complaint, O_CLOEXEC) != 0 ||
      ::pipe2(failure, O_CLOEXEC) != 0) {
    throw std::runtime_error(options_.name + ": no more pipes: " + std::strerror(errno));
  }
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error(options_.name + ": cannot fork: " + std::strerror(errno));
  if (pid_ == 0) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127);
    unblock_signals();
    for (const auto& [key, value] : options_.environment) ::setenv(key.c_str(), value.c_str(), 1);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(options_.listens ? input[0] : nothing, 0);
    ::dup2(output[1], 1);
    ::dup2(complaint[1], 2);
    ::execvp(arguments[0], arguments.data());
    const int error_number = errno;
    [[maybe_unused]] const ssize_t written = ::write(failure[1], &error_number, sizeof error_number);
    ::_exit(127);
  }
  ::setpgid(pid_, pid_);
  ::close(input[0]);
  ::close(output[1]);
  ::close(complaint[1]);
  ::close(failure[1]);
  input_ = input[1];
  output_.fd = output[0];
  complaint_.fd = complaint[0];
  int error_number = 0;
  const bool failed = ::read(failure[0], &error_number, sizeof error_number) == sizeof error_number;
  ::close(failure[0]);
  if (failed) {
    ::waitpid(pid_, &status_, 0);
    close_pipes();
    throw std::runtime_error(options_.name + ": cannot start '" + options_.command[0] +
                             "': " + std::strerror(error_number));
  }
  ::fcntl(output_.fd, F_SETFL, O_NONBLOCK);
  ::fcntl(complaint_.fd, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  ::kill(-pid_, SIGKILL);  // also what the child itself has started and left behind
  if (!reaped_) ::waitpid(pid_, &status_, 0);
  close_pipes();
}

void ChildProcess::close_pipes() {
  close_if_open(input_);
  close_if_open(output_.fd);
  close_if_open(complaint_.fd);
}

void ChildProcess::kill() {
  ::kill(-pid_, SIGKILL);
  if (!reaped_) ::waitpid(pid_, &status_, 0);
  reaped_ = true;
}

void ChildProcess::start_again() {
  read_output([](const std::string&) {});
  close_pipes();
  reaped_ = false;
  start();
}

void ChildProcess::tell(const std::string& line) {
  const std::string text = line + '\n';
  ::signal(SIGPIPE, SIG_IGN);  // it may have ended; that is noticed elsewhere
  [[maybe_unused]] const ssize_t written = ::write(input_, text.data(), text.size());
  ::signal(SIGPIPE, SIG_DFL);
}

void ChildProcess::read_output(const std::function<void(const std::string&)>& on_output_line) {
  read_pipe(output_, on_output_line);
  read_pipe(complaint_, [this](const std::string& line) {
    last_words_.push_back(line);
    if (last_words_.size() > kLastWords) last_words_.pop_front();
    if (all_complaints_.size() < kMostComplaints) all_complaints_ += line + '\n';
  });
}

void ChildProcess::read_pipe(Pipe& pipe, const std::function<void(const std::string&)>& on_line) {
  char buffer[4096];
  while (pipe.fd >= 0) {
    const ssize_t count = ::read(pipe.fd, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;  // nothing waits
    if (count == 0) {
      close_if_open(pipe.fd);
      if (!pipe.unfinished_line.empty()) on_line(std::exchange(pipe.unfinished_line, {}));
      return;
    }
    pipe.unfinished_line.append(buffer, static_cast<std::size_t>(count));
    for (std::size_t end; (end = pipe.unfinished_line.find('\n')) != std::string::npos;) {
      on_line(pipe.unfinished_line.substr(0, end));
      pipe.unfinished_line.erase(0, end + 1);
    }
  }
}

bool ChildProcess::ended() {
  if (!reaped_ && ::waitpid(pid_, &status_, WNOHANG) == pid_) reaped_ = true;
  return reaped_;
}

bool ChildProcess::succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }

int ChildProcess::exit_code() const {
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

std::string ChildProcess::how_it_ended() const {
  if (WIFEXITED(status_)) return "exit code " + std::to_string(WEXITSTATUS(status_));
  const int number = WTERMSIG(status_);
  return "killed by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
}

bool ChildProcess::ended_by_signal(int signal_number) const {
  return WIFSIGNALED(status_) && WTERMSIG(status_) == signal_number;
}

void ChildProcess::halt() { ::kill(-pid_, SIGSTOP); }

void ChildProcess::go_on() { ::kill(-pid_, SIGCONT); }

void ChildProcess::send(int signal_number) {
  if (::kill(-pid_, signal_number) == 0) ::kill(-pid_, SIGCONT);
}

GroupGuard::GroupGuard(const std::vector<pid_t>& groups) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no more pipes: ") + std::strerror(errno));
  watcher_ = ::fork();
  if (watcher_ < 0) throw std::runtime_error(std::string("cannot fork: ") + std::strerror(errno));
  if (watcher_ == 0) {
    ::setpgid(0, 0);  // Ctrl-C is not for the watcher
    ::dup2(ends[0], 0);
    ::close_range(1, ~0U, 0);
    char dismissed = 0;
    ssize_t count;
    while ((count = ::read(0, &dismissed, 1)) < 0 && errno == EINTR) {
    }
    if (count == 1) ::_exit(0);
    for (const pid_t group : groups) {
      ::kill(-group, SIGTERM);
      ::kill(-group, SIGCONT);
    }
    constexpr int kWaits = 100;
    constexpr useconds_t kWait = 20'000;  // [us]
    for (int i = 0; i < kWaits; ++i) {
      bool any = false;
      for (const pid_t group : groups) any = any || ::kill(-group, 0) == 0;
      if (!any) ::_exit(0);
      ::usleep(kWait);
    }
    for (const pid_t group : groups) ::kill(-group, SIGKILL);
    ::_exit(0);
  }
  ::close(ends[0]);
  pipe_ = ends[1];
}

GroupGuard::~GroupGuard() {
  const char dismissed = 1;
  [[maybe_unused]] const ssize_t written = ::write(pipe_, &dismissed, 1);
  ::close(pipe_);
  ::waitpid(watcher_, nullptr, 0);
}

}  // namespace slewlab::tools
