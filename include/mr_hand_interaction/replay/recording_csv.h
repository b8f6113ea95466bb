#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// A recording that cannot be read. what() is one line: file, line number, column, what is allowed.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a recording in the CSV schema (one line per hand and device frame; hand_id -1: a frame with no hand;
/// columns by name; empty cells: not recorded). Throws RecordingError.
std::vector<JointsFrame> read_recording_csv(const std::string& file);

}  // namespace mrhi
