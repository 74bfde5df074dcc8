// Counts what a piece of code takes from the heap: operator new and the C allocation functions, by the
// calling thread, between the guard's construction and the question.
//
//   AllocationGuard guard;
//   step(...);
//   EXPECT_EQ(guard.count(), 0);
//
// Include it in exactly ONE source file of a test program: it replaces malloc and its kin for the whole
// program. The sanitizers, which replace them themselves, are asked for what they give.
#pragma once

#include <cstddef>
#include <cstdlib>

namespace slewlab::tests {

inline thread_local long allocation_count = 0;

class AllocationGuard {
 public:
  AllocationGuard() : before_(allocation_count) {}
  long count() const { return allocation_count - before_; }

 private:
  long before_;
};

}  // namespace slewlab::tests

#ifndef SLEWLAB_SANITIZED

// glibc's own allocation functions under the names by which a replacement may call them.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) noexcept {
  ++slewlab::tests::allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++slewlab::tests::allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++slewlab::tests::allocation_count;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++slewlab::tests::allocation_count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  ++slewlab::tests::allocation_count;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;  // ENOMEM
}
}

#else

#include <sanitizer/allocator_interface.h>

namespace slewlab::tests {
inline const int hooks_installed = __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { ++allocation_count; }, [](const volatile void*) {});
}

#endif
