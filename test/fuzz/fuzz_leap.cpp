// A leap_motion/Human: a byte for its version, then the message.
#include <mr_hand_interaction/LeapAugust2019Human.h>
#include <mr_hand_interaction/LeapFebruary2020Human.h>
#include <mr_hand_interaction/LeapHuman.h>
#include <mr_hand_interaction/LeapMelodicHuman.h>

#include "fuzz/target.h"
#include "mr_hand_interaction/ros/leap_human.h"

namespace {

using namespace mrhi;
namespace msg = mr_hand_interaction;

const char* const kVersions[] = {ros::message_traits::md5sum<msg::LeapHuman>(),
                                 ros::message_traits::md5sum<msg::LeapFebruary2020Human>(),
                                 ros::message_traits::md5sum<msg::LeapAugust2019Human>(),
                                 ros::message_traits::md5sum<msg::LeapMelodicHuman>()};

}  // namespace

FUZZ_TARGET(leap) {
  if (size < 1) return;
  try {
    const LeapFrame frame = read_leap(kVersions[data[0] % 4], {data + 1, data + size});
    fuzzing::require(frame.joints.hands.size() <= 2, "a message has at most two hands");
    std::vector<std::string> defects;
    complete_frame(frame.joints, Pose(), defects);
    for (const std::string& defect : defects) fuzzing::require_one_line(defect);
  } catch (const DecodeError& error) {
    fuzzing::require_one_line(error.what());
  }
}
