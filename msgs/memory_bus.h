#pragma once

// A bus inside one process, for tests: every message goes to the queue of every party that subscribed to
// its channel, the sender included, as LCM does it. Nothing waits and no clock runs: a party that would
// wait calls its `on_wait` first (run the other side there), and if still nothing came, the wait counts as
// timed out.

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "msgs/bus.h"

namespace slewlab::msgs {

class MemoryBus;

// Joins the parties. Must outlive them.
class MemoryWire {
 public:
  std::unique_ptr<MemoryBus> connect();

  // Asked for every message: how many copies arrive (0 lost, 1 as sent, 2 duplicated). May change the bytes.
  std::function<int(const std::string& channel, std::vector<std::uint8_t>& bytes)> copies;

 private:
  friend class MemoryBus;
  std::vector<MemoryBus*> parties_;
};

class MemoryBus : public Bus {
 public:
  ~MemoryBus() override;

  void publish(const char* channel, Bytes bytes) override;
  SubscriptionId subscribe(const char* channel, Handler handler) override;
  void unsubscribe(SubscriptionId subscription) override;
  bool handle_one(std::chrono::milliseconds timeout) override;

  std::function<void()> on_wait;
  std::chrono::milliseconds waited{0};  // the virtual clock: sum of the waits that timed out

 private:
  friend class MemoryWire;
  explicit MemoryBus(MemoryWire& wire) : wire_(wire) {}

  struct Entry {
    SubscriptionId id;
    std::string channel;
    Handler handler;
  };
  struct Message {
    std::shared_ptr<const Entry> entry;  // shared: a handler may end its own subscription
    std::vector<std::uint8_t> bytes;
  };

  MemoryWire& wire_;
  std::vector<std::shared_ptr<const Entry>> entries_;
  SubscriptionId next_id_ = 0;
  std::deque<Message> queue_;
};

}  // namespace slewlab::msgs
