#pragma once

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "tracked_points.h"

namespace mrhi {

struct LeapHumanTracker {
  static constexpr const char* kType = "leap_motion/Human";
  static std::vector<std::string> topics() { return {"/leap_motion/leap_device"}; }
  static std::vector<std::string> md5s() { return leap_versions(); }

  static TrackerMessage read(const std::string& md5, std::vector<std::uint8_t>& bytes) {
    LeapFrame frame = read_leap(md5, bytes);
    TrackedHands tracked;
    tracked.header.frame_id = frame.frame_id;
    tracked.header.seq = frame.sequence;
    // As it came: what is no stamp is refused where frames are corrected.
    tracked.header.stamp.sec = static_cast<std::uint32_t>(frame.joints.stamp / 1'000'000'000);
    tracked.header.stamp.nsec = static_cast<std::uint32_t>(frame.joints.stamp % 1'000'000'000);
    tracked.hands = std::move(frame.joints.hands);
    tracked.tells_sides = true;
    return tracked;
  }
};

}  // namespace mrhi
