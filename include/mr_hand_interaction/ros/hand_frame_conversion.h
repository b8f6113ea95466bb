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

/// Which capsules touch an object.
using Touching = std::array<bool, kCapsules>;

/// Capsules that are absent, and the palm's, are left out.
mr_hand_interaction::Hand to_message(const Hand& hand, const Touching& touching = {});
mr_hand_interaction::HandFrame to_message(const HandFrame& frame, const std::string& frame_id);

/// The same bits that to_message was given. Throws std::invalid_argument naming the hand and what is wrong
/// with it: a value that is not finite or out of range, an unknown side, finger or bone, a bone given twice.
HandFrame from_message(const mr_hand_interaction::HandFrame& message);

geometry_msgs::Point to_message(const Vector3& point);
geometry_msgs::Vector3 vector_message(const Vector3& v);
geometry_msgs::Pose to_message(const Pose& pose);
geometry_msgs::Twist to_message(const Twist& twist);
Vector3 from_message(const geometry_msgs::Point& point);
Vector3 from_message(const geometry_msgs::Vector3& vector);
Pose from_message(const geometry_msgs::Pose& pose);
Twist from_message(const geometry_msgs::Twist& twist);
/// With the quaternion brought to unit length.
Pose from_message(const geometry_msgs::Transform& transform);

/// A frame's name without the slash that it may begin with.
std::string without_slash(const std::string& frame_id);

/// What no header can hold becomes the nearest that one can.
ros::Time to_ros_time(Nanoseconds stamp);
Nanoseconds from_ros_time(const ros::Time& stamp);
/// Of either sign [s]. The difference as a ros::Duration throws beyond 2^31 s, which a stamp or /clock may
/// reach.
double seconds_between(const ros::Time& from, const ros::Time& to);

}  // namespace mrhi
