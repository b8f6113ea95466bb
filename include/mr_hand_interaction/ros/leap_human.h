#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// A message that cannot be decoded. what() is one line.
class DecodeError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t {
    unknown_version,  ///< the definition lacks what is needed: no message of this type can be read
    malformed,        ///< the bytes do not fit the definition
    wrong_count       ///< fingers, bones or joints: too many, twice the same, or of no known kind
  };

  DecodeError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }
  /// The kind in words, for counting.
  const char* reason() const;

 private:
  Kind kind_;
};

/// Reads serialised leap_motion/Human messages by field name, from the message definition text that a
/// subscriber's connection header or a bag's connection record carries; so all published versions and later
/// ones that keep the names are understood.
class LeapHumanDecoder {
 public:
  /// Throws DecodeError naming the field that is missing or of another type.
  explicit LeapHumanDecoder(const std::string& message_definition);
  ~LeapHumanDecoder();

  struct Frame {
    std::string frame_id;        ///< of the header
    std::uint32_t sequence = 0;  ///< likewise
    JointsFrame joints;  ///< stamp of the header, 0 if it was not set; one entry per hand with is_present
  };
  /// Throws DecodeError (truncated message, wrong finger or bone count, ...).
  Frame decode(const std::uint8_t* data, std::size_t size) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace mrhi
