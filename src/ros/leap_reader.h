#pragma once

#include <topic_tools/shape_shifter.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {

/// Decodes leap_motion/Human of any version, as a subscription to any type hands it over.
class LeapReader {
 public:
  /// Throws DecodeError.
  LeapHumanDecoder::Frame read(const topic_tools::ShapeShifter& message);

 private:
  const LeapHumanDecoder& decoder(const topic_tools::ShapeShifter& message);

  std::map<std::string, std::unique_ptr<const LeapHumanDecoder>> decoders_;  ///< by md5
  std::vector<std::uint8_t> bytes_;
};

}  // namespace mrhi
