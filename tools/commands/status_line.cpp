#include "tools/commands/status_line.h"

#include <ostream>

namespace slewlab::tools {

namespace {

constexpr const char* kClearLine = "\r\033[K";

}  // namespace

void StatusLine::show(double seconds, const std::string& text, bool is_last) {
  const bool is_due = terminal_ || is_first_ || (is_last && !was_last_) || seconds - shown_at_ >= interval_;
  if (!is_due) return;
  is_first_ = false;
  was_last_ = is_last;
  shown_at_ = seconds;
  is_open_ = terminal_;
  if (terminal_) out_ << kClearLine << text << std::flush;
  else out_ << text << std::endl;
}

void StatusLine::keep() {
  if (is_open_) out_ << std::endl;
  is_open_ = false;
}

void StatusLine::clear() {
  if (is_open_) out_ << kClearLine << std::flush;
  is_open_ = false;
}

}  // namespace slewlab::tools
