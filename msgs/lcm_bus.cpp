#include "msgs/lcm_bus.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <vector>

#include "msgs/datagram.h"

namespace slewlab::msgs {
namespace {

constexpr const char* kGroup = "239.255.76.67";  // LCM's own default group

constexpr std::size_t kLargestDatagram = 65'507;     // [bytes] of UDP over IPv4
constexpr std::size_t kLongestChannel = 63;          // LCM_MAX_CHANNEL_NAME_LENGTH

// Room for everything that may arrive while this side does not run; the system may grant less.
constexpr int kReceiveBuffer = 4 << 20;  // [bytes]

// Datagrams nobody here has asked for that one call passes over, so that a flood of them does not hold it.
constexpr int kMostSkipped = 1000;

class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (fd_ < 0) throw BusError(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  }
  ~Socket() { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

std::string problem_text(const std::string& group, const std::string& what) {
  return "LCM's multicast group " + group + " cannot be used on this machine: " + what +
         ". As root, give it a way over the loopback:\n"
         "  ip link set lo multicast on\n"
         "  ip route add 224.0.0.0/4 dev lo\n"
         "or start the command inside a private network: tools/in-private-network CMD...";
}

// udpm://GROUP:PORT?ttl=TTL, each part optional.
struct Address {
  sockaddr_in group{};
  int ttl = 0;
};

Address parse(const std::string& url) {
  const auto refuse = [&](const std::string& what) -> BusUrlError {
    return BusUrlError("'" + url + "' is no bus: " + what + "; a bus looks like " + bus_url(kDefaultPort));
  };
  constexpr std::string_view kScheme = "udpm://";
  if (url.rfind(kScheme, 0) != 0) throw refuse("it does not begin with udpm://");
  std::string_view rest = std::string_view(url).substr(kScheme.size());
  std::string_view query;
  if (const std::size_t mark = rest.find('?'); mark != std::string_view::npos) {
    query = rest.substr(mark + 1);
    rest = rest.substr(0, mark);
  }
  const auto number = [&](std::string_view text, int lowest, int highest, const char* what) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < lowest || value > highest) {
      throw refuse(std::string(what) + " must be a number from " + std::to_string(lowest) + " to " +
                   std::to_string(highest));
    }
    return value;
  };
  Address address;
  int port = kDefaultPort;
  if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
    port = number(rest.substr(colon + 1), 1, 65535, "the port");
    rest = rest.substr(0, colon);
  }
  const std::string group(rest.empty() ? kGroup : rest);
  address.group.sin_family = AF_INET;
  address.group.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, group.c_str(), &address.group.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(address.group.sin_addr.s_addr))) {
    throw refuse(group + " is no multicast group");
  }
  while (!query.empty()) {
    const std::string_view option = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), option.size() + 1));
    if (option.rfind("ttl=", 0) == 0) {
      address.ttl = number(option.substr(4), 0, 255, "ttl");
    } else {
      throw refuse("of the options only ttl is known");
    }
  }
  return address;
}

