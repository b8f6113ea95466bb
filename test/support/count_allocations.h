#pragma once

#include <atomic>
#include <cstdlib>

// Every allocation of a program that includes this, in one of its files, goes through here: operator new and
// Eigen's own call malloc.

namespace mrhi::testing {
inline std::atomic<long> allocations{0};
}

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
