#pragma once

#include <mr_hand_interaction/LeapControllerHand.h>

#include "leap_controller.h"

namespace mrhi {

struct LeapControllerTracker {
  static constexpr const char* kType = "leap_motion_controller/Hand";
  static std::vector<std::string> topics() { return {"/leapmotion/hands/left", "/leapmotion/hands/right"}; }
  static std::vector<std::string> md5s() {
    return {ros::message_traits::md5sum<mr_hand_interaction::LeapControllerHand>()};
  }

  static TrackerMessage read(const std::string& /*md5*/, std::vector<std::uint8_t>& bytes) {
    return read_leap_controller(bytes);
  }
};

}  // namespace mrhi
