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
    for (const auto& entry : party->entries_) {
      if (entry->channel != name) continue;
      for (int i = 0; i < copies; ++i) party->queue_.push_back({entry, arriving});
    }
  }
}

Bus::SubscriptionId MemoryBus::subscribe(const char* channel, Handler handler) {
  entries_.push_back(std::make_shared<const Entry>(Entry{next_id_, channel, std::move(handler)}));
  return next_id_++;
}

void MemoryBus::unsubscribe(SubscriptionId subscription) {
  std::erase_if(entries_, [&](const auto& entry) { return entry->id == subscription; });
  std::erase_if(queue_, [&](const Message& message) { return message.entry->id == subscription; });
}

bool MemoryBus::handle_one(std::chrono::milliseconds timeout) {
  if (queue_.empty() && timeout.count() > 0 && on_wait) on_wait();
  if (queue_.empty()) {
    waited += timeout;
    return false;
  }
  const Message message = std::move(queue_.front());
  queue_.pop_front();
  message.entry->handler(message.bytes);
  return true;
}

}  // namespace slewlab::msgs
