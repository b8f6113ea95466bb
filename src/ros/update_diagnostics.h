#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

/// The updater adds its period to the clock, which throws where stamps end.
inline void update(diagnostic_updater::Updater& updater) {
  if (from_ros_time(ros::Time::now()) <= StampCheck::kLatest) updater.force_update();
}

}  // namespace mrhi
