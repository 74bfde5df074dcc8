#include "msgs/lcm_bus.h"

#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

namespace slewlab::msgs {
namespace {

constexpr const char* kGroup = "239.255.76.67";  // LCM's own default group

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

// The signals of a process belong to its main thread: LCM's hidden thread is born with all of them blocked.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

std::string group_of(const std::string& url) {
  const std::size_t begin = url.find("://") + 3;
  const std::size_t end = url.find_first_of(":/?", begin);
  const std::string group = url.substr(begin, end == std::string::npos ? end : end - begin);
  return group.empty() ? kGroup : group;
}

std::string problem_text(const std::string& group, const std::string& what) {
  return "LCM's multicast group " + group + " cannot be used on this machine: " + what +
         ". As root, give it a way over the loopback:\n"
         "  ip link set lo multicast on\n"
         "  ip route add 224.0.0.0/4 dev lo\n"
         "or start the command inside a private network: tools/in-private-network CMD...";
}

class LcmBus : public Bus {
 public:
  explicit LcmBus(const std::string& url) {
    const SignalsBlocked blocked;
    lcm_ = lcm_create(url.c_str());
    if (lcm_ == nullptr) {
      throw BusError("LCM cannot open the bus '" + url + "'; a bus looks like " + bus_url(kDefaultPort));
    }
  }
  ~LcmBus() override { lcm_destroy(lcm_); }
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  void publish(const char* channel, Bytes bytes) override {
    if (lcm_publish(lcm_, channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
      throw BusError(std::string("LCM cannot send on ") + channel + ": " + std::strerror(errno));
    }
  }

  void subscribe(const char* channel, Handler handler) override {
    const SignalsBlocked blocked;  // the first subscription starts LCM's thread
    subscriptions_.push_back(std::make_unique<Subscription>(this, std::move(handler)));
    lcm_subscription_t* made = lcm_subscribe(lcm_, channel, &LcmBus::receive, subscriptions_.back().get());
    if (made == nullptr) throw BusError(std::string("LCM cannot subscribe to ") + channel);
    lcm_subscription_set_queue_capacity(made, 0);
  }

  bool handle_one(std::chrono::milliseconds timeout) override {
    errno = 0;
    const int result = lcm_handle_timeout(lcm_, static_cast<int>(timeout.count()));
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    if (result < 0 && errno != EINTR) {
      throw BusError(std::string("LCM cannot receive: ") + std::strerror(errno));
    }
    return result > 0;
  }

 private:
  struct Subscription {
    Subscription(LcmBus* owner, Handler function) : bus(owner), handler(std::move(function)) {}
    LcmBus* bus;
    Handler handler;
  };

  // No exception may pass through LCM's C code: it is kept and thrown again behind it.
  static void receive(const lcm_recv_buf_t* buffer, const char*, void* user) {
    auto* subscription = static_cast<Subscription*>(user);
    try {
      subscription->handler(Bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size));
    } catch (...) {
      subscription->bus->failure_ = std::current_exception();
    }
  }

  lcm_t* lcm_ = nullptr;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::exception_ptr failure_;
};

}  // namespace

std::string bus_url(int port) {
  return std::string("udpm://") + kGroup + ":" + std::to_string(port) + "?ttl=0";
}

std::string multicast_problem(const std::string& url) {
  if (url.rfind("udpm://", 0) != 0) return {};
  const std::string group = group_of(url);

  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(address.sin_addr.s_addr))) {
    return "'" + url + "' names no multicast group; a bus looks like " + bus_url(kDefaultPort);
  }

  const Socket receiver;
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t length = sizeof any;
  if (::bind(receiver.fd(), reinterpret_cast<sockaddr*>(&any), sizeof any) != 0 ||
      ::getsockname(receiver.fd(), reinterpret_cast<sockaddr*>(&any), &length) != 0) {
    return problem_text(group, std::strerror(errno));
  }
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  if (::setsockopt(receiver.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0) {
    return problem_text(group, std::string("there is no route to it (") + std::strerror(errno) + ")");
  }

  const Socket sender;
  const unsigned char ttl = 0;
  ::setsockopt(sender.fd(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  address.sin_port = any.sin_port;
  const char probe[] = "slewlab";
  if (::sendto(sender.fd(), probe, sizeof probe, 0, reinterpret_cast<sockaddr*>(&address), sizeof address) < 0) {
    return problem_text(group, std::string("there is no route to it (") + std::strerror(errno) + ")");
  }
  constexpr int kProbePatience = 500;  // [ms]; on a working loopback the packet is there within microseconds
  pollfd waiting{receiver.fd(), POLLIN, 0};
  if (::poll(&waiting, 1, kProbePatience) != 1) {
    return problem_text(group, "a packet sent to it does not come back");
  }
  return {};
}

std::unique_ptr<Bus> open_lcm_bus(const std::string& url) {
  const std::string problem = multicast_problem(url);
  if (!problem.empty()) throw BusError(problem);
  return std::make_unique<LcmBus>(url);
}

ReservedPort::ReservedPort() {
  // Bound to the loopback's own address, it keeps the number without ever receiving the group's packets. Bound
  // without SO_REUSEADDR it gets a number nobody has; with the option set afterwards LCM may bind it as well.
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
