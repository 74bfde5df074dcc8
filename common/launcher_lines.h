#pragma once

// Lines that the launcher says on standard input: "done" to what it was asked for, and in a steered run what the desk asks for
// (sim/drive/steering.h; of the controller: controller/process/main.cpp). Whoever waits for the one keeps the others.

#include <chrono>
#include <deque>
#include <optional>
#include <string>

namespace slewlab::common {

class LauncherLines {
 public:
  // Waits for a line other than "done", so long at most (zero: not at all); nothing where none came, also at the end of input.
  std::optional<std::string> next(std::chrono::milliseconds patience);
  // Waits for "done"; false where nobody can say it any more, or a signal asked this process to end.
  bool wait_for_done();
  bool ended() const { return ended_; }

 private:
  bool read(int patience);  // [ms], -1 for ever; false where nothing came

  std::string unfinished_;
  std::deque<std::string> lines_;
  int done_ = 0;
  bool ended_ = false;
};

}  // namespace slewlab::common
