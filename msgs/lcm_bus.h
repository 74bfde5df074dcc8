#pragma once

// The bus over LCM, normally UDP multicast that does not leave the host: udpm://239.255.76.67:PORT?ttl=0.
// - One port per bus: LCM 1.3.1 hears every group on a port.
// - Every subscription's queue is unlimited; LCM's default drops the newest message silently at 30.
// - A machine without a working multicast route is reported at once, with the commands that give it one;
//   LCM's own self-test would take ten seconds and say little.

#include <memory>
#include <string>

#include "msgs/bus.h"

namespace slewlab::msgs {

inline constexpr int kDefaultPort = 7667;  // LCM's own default

std::string bus_url(int port);

// Empty if multicast works here, otherwise what is wrong and how to mend it. Other than udpm:// is not tested.
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
