// A folder of findings: all files of one answer, or none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slewlab::tools {

// Where the disk is full, or the work ends before keep(), everything that was written goes again.
class FindingsFolder {
 public:
  explicit FindingsFolder(std::filesystem::path folder);
  ~FindingsFolder();
  FindingsFolder(const FindingsFolder&) = delete;
  FindingsFolder& operator=(const FindingsFolder&) = delete;

  void write(const std::string& name, const std::string& text);
  void keep() { is_whole_ = true; }

 private:
  std::filesystem::path folder_;
  bool is_new_;
  bool is_whole_ = false;
  std::vector<std::filesystem::path> written_;
};

// A file as one in the folder names it: by the way there, so that both may be moved together.
std::string seen_from(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace slewlab::tools
