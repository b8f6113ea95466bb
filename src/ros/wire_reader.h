#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "message_layout.h"

namespace mrhi {

/// Walks over a serialised ROS 1 message (little-endian, packed). Every call throws DecodeError naming the
/// field if the message ends inside it.
class WireReader {
 public:
  WireReader(const MessageLayout& layout, const std::uint8_t* data, std::size_t size)
      : layout_(layout), next_(data), left_(size) {}

  template <class Number>
  Number number(const FieldLayout& field) {
    Number value;
    std::memcpy(&value, take(sizeof(Number), field), sizeof(Number));
    return value;
  }
  std::string text(const FieldLayout& field);
  /// The number of elements of a field: 1 unless it is an array.
  std::uint32_t count(const FieldLayout& field);
  void skip(const FieldLayout& field);

  std::size_t left() const { return left_; }

 private:
  const std::uint8_t* take(std::uint64_t bytes, const FieldLayout& field);

  const MessageLayout& layout_;
  const std::uint8_t* next_;
  std::size_t left_;
};

}  // namespace mrhi
