#include "tools/commands/home.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

// The folder above the program's own: the build's, or the installation's prefix.
fs::path prefix() { return fs::read_symlink("/proc/self/exe").parent_path().parent_path(); }

bool is_home(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "config", error) && fs::is_directory(folder / "tools" / "python", error);
}

}  // namespace

fs::path home() {
  if (const char* named = std::getenv("SLEWLAB_HOME"); named != nullptr && *named != '\0') {
    if (is_home(named)) return fs::absolute(named).lexically_normal();
    throw std::runtime_error(std::string("SLEWLAB_HOME is ") + named + ", which does not hold config and tools/python");
  }
  fs::path installed = prefix() / "share" / "slewlab";
  if (is_home(installed)) return installed;
  const fs::path pointer = prefix() / "slewlab_home";
  std::string name;
  if (std::ifstream file(pointer); std::getline(file, name)) {
    const fs::path named = (prefix() / name).lexically_normal();
    if (is_home(named)) return named;
  }
  throw std::runtime_error("its own files (config, tools/python) are neither in " + installed.string() +
                           " nor where " + pointer.string() + " says; name their folder in SLEWLAB_HOME");
}

fs::path python_interpreter() {
  if (const char* named = std::getenv("SLEWLAB_PYTHON"); named != nullptr && *named != '\0') return named;
  const fs::path own = home() / ".venv" / "bin" / "python";
  const bool is_installed = home() == prefix() / "share" / "slewlab";
  return fs::exists(own) || !is_installed ? own : fs::path("/usr/bin/python3");
}

fs::path fmu_parts() {
  const fs::path built = prefix() / "fmu";
  return fs::exists(built) ? built : prefix() / "lib" / "slewlab" / "fmu";
}

fs::path python_messages() {
  const fs::path built = prefix() / "python";
  return fs::exists(built) ? built : home() / "python";
}

std::vector<std::pair<std::string, std::string>> python_environment() {
  std::vector<std::pair<std::string, std::string>> environment{{"SLEWLAB_PYTHON_MESSAGES", python_messages().string()}};
#ifdef SLEWLAB_SANITIZER_RUNTIME
  const char* options = std::getenv("ASAN_OPTIONS");
  environment.emplace_back("LD_PRELOAD", SLEWLAB_SANITIZER_RUNTIME);
  environment.emplace_back("ASAN_OPTIONS", std::string(options != nullptr ? options : "") + ":detect_leaks=0");
#endif
  return environment;
}

}  // namespace slewlab::tools
