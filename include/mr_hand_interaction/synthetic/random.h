#pragma once

#include <cstdint>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Random numbers with the same bits on every platform: splitmix64 (Steele, Lea & Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Approximately normal with mean 0 and deviation 1: a sum of twelve uniform numbers. Uses only additions,
  /// so the bits do not depend on a mathematics library.
  double gaussian() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  Vector3 gaussian_vector(double deviation) {
    const double x = gaussian(), y = gaussian(), z = gaussian();
    return deviation * Vector3(x, y, z);
  }

 private:
  std::uint64_t state_;
};

}  // namespace mrhi
