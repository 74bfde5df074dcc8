// How far long work is, in one line: on a terminal written over, elsewhere a line of its own from time to time.
#pragma once

#include <iosfwd>
#include <string>

namespace slewlab::tools {

class StatusLine {
 public:
  // `interval` [s] between two lines where there is no terminal.
  StatusLine(std::ostream& out, bool terminal, double interval) : out_(out), terminal_(terminal), interval_(interval) {}
  ~StatusLine() { keep(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  // `seconds` [s] is the time now, from any beginning. `is_last`: shown though the interval has not passed,
  // unless the one before was the last already.
  void show(double seconds, const std::string& text, bool is_last = false);

  void keep();   // what comes next is printed below the line
  void clear();  // ... in its place

 private:
  std::ostream& out_;
  bool terminal_;
  double interval_;
  bool is_first_ = true;
  bool was_last_ = false;
  double shown_at_ = 0.0;  // [s]
  bool is_open_ = false;
};

}  // namespace slewlab::tools
