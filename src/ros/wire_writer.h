#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Appends values as ROS 1 serialises them (little-endian, on a little-endian machine).
class WireWriter {
 public:
  template <class Number>
  void number(Number value) {
    static_assert(std::is_arithmetic<Number>::value && !std::is_same<Number, bool>::value, "plain numbers");
    const std::size_t size = bytes_.size();
    bytes_.resize(size + sizeof value);
    std::memcpy(bytes_.data() + size, &value, sizeof value);
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  /// A Point or Vector3.
  void vector(const Vector3& value) {
    for (int axis = 0; axis < 3; ++axis) number(value[axis]);
  }
  void pose(const Pose& value) {
    vector(value.position);
    for (int i = 0; i < 4; ++i) number(value.orientation.coeffs()[i]);
  }
  /// float32[] of three.
  void floats(const Vector3& value) {
    number(std::uint32_t{3});
    for (int axis = 0; axis < 3; ++axis) number(static_cast<float>(value[axis]));
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace mrhi
