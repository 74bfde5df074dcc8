#pragma once

// The bus: named channels that carry bytes between processes. LcmBus is the real one, MemoryBus joins several
// parties inside one process without a network, for tests. One thread may handle.

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>

#include "msgs/codec.h"

namespace slewlab::msgs {

// The bus cannot be opened or cannot send; the text says what to do.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Bus {
 public:
  using Handler = std::function<void(Bytes)>;

  virtual ~Bus() = default;

  virtual void publish(const char* channel, Bytes bytes) = 0;
  virtual void subscribe(const char* channel, Handler handler) = 0;

  // Gives the oldest message that waits to its handler. With none waiting, waits up to `timeout` for one.
  // False where none came (or a signal ended the wait). What the handler throws comes out here.
  virtual bool handle_one(std::chrono::milliseconds timeout) = 0;

  // Handles everything that waits, without waiting for more; the number of messages.
  int drain();
};

}  // namespace slewlab::msgs
