#include "wire_reader.h"

#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {

std::string WireReader::text(const FieldLayout& field) {
  const auto length = number<std::uint32_t>(field);
  const auto* first = take(length, field);
  return std::string(first, first + length);
}

std::uint32_t WireReader::count(const FieldLayout& field) {
  return field.array == FieldArray::variable ? number<std::uint32_t>(field) : field.length;
}

void WireReader::skip(const FieldLayout& field) {
  const std::uint32_t elements = count(field);
  if (field.element_size) {
    take(std::uint64_t(elements) * *field.element_size, field);
    return;
  }
  // Every element of a type without fixed size has at least one length of four bytes, so this ends.
  for (std::uint32_t i = 0; i < elements; ++i) {
    if (field.nested < 0)
      take(number<std::uint32_t>(field), field);
    else
      for (const FieldLayout& inner : layout_.type(field.nested).fields) skip(inner);
  }
}

const std::uint8_t* WireReader::take(std::uint64_t bytes, const FieldLayout& field) {
  if (bytes > left_)
    throw DecodeError(DecodeError::Kind::malformed, "message ends inside " + field.path + ": needs " +
                                                        std::to_string(bytes) + " bytes, has " +
                                                        std::to_string(left_));
  const std::uint8_t* first = next_;
  next_ += bytes;
  left_ -= static_cast<std::size_t>(bytes);
  return first;
}

}  // namespace mrhi
