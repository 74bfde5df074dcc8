#include "tools/commands/log_path.h"

#include <string>

namespace slewlab::tools {

std::filesystem::path log_in(const std::filesystem::path& given) {
  if (!std::filesystem::exists(given)) throw common::InputError({{{given.string(), 0, 0}, "", "no file or folder of that name", "a log, or the folder of a run"}});
  if (!std::filesystem::is_directory(given)) return given;
  for (const char* name : {"run.lcmlog", "run.lcmlog.partial"}) {
    if (std::filesystem::exists(given / name)) return given / name;
  }
  throw common::InputError({{{given.string(), 0, 0}, "", "a folder without run.lcmlog", "a log, or the folder of a run"}});
}

common::InputError no_log(const std::filesystem::path& log, const std::exception& why) {
  return common::InputError({{{"LOG", 0, 0}, "", "'" + log.string() + "' (" + std::string(why.what()) + ")", "the log of a run"}});
}

}  // namespace slewlab::tools
