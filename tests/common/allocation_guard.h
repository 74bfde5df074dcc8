// Counts what a piece of code takes from the heap: operator new and the C allocation functions, by the
// calling thread, between the guard's construction and the question.
//
//   AllocationGuard guard;
//   step(...);
//   EXPECT_EQ(guard.count(), 0);
//
// Include it in exactly ONE source file of a test program: it replaces malloc and its kin for the whole
// program. With the sanitizers, which replace them too, only operator new is counted.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SLEWLAB_COUNTS_MALLOC 0
#else
#define SLEWLAB_COUNTS_MALLOC 1
#endif

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

#if SLEWLAB_COUNTS_MALLOC

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

// operator new counts itself where malloc cannot be replaced; the aligned forms are left to the sanitizer.
void* operator new(std::size_t size) {
  ++slewlab::tests::allocation_count;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++slewlab::tests::allocation_count;
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new[](std::size_t size, const std::nothrow_t& no_throw) noexcept { return operator new(size, no_throw); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

#endif
