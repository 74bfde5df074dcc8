#pragma once

// The bus over LCM's UDP multicast that does not leave the host: udpm://239.255.76.67:PORT?ttl=0.
//
// It speaks LCM's protocol (datagrams "LC02") on sockets of its own instead of going through liblcm, so
// every LCM program and library is a party to the same bus (tested both ways), while here
// - the thread that waits is the one that reads: liblcm's hidden reader thread costs two more changes of
//   thread in every round trip (tests/benchmarks/lockstep_benchmark shows both), and stands in the way of
//   real-time priorities;
// - the socket's buffer is large and nothing is dropped behind it; liblcm drops the newest message at 30 by
//   default;
// - groups of other buses on the same port are not heard (liblcm 1.3.1 hears them; still, one port per bus);
// - a machine without a working multicast route is told so at once, with the commands that give it one;
//   liblcm's self-test takes ten seconds and says little.
// Messages of more than one datagram (64 KiB) are neither sent nor received.

#include <memory>
#include <string>

#include "msgs/bus.h"

namespace slewlab::msgs {

inline constexpr int kDefaultPort = 7667;  // LCM's own default

std::string bus_url(int port);

// Empty if multicast works here, otherwise what is wrong and how to mend it.
std::string multicast_problem(const std::string& url);

// Throws BusError.
std::unique_ptr<Bus> open_lcm_bus(const std::string& url);

// A port for a bus of one's own, kept from other runs for as long as this object lives.
class ReservedPort {
 public:
  ReservedPort();  // throws BusError
  ~ReservedPort();
  ReservedPort(const ReservedPort&) = delete;
  ReservedPort& operator=(const ReservedPort&) = delete;

  int number() const { return number_; }

 private:
  int socket_;
  int number_;
};

}  // namespace slewlab::msgs
