#include "msgs/memory_bus.h"

#include <algorithm>
#include <utility>

namespace slewlab::msgs {

std::unique_ptr<MemoryBus> MemoryWire::connect() {
  std::unique_ptr<MemoryBus> party(new MemoryBus(*this));
  parties_.push_back(party.get());
  return party;
}

MemoryBus::~MemoryBus() { std::erase(wire_.parties_, this); }

void MemoryBus::publish(const char* channel, Bytes bytes) {
  const std::string name = channel;
  std::vector<std::uint8_t> arriving(bytes.begin(), bytes.end());
  const int copies = wire_.copies ? wire_.copies(name, arriving) : 1;
  for (MemoryBus* party : wire_.parties_) {
    for (const auto& subscription : party->subscriptions_) {
      if (subscription->channel != name) continue;
      for (int i = 0; i < copies; ++i) party->queue_.push_back({subscription.get(), arriving});
    }
  }
}

void MemoryBus::subscribe(const char* channel, Handler handler) {
  subscriptions_.push_back(std::make_unique<Subscription>(Subscription{channel, std::move(handler)}));
}

bool MemoryBus::handle_one(std::chrono::milliseconds timeout) {
  if (queue_.empty() && timeout.count() > 0 && on_wait) on_wait();
  if (queue_.empty()) {
    waited += timeout;
    return false;
  }
  const Message message = std::move(queue_.front());
  queue_.pop_front();
  message.subscription->handler(message.bytes);
  return true;
}

}  // namespace slewlab::msgs
