#pragma once

// What every fuzz target of this folder is: bytes in, and either a clean answer or the documented refusal out. A crash,
// a sanitizer's report, a hang, memory out of proportion, another exception than the documented one, or a property
// that does not hold is a finding. Built by clang with libFuzzer the target hunts for one (tools/fuzz); in the suite
// corpus_main.cpp feeds it its corpus.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/msgs/temporary_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace slewlab::fuzz {

// A property that must hold whatever the bytes are.
inline void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %s\n", property);
  std::abort();
}

inline void write_file(const std::filesystem::path& path, const void* data, std::size_t size) {
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

// A copy of config/, so that the file under test may include and name the real ones.
class ConfigurationCopy {
 public:
  ConfigurationCopy() {
    std::filesystem::copy(SLEWLAB_SOURCE_DIR "/config", folder_.path(), std::filesystem::copy_options::recursive);
  }
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace slewlab::fuzz
