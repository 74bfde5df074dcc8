// SIGINT and SIGTERM as a question that a loop asks: has someone told this process to end?
#pragma once

namespace slewlab::common {

// From here on the two signals no longer end the process but answer stop_signal().
void catch_stop_signals();

// The number of the signal that came first, 0 if none did.
int stop_signal();

}  // namespace slewlab::common
