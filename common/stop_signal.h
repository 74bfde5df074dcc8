// SIGINT and SIGTERM as a question that a loop asks: has someone told this process to end?
#pragma once

namespace slewlab::common {

// From here on the two signals no longer end the process but make stop_requested() true.
void catch_stop_signals();

bool stop_requested();

// The number of the signal that came first, 0 if none did.
int stop_signal();

// What a process answers that one of them ended, as a shell would say it: 128 + its number.
int stop_exit_code();

}  // namespace slewlab::common
