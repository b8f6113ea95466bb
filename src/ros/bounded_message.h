#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {

/// Longest list or text of a tracker's message [bytes]; real ones have less than 4 KB.
constexpr std::size_t kMaxListBytes = 64 * 1024;

/// Refuses lists longer than kMaxListBytes. roscpp resizes a list to the length that a message states before
/// it looks for the elements, so four bytes could claim all memory.
template <class T>
struct BoundedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = BoundedAllocator<U>;
  };

  BoundedAllocator() = default;
  template <class U>
  BoundedAllocator(const BoundedAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    if (count > kMaxListBytes / sizeof(T)) throw std::bad_alloc();
    return std::allocator<T>::allocate(count);
  }
};
using Bounded = BoundedAllocator<char>;

/// A message with this allocator from its bytes; `type` names it in errors. Throws DecodeError.
template <class Message>
Message deserialised(const std::string& type, std::vector<std::uint8_t>& bytes) {
  const auto refuse = [&](const std::string& what) {
    throw DecodeError(DecodeError::Kind::malformed,
                      type + " of " + std::to_string(bytes.size()) + " bytes " + what);
  };
  Message message;
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  try {
    if (bytes.empty()) ros::serialization::throwStreamOverrun();  // roscpp would add to a null pointer
    ros::serialization::deserialize(stream, message);
  } catch (const ros::serialization::StreamOverrunException&) {
    refuse("ends before all of its fields");
  } catch (const std::bad_alloc&) {
    refuse("has a list or text of more than " + std::to_string(kMaxListBytes) + " bytes");
  }
  if (stream.getLength() != 0)
    refuse("has " + std::to_string(stream.getLength()) + " after all of its fields");
  return message;
}

}  // namespace mrhi
