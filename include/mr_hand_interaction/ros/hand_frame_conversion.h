#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <mr_hand_interaction/HandFrame.h>
#include <ros/time.h>

#include <array>
#include <string>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Capsules that touch an object.
using Touching = std::array<bool, kCapsules>;

/// Omits absent capsules and the palm's.
mr_hand_interaction::Hand to_message(const Hand& hand, const Touching& touching = {});
mr_hand_interaction::HandFrame to_message(const HandFrame& frame, const std::string& frame_id);

/// Restores the bits given to to_message(). Throws std::invalid_argument with the hand and the fault: a value
/// that is not finite or out of range, an unknown side, finger or bone, or a duplicate bone.
HandFrame from_message(const mr_hand_interaction::HandFrame& message);

geometry_msgs::Point to_message(const Vector3& point);
geometry_msgs::Vector3 vector_message(const Vector3& v);
geometry_msgs::Pose to_message(const Pose& pose);
geometry_msgs::Twist to_message(const Twist& twist);
Vector3 from_message(const geometry_msgs::Point& point);
Vector3 from_message(const geometry_msgs::Vector3& vector);
Pose from_message(const geometry_msgs::Pose& pose);
Twist from_message(const geometry_msgs::Twist& twist);
/// Normalises the quaternion.
Pose from_message(const geometry_msgs::Transform& transform);

/// Removes a leading slash from a frame's name.
std::string without_slash(const std::string& frame_id);

/// Clamps to the range of a header's stamp.
ros::Time to_ros_time(Nanoseconds stamp);
Nanoseconds from_ros_time(const ros::Time& stamp);
/// Difference of either sign [s]. A ros::Duration would throw beyond 2^31 s, as of a leap of /clock.
double seconds_between(const ros::Time& from, const ros::Time& to);

}  // namespace mrhi
