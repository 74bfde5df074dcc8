#pragma once

// A program started as a child in a process group of its own, with its output and its complaints read line
// by line. The child gets SIGTERM when the thread that started it dies.

#include <sys/types.h>

#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace slewlab::tools {

struct ChildOptions {
  std::string name;                                               // for people
  std::vector<std::string> command;                               // program, found in PATH, and arguments
  std::vector<std::pair<std::string, std::string>> environment;   // added to ours
  bool listens = false;                                           // to tell(); otherwise its input is empty
};

class ChildProcess {
 public:
  // Throws std::runtime_error where it cannot be started.
  explicit ChildProcess(ChildOptions options);
  ~ChildProcess();  // kills the group if it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  const std::string& name() const { return options_.name; }
  pid_t pid() const { return pid_; }
  int output_fd() const { return output_.fd; }
  int complaint_fd() const { return complaint_.fd; }

  // Takes in what waits in the pipes, without blocking.
  void read_output(const std::function<void(const std::string& line)>& on_output_line);

  // True once the child has ended; it is reaped then.
  bool ended();
  bool succeeded() const;         // exit code 0
  int exit_code() const;          // 128 + signal where a signal ended it
  std::string how_it_ended() const;  // "exit code 3", "killed by signal 9 (Killed)"
  bool ended_by_signal(int signal_number) const;

  // Kills the whole group and waits for its end.
  void kill();
  // Starts it anew after its end; its output and complaints go on. Throws as the constructor does.
  void start_again();

  // A line for its standard input, if it listens.
  void tell(const std::string& line);

  // Stops the whole group (SIGSTOP), and lets it go on.
  void halt();
  void go_on();

  // To the whole group; a stopped one is continued so that it hears it.
  void send(int signal_number);

  // The last lines on its standard error.
  const std::deque<std::string>& last_words() const { return last_words_; }
  // Everything on its standard error and, but for the lines that on_output_line takes, nothing else.
  const std::string& complaints() const { return all_complaints_; }

 private:
  struct Pipe {
    int fd = -1;
    std::string unfinished_line;
  };
  void start();
  void close_pipes();
  void read_pipe(Pipe& pipe, const std::function<void(const std::string&)>& on_line);

  ChildOptions options_;
  pid_t pid_ = -1;
  bool reaped_ = false;
  int status_ = 0;
  int input_ = -1;  // where we tell it something
  Pipe output_;
  Pipe complaint_;
  std::deque<std::string> last_words_;
  std::string all_complaints_;
};

// Sees to it that the groups end even where this process is killed without a chance to do so itself: a
// watcher process waits for this one's death, asks the groups to end, and kills what has not ended after
// two seconds.
class GroupGuard {
 public:
  explicit GroupGuard(const std::vector<pid_t>& groups);
  ~GroupGuard();  // dismisses the watcher
  GroupGuard(const GroupGuard&) = delete;
  GroupGuard& operator=(const GroupGuard&) = delete;

 private:
  pid_t watcher_ = -1;
  int pipe_ = -1;
};

}  // namespace slewlab::tools
