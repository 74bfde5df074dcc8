#include "tools/commands/python_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace slewlab::tools {

int run_python(const std::string& script, const std::vector<std::string>& arguments) {
  const std::string python = SLEWLAB_SOURCE_DIR "/.venv/bin/python";
  const std::string program = SLEWLAB_SOURCE_DIR "/tools/python/" + script;
  std::vector<char*> words{const_cast<char*>(python.c_str()), const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::setenv("SLEWLAB_PYTHON_MESSAGES", SLEWLAB_BINARY_DIR "/python", 1);
  ::execv(python.c_str(), words.data());
  std::fprintf(stderr, "slewlab: %s: %s; tools/setup makes it\n", python.c_str(), std::strerror(errno));
  return 1;
}

}  // namespace slewlab::tools