void join(const Socket& socket, in_addr group) {
  ip_mreq membership{};
  membership.imr_multiaddr = group;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  if (::setsockopt(socket.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0) {
    char name[INET_ADDRSTRLEN];
    throw BusError(problem_text(inet_ntop(AF_INET, &group, name, sizeof name),
                                std::string("there is no route to it (") + std::strerror(errno) + ")"));
  }
}

void set_ttl(const Socket& socket, int ttl) {
  const auto value = static_cast<unsigned char>(ttl);
  ::setsockopt(socket.fd(), IPPROTO_IP, IP_MULTICAST_TTL, &value, sizeof value);
}

// Sends a packet to the group on a port of its own and waits for it to come back.
void probe(const Address& address) {
  char name[INET_ADDRSTRLEN];
  const std::string group = inet_ntop(AF_INET, &address.group.sin_addr, name, sizeof name);
  const Socket receiver;
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t length = sizeof any;
  if (::bind(receiver.fd(), reinterpret_cast<sockaddr*>(&any), sizeof any) != 0 ||
      ::getsockname(receiver.fd(), reinterpret_cast<sockaddr*>(&any), &length) != 0) {
    throw BusError(problem_text(group, std::strerror(errno)));
  }
  join(receiver, address.group.sin_addr);

  const Socket sender;
  set_ttl(sender, address.ttl);
  sockaddr_in target = address.group;
  target.sin_port = any.sin_port;
  const char packet[] = "slewlab";
  if (::sendto(sender.fd(), packet, sizeof packet, 0, reinterpret_cast<sockaddr*>(&target), sizeof target) < 0) {
    throw BusError(problem_text(group, std::string("there is no route to it (") + std::strerror(errno) + ")"));
  }
  constexpr int kProbePatience = 500;  // [ms]; on a working loopback the packet is there within microseconds
  pollfd waiting{receiver.fd(), POLLIN, 0};
  if (::poll(&waiting, 1, kProbePatience) != 1) {
    throw BusError(problem_text(group, "a packet sent to it does not come back"));
  }
}

class LcmBus : public Bus {
 public:
  explicit LcmBus(const Address& address) : target_(address.group), datagram_(kLargestDatagram) {
    const int on = 1;
    const int off = 0;
    // Other programs on this machine hear the same bus.
    ::setsockopt(receiver_.fd(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    // Without this a socket hears every group that anyone on the machine has joined.
    ::setsockopt(receiver_.fd(), IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off);
    if (::setsockopt(receiver_.fd(), SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBuffer, sizeof kReceiveBuffer) != 0) {
      ::setsockopt(receiver_.fd(), SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
    }
    sockaddr_in any = address.group;
    any.sin_addr.s_addr = htonl(INADDR_ANY);
    if (::bind(receiver_.fd(), reinterpret_cast<sockaddr*>(&any), sizeof any) != 0) {
      throw BusError("cannot open UDP port " + std::to_string(ntohs(any.sin_port)) + ": " + std::strerror(errno));
    }
    join(receiver_, address.group.sin_addr);
    set_ttl(sender_, address.ttl);
  }

  void publish(const char* channel, Bytes bytes) override {
    const std::size_t channel_bytes = std::strlen(channel) + 1;
    std::uint32_t head[2] = {htonl(kDatagramWord), htonl(number_++)};
    std::array<iovec, 3> parts{{{head, kDatagramHeadBytes},
                                {const_cast<char*>(channel), channel_bytes},
                                {const_cast<std::uint8_t*>(bytes.data()), bytes.size()}}};
    msghdr message{};
    message.msg_name = &target_;
    message.msg_namelen = sizeof target_;
    message.msg_iov = parts.data();
    message.msg_iovlen = parts.size();
    while (::sendmsg(sender_.fd(), &message, 0) < 0) {
      if (errno == EINTR) continue;
      throw BusError(std::string("cannot send on ") + channel + ": " + std::strerror(errno));
    }
  }

  SubscriptionId subscribe(const char* channel, Handler handler) override {
    if (std::strlen(channel) > kLongestChannel) throw BusError(std::string("channel name too long: ") + channel);
    entries_.push_back(std::make_shared<const Entry>(Entry{next_id_, channel, std::move(handler)}));
    return next_id_++;
  }

  void unsubscribe(SubscriptionId subscription) override {
    const auto ended = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const auto& entry) { return entry && entry->id == subscription; });
    if (ended == entries_.end()) return;
    if (delivering_ > 0) {
      ended->reset();  // the places of the others stay until the message is delivered to all
    } else {
      entries_.erase(ended);
    }
  }

  bool handle_one(std::chrono::milliseconds timeout) override {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    for (int skipped = 0; skipped < kMostSkipped; ++skipped) {
      const ssize_t size = ::recv(receiver_.fd(), datagram_.data(), datagram_.size(), MSG_DONTWAIT);
      if (size >= 0) {
        // What nobody here has asked for, our own messages first of all, does not count.
        if (deliver(static_cast<std::size_t>(size))) return true;
        continue;
      }
      if (errno == EINTR) return false;
      if (errno != EAGAIN) throw BusError(std::string("cannot receive: ") + std::strerror(errno));
      const auto left = std::chrono::duration_cast<std::chrono::microseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) return false;
      pollfd waiting{receiver_.fd(), POLLIN, 0};
      const int wait = static_cast<int>((left.count() + 999) / 1000);
      if (::poll(&waiting, 1, wait) < 0 && errno == EINTR) return false;
    }
    return false;
  }

 private:
  struct Entry {
    SubscriptionId id;
    std::string channel;
    Handler handler;
  };

  // Handlers may subscribe and unsubscribe.
  bool deliver(std::size_t size) {
    const std::optional<Datagram> datagram = read_datagram(Bytes(datagram_.data(), size));
    if (!datagram) return false;
    const Delivery delivery(*this);
    bool delivered = false;
    for (std::size_t i = 0, count = entries_.size(); i < count; ++i) {
      const std::shared_ptr<const Entry> entry = entries_[i];  // shared: it may end itself
      if (!entry || entry->channel != datagram->channel) continue;
      entry->handler(datagram->data);
      delivered = true;
    }
    return delivered;
  }

  // Clears away what ended meanwhile, also where a handler threw.
  class Delivery {
   public:
    explicit Delivery(LcmBus& bus) : bus_(bus) { ++bus_.delivering_; }
    ~Delivery() {
      if (--bus_.delivering_ == 0) std::erase(bus_.entries_, nullptr);
    }
    Delivery(const Delivery&) = delete;
    Delivery& operator=(const Delivery&) = delete;

   private:
    LcmBus& bus_;
  };

  sockaddr_in target_;
  Socket sender_;
  Socket receiver_;
  std::uint32_t number_ = 0;
  std::vector<std::shared_ptr<const Entry>> entries_;  // none: ended during a delivery
  SubscriptionId next_id_ = 0;
  int delivering_ = 0;
  std::vector<std::uint8_t> datagram_;
};

}  // namespace

std::string bus_url(int port) {
  return std::string("udpm://") + kGroup + ":" + std::to_string(port) + "?ttl=0";
}

std::string multicast_problem(const std::string& url) {
  try {
    probe(parse(url));
    return {};
  } catch (const BusError& error) {
    return error.what();
  }
}

std::unique_ptr<Bus> open_lcm_bus(const std::string& url) {
  const Address address = parse(url);
  probe(address);
  return std::make_unique<LcmBus>(address);
}

ReservedPort::ReservedPort() {
  // Bound to the loopback's own address, it keeps the number without ever receiving the group's packets.
  // Bound without SO_REUSEADDR it gets a number nobody has; with the option set afterwards others may bind
  // it as well.
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  const int reuse = 1;
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse) != 0) {
    const std::string reason = std::strerror(errno);
    if (socket_ >= 0) ::close(socket_);
    throw BusError("cannot reserve a UDP port on the loopback: " + reason);
  }
  number_ = ntohs(address.sin_port);
}

ReservedPort::~ReservedPort() { ::close(socket_); }

}  // namespace slewlab::msgs
