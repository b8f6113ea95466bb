#pragma once

#include <atomic>
#include <cstdlib>

// Every allocation of a program that includes this, in one of its files, goes through here: operator new and
// Eigen's own call malloc. The sanitizers have a malloc of their own: under them nothing is counted, and
// scripts/sanitize leaves out the tests that count.

namespace mrhi::testing {
inline std::atomic<long> allocations{0};
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MRHI_MALLOC_IS_THE_SANITIZERS
#endif
#endif

#ifndef MRHI_MALLOC_IS_THE_SANITIZERS
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  ++mrhi::testing::allocations;
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++mrhi::testing::allocations;
  return __libc_memalign(alignment, size);
}
}
#endif
