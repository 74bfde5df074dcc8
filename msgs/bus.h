#pragma once

// The bus: named channels that carry bytes between processes. LcmBus is the real one, MemoryBus joins several
// parties inside one process without a network, for tests. One thread may handle, subscribe and unsubscribe.

#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "msgs/codec.h"

namespace slewlab::msgs {

// The bus cannot be opened or cannot send; the text says what to do.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The address is none.
class BusUrlError : public BusError {
 public:
  using BusError::BusError;
};

class Bus {
 public:
  using Handler = std::function<void(Bytes)>;

  virtual ~Bus() = default;

  virtual void publish(const char* channel, Bytes bytes) = 0;

  // Names a subscription of one bus; no two of a bus are equal.
  using SubscriptionId = std::int64_t;
  virtual SubscriptionId subscribe(const char* channel, Handler handler) = 0;
  // From here on its handler is not called any more, not for what waits either. A handler may end any subscription, its
  // own included. An id that is not (or no longer) subscribed is left alone.
  virtual void unsubscribe(SubscriptionId subscription) = 0;

  // Gives the oldest message that waits to its handler. With none waiting, waits up to `timeout` for one.
  // False where none came (or a signal ended the wait). What the handler throws comes out here.
  virtual bool handle_one(std::chrono::milliseconds timeout) = 0;

  // Handles everything that waits, without waiting for more; the number of messages.
  int drain();
};

// A subscription that ends with this object, which the bus must outlive.
class Subscription {
 public:
  Subscription(Bus& bus, const char* channel, Bus::Handler handler)
      : bus_(bus), id_(bus.subscribe(channel, std::move(handler))) {}
  ~Subscription() { bus_.unsubscribe(id_); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

 private:
  Bus& bus_;
  Bus::SubscriptionId id_;
};

}  // namespace slewlab::msgs
