// What tasks leave on the heap. A program of its own, for the guard replaces malloc.

#include <gtest/gtest.h>

#include "tests/common/allocation_guard.h"
#include "tests/msgs/temporary_folder.h"
#include "tools/soak/task_run.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

// The same task takes the same number of allocations every time, and nothing of them stays: 100 tasks may fill the
// allocator's own bins of freed blocks, which count as in use, and leave less than 160 bytes each.
TEST(TaskRun, LeavesNothingOnTheHeap) {
#ifdef SLEWLAB_SANITIZED
  GTEST_SKIP() << "the sanitizer's allocator does not count here";
#endif
  const TemporaryFolder folder;
  const fs::path config = fs::path(SLEWLAB_SOURCE_DIR) / "config";
  SoakPlan plan;
  plan.crane = config / "cranes/thesis.yaml";
  plan.controller = config / "controllers/thesis.yaml";
  plan.settings = load_soak_settings(config / "soak/thesis.yaml", {{"task.duration", "2"}});
  const auto go_on = [] { return false; };
  run_task(plan, 0, folder.path() / "run", go_on);
  const MemoryUse before = memory_use();
  constexpr int kTasks = 100;
  long once = 0;
  for (int i = 0; i < kTasks; ++i) {
    const tests::AllocationGuard guard;
    run_task(plan, 0, folder.path() / "run", go_on);
    if (i == 0) once = guard.count();
    EXPECT_EQ(guard.count(), once);
  }
  EXPECT_LE(memory_use().heap - before.heap, 16);  // [kB]
}

}  // namespace
}  // namespace slewlab::tools
