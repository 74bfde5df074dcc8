#include "tools/commands/python_command.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "tools/commands/home.h"

namespace slewlab::tools {

int call_python(const std::string& script, const std::vector<std::string>& arguments) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {
    std::fprintf(stderr, "slewlab: cannot start %s: %s\n", script.c_str(), std::strerror(errno));
    return 1;
  }
  if (child == 0) ::_exit(run_python(script, arguments));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int run_python(const std::string& script, const std::vector<std::string>& arguments) {
  const std::string python = python_interpreter().string();
  const std::string launcher = (home() / "tools" / "python" / "launch.py").string();  // which ends by one line at Ctrl-C
  std::vector<char*> words{const_cast<char*>(python.c_str()), const_cast<char*>(launcher.c_str()), const_cast<char*>(script.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  for (const auto& [name, value] : python_environment()) ::setenv(name.c_str(), value.c_str(), 1);
  ::setenv("SLEWLAB_PROGRAM", std::filesystem::read_symlink("/proc/self/exe").c_str(), 1);
  ::execv(python.c_str(), words.data());
  std::fprintf(stderr, "slewlab: %s: %s; tools/setup makes it in the source tree, SLEWLAB_PYTHON names another interpreter\n", python.c_str(), std::strerror(errno));
  return 1;
}

}  // namespace slewlab::tools
