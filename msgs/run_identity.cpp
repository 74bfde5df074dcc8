#include "msgs/run_identity.h"

#include <unistd.h>

#include <chrono>
#include <string>

#include "msgs/configuration_hash.h"

namespace slewlab::msgs {

// The hash of a text serves for the identity, too: any 64 bits that differ where their origin differs.
std::int64_t run_identity(std::int64_t configuration_hash, std::int64_t number) {
  return msgs::configuration_hash("run " + std::to_string(number) + " of " + hash_text(configuration_hash));
}

std::int64_t fresh_run_identity() {
  // Two processes may start at one instant; one process number returns only later.
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return configuration_hash("process " + std::to_string(::getpid()) + " at " +
                            std::to_string(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()));
}

}  // namespace slewlab::msgs
