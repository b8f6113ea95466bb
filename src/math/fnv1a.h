#pragma once

#include <cstddef>
#include <cstdint>

namespace mrhi {

/// Hash of bytes: FNV-1a, 64 bits. Recorded states and the names of recorded files depend on its values.
struct Fnv1a {
  std::uint64_t value = 0xcbf29ce484222325u;

  Fnv1a& add(const void* data, std::size_t size) {
    for (const auto *at = static_cast<const unsigned char*>(data), *end = at + size; at != end; ++at)
      value = (value ^ *at) * 0x100000001b3u;
    return *this;
  }
};

}  // namespace mrhi
