#include "common/launcher_lines.h"

#include <poll.h>
#include <unistd.h>

#include "common/stop_signal.h"

namespace slewlab::common {

bool LauncherLines::read(int patience) {
  if (ended_) return false;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, patience) <= 0) return false;
  char bytes[4096];
  const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
  if (count <= 0) {
    ended_ = count == 0;
    return false;
  }
  unfinished_.append(bytes, static_cast<std::size_t>(count));
  for (std::size_t end; (end = unfinished_.find('\n')) != std::string::npos;) {
    std::string line = unfinished_.substr(0, end);
    unfinished_.erase(0, end + 1);
    if (line == "done") {
      ++done_;
    } else {
      lines_.push_back(std::move(line));
    }
  }
  return true;
}

std::optional<std::string> LauncherLines::next(std::chrono::milliseconds patience) {
  if (lines_.empty()) read(static_cast<int>(patience.count()));
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

bool LauncherLines::wait_for_done() {
  while (done_ == 0) {
    read(-1);
    if (ended_ || stop_requested()) return false;
  }
  --done_;
  return true;
}

}  // namespace slewlab::common
