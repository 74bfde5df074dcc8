#pragma once

// Multicast for a command that runs processes on a bus: as found, or else in a private network of its own.

#include <string>
#include <vector>

namespace slewlab::tools {

// Where multicast does not work here, starts this program again inside a private network (tools/in-private-network)
// and does not return. Throws std::runtime_error, with what to do, where that is not possible either.
void need_multicast(const std::vector<std::string>& command_line);

bool in_private_network();

}  // namespace slewlab::tools
