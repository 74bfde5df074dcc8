// Any text as a file of acceptance limits: limits that are numbers, or problems that say where.

#include <cmath>

#include "common/input_error.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/acceptance/limits.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slewlab;
  static const TemporaryFolder folder;
  static const std::filesystem::path path = folder.path() / "limits.yaml";
  fuzz::write_file(path, data, size);
  try {
    const tools::AcceptanceLimits limits = tools::load_acceptance_limits(path);
    fuzz::require(limits.top_speed > 0.0 && std::isfinite(limits.top_speed), "the top speed is a positive number");
  } catch (const common::InputError&) {
  }
  return 0;
}
