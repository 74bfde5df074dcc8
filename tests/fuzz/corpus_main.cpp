// Feeds every file of the folders given to the fuzz target that this is linked with, and of each file also beginnings
// cut off at 32 places. For the suite, where there is no libFuzzer.

#include <algorithm>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  constexpr std::size_t kCuts = 32;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : fs::directory_iterator(argv[i])) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    std::fprintf(stderr, "no corpus\n");
    return 1;
  }
  for (const fs::path& path : files) {
    std::printf("%s\n", path.c_str());
    std::fflush(stdout);  // the last one named is the one that failed
    std::vector<std::uint8_t> bytes(fs::file_size(path));
    std::ifstream(path, std::ios::binary)
        .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    for (std::size_t cut = 0; cut < std::min(kCuts, bytes.size()); ++cut) {
      // A copy of its own, so that the address sanitizer sees a read beyond the cut.
      const std::vector<std::uint8_t> beginning(bytes.begin(), bytes.begin() + bytes.size() * cut / kCuts);
      LLVMFuzzerTestOneInput(beginning.data(), beginning.size());
    }
  }
  std::printf("%zu files\n", files.size());
  return 0;
}
