#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

geometry_msgs::Point to_message(const Vector3& point) {
  geometry_msgs::Point message;
  message.x = point.x();
  message.y = point.y();
  message.z = point.z();
  return message;
}

geometry_msgs::Vector3 vector_message(const Vector3& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::Pose to_message(const Pose& pose) {
  geometry_msgs::Pose message;
  message.position = to_message(pose.position);
  message.orientation.x = pose.orientation.x();
  message.orientation.y = pose.orientation.y();
  message.orientation.z = pose.orientation.z();
  message.orientation.w = pose.orientation.w();
  return message;
}

Vector3 from_message(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

Vector3 from_message(const geometry_msgs::Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

Pose from_message(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  return {from_message(pose.position), Quaternion(q.w, q.x, q.y, q.z)};
}

Pose from_message(const geometry_msgs::Transform& transform) {
  const auto& t = transform.translation;
  const auto& q = transform.rotation;
  return {{t.x, t.y, t.z}, Quaternion(q.w, q.x, q.y, q.z).normalized()};
}

ros::Time to_ros_time(Nanoseconds stamp) {
  constexpr Nanoseconds kEarliest = 0;
  return ros::Time().fromNSec(static_cast<std::uint64_t>(std::clamp(stamp, kEarliest, StampCheck::kLatest)));
}

Nanoseconds from_ros_time(const ros::Time& stamp) {
  return static_cast<Nanoseconds>(stamp.toNSec());
}

double seconds_between(const ros::Time& from, const ros::Time& to) {
  return to_seconds(from_ros_time(to) - from_ros_time(from));
}

}  // namespace mrhi
