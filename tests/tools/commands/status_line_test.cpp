#include "tools/commands/status_line.h"

#include <gtest/gtest.h>

#include <sstream>

namespace slewlab::tools {
namespace {

TEST(StatusLine, IsWrittenOverOnATerminal) {
  std::ostringstream out;
  StatusLine line(out, true, 2.0);
  line.show(0.0, "10 %");
  line.show(0.1, "20 %");
  line.keep();
  out << "done\n";
  EXPECT_EQ(out.str(), "\r\033[K10 %\r\033[K20 %\ndone\n");
}

TEST(StatusLine, GivesItsPlaceAwayOnATerminal) {
  std::ostringstream out;
  StatusLine line(out, true, 2.0);
  line.show(0.0, "10 %");
  line.clear();
  line.clear();
  line.keep();
  out << "done\n";
  EXPECT_EQ(out.str(), "\r\033[K10 %\r\033[Kdone\n");
}

TEST(StatusLine, LeavesNoOpenLineBehind) {
  std::ostringstream out;
  try {
    StatusLine line(out, true, 2.0);
    line.show(0.0, "10 %");
    throw 1;
  } catch (int) {
    out << "interrupted\n";
  }
  EXPECT_EQ(out.str(), "\r\033[K10 %\ninterrupted\n");
}

TEST(StatusLine, IsALineOfItsOwnFromTimeToTimeElsewhere) {
  std::ostringstream out;
  StatusLine line(out, false, 2.0);
  line.show(5.0, "10 %");
  line.show(6.9, "15 %");
  line.show(7.0, "20 %");
  line.show(8.0, "30 %");
  line.show(8.5, "100 %", true);
  line.show(8.6, "100 %", true);  // said again at the end of the work, as a campaign does
  line.keep();
  line.clear();
  EXPECT_EQ(out.str(), "10 %\n20 %\n100 %\n");
}

TEST(StatusLine, WithoutAnIntervalTellsAll) {
  std::ostringstream out;
  StatusLine line(out, false, 0.0);
  line.show(0.0, "10 %");
  line.show(0.0, "20 %");
  EXPECT_EQ(out.str(), "10 %\n20 %\n");
}

}  // namespace
}  // namespace slewlab::tools
