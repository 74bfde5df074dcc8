#include "tools/commands/output_folder.h"

#include <string>
#include <system_error>

#include "common/input_error.h"

namespace slewlab::tools {

namespace fs = std::filesystem;

void make_output_folder(const fs::path& folder, const char* option) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (fs::is_directory(folder, error)) return;
  fs::path nearest = folder;
  while (nearest.has_parent_path() && nearest != nearest.parent_path() && !fs::exists(nearest, error)) nearest = nearest.parent_path();
  const bool is_in_the_way = fs::exists(nearest, error) && !fs::is_directory(nearest, error);
  const std::string why = is_in_the_way ? nearest == folder ? ", which is a file" : ", of which " + nearest.string() + " is a file"
                                        : ", which cannot be made (is it yours to write?)";
  throw common::InputError({{{option, 0, 0}, "", "'" + folder.string() + "'" + why, "the name of a folder, there or not"}});
}

void make_folder_of(const fs::path& file, const char* option) {
  if (file.empty()) return;
  std::error_code error;
  if (!file.has_filename() || fs::is_directory(file, error)) {
    throw common::InputError({{{option, 0, 0}, "", "'" + file.string() + "', which is a folder", "the name of a file to write"}});
  }
  if (file.has_parent_path()) make_output_folder(file.parent_path(), option);
}

}  // namespace slewlab::tools
