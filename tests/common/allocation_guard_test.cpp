#include "tests/common/allocation_guard.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace slewlab::tests {
namespace {

// Hides a pointer from the optimiser, which may otherwise remove a pair of new and delete.
void keep(void* pointer) { asm volatile("" : : "g"(pointer) : "memory"); }

TEST(AllocationGuard, CountsOperatorNew) {
  const AllocationGuard guard;
  const auto owned = std::make_unique<double>(1.0);
  keep(owned.get());
  EXPECT_EQ(guard.count(), 1);
}

TEST(AllocationGuard, CountsAGrowingVector) {
  std::vector<double> values;
  values.reserve(2);
  values.assign(2, 0.0);
  const AllocationGuard guard;
  values.back() = 1.0;
  EXPECT_EQ(guard.count(), 0);
  values.push_back(2.0);
  keep(values.data());
  EXPECT_EQ(guard.count(), 1);
}

TEST(AllocationGuard, CountsTheCFunctions) {
  const AllocationGuard guard;
  void* const block = std::malloc(16);
  keep(block);
  void* const grown = std::realloc(block, 32);
  keep(grown);
  void* const zeroed = std::calloc(2, 8);
  keep(zeroed);
  EXPECT_EQ(guard.count(), 3);
  std::free(grown);
  std::free(zeroed);
}

#ifndef SLEWLAB_SANITIZED  // the thread sanitizer does not tell of these
TEST(AllocationGuard, CountsAlignedMemory) {
  const AllocationGuard guard;
  void* const aligned = std::aligned_alloc(64, 64);
  keep(aligned);
  EXPECT_EQ(guard.count(), 1);
  std::free(aligned);
}
#endif

TEST(AllocationGuard, CountsNothingWhereNothingIsTaken) {
  const AllocationGuard guard;
  volatile double sum = 0.0;
  for (int i = 0; i < 100; ++i) sum = sum + i;
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace slewlab::tests
