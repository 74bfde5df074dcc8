#include "tools/commands/findings.h"

#include <system_error>
#include <utility>

#include "tools/commands/output_folder.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {

FindingsFolder::FindingsFolder(std::filesystem::path folder) : folder_(std::move(folder)), is_new_(!std::filesystem::exists(folder_)) {
  make_output_folder(folder_);
}

FindingsFolder::~FindingsFolder() {
  if (is_whole_) return;
  std::error_code ignored;
  for (const std::filesystem::path& file : written_) std::filesystem::remove(file, ignored);
  if (is_new_) std::filesystem::remove(folder_, ignored);
}

void FindingsFolder::write(const std::string& name, const std::string& text) {
  write_whole_file(folder_ / name, text);
  written_.push_back(folder_ / name);
}

std::string seen_from(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::filesystem::proximate(std::filesystem::weakly_canonical(file), std::filesystem::weakly_canonical(folder)).string();
}

}  // namespace slewlab::tools
