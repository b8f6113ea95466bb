#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "change.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// One thing that a live simulation was given; SimulationInput.msg without ROS.
struct LogEntry {
  enum class Kind : std::uint8_t { begin, frame, without_hands, change };

  Kind kind = Kind::begin;
  std::uint64_t run = 0, sequence = 0;
  Nanoseconds stamp = 0;           ///< of the hands' stream
  Nanoseconds time = 0;            ///< without hands: up to when, of the simulation
  Nanoseconds expected = 0;        ///< of a frame: see Simulation::begin
  std::string text;                ///< of a begin: a World; of a change: a Change
  RecordedFiles files;             ///< that belong to the text
  std::string state;               ///< of a begin: to_bytes()
  std::optional<HandFrame> hands;  ///< of a frame, stamp of the simulation
  std::uint64_t state_hash = 0;    ///< after it
  std::uint64_t lost = 0;          ///< frames that have not reached the node, so far
};

/// What a live simulation was given, in its order.
class LogSource {
 public:
  virtual ~LogSource() = default;
  /// Nothing at the end. Throws std::exception with one line if it cannot be read any further.
  virtual std::optional<LogEntry> next() = 0;
  virtual std::size_t position() const = 0;
  virtual std::size_t size() const = 0;
};

}  // namespace mrhi
