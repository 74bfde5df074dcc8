#include "msgs/bus.h"

namespace slewlab::msgs {

int Bus::drain() {
  int handled = 0;
  while (handle_one(std::chrono::milliseconds{0})) ++handled;
  return handled;
}

}  // namespace slewlab::msgs
