#include "tools/commands/private_network.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "msgs/lcm_bus.h"
#include "tools/commands/home.h"

namespace slewlab::tools {
namespace {

constexpr const char* kInPrivateNetwork = "SLEWLAB_IN_PRIVATE_NETWORK";

// Returns only where that failed.
void enter_private_network(const std::vector<std::string>& command_line) {
  const std::string wrapper = (home() / "tools" / "in-private-network").string();
  std::vector<std::string> command{wrapper, std::filesystem::read_symlink("/proc/self/exe").string()};
  command.insert(command.end(), command_line.begin() + 1, command_line.end());
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  ::setenv(kInPrivateNetwork, "1", 1);
  ::execv(wrapper.c_str(), arguments.data());
  std::fprintf(stderr, "slewlab: cannot start %s: %s\n", wrapper.c_str(), std::strerror(errno));
}

}  // namespace

bool in_private_network() { return std::getenv(kInPrivateNetwork) != nullptr; }

void need_multicast(const std::vector<std::string>& command_line) {
  const std::string problem = msgs::multicast_problem(msgs::bus_url(msgs::kDefaultPort));
  if (problem.empty()) return;
  if (!in_private_network()) enter_private_network(command_line);
  throw std::runtime_error(problem);
}

}  // namespace slewlab::tools
