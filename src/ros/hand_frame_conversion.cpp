#include "mr_hand_interaction/ros/hand_frame_conversion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../tracking/hand_anatomy.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

constexpr int kMaxPosition = 1000;       // [m], on each axis
constexpr double kUnitTolerance = 1e-9;  // of a quaternion's length; within it the bits are kept

[[noreturn]] void refuse(const mr_hand_interaction::Hand& message, const std::string& what) {
  throw std::invalid_argument("hand " + std::to_string(message.id) + ": " + what);
}

double checked(const mr_hand_interaction::Hand& message, const char* name, float value, double max) {
  const double number = static_cast<double>(value);
  if (!(number >= 0.0 && number <= max))
    refuse(message,
           std::string(name) + " " + std::to_string(value) + " is not in 0 to " + std::to_string(max));
  return number;
}

Vector3 checked(const mr_hand_interaction::Hand& message, const char* name,
                const geometry_msgs::Point& point) {
  const Vector3 position = from_message(point);
  if (!position.allFinite()) refuse(message, std::string(name) + " is not finite");
  if (position.cwiseAbs().maxCoeff() > kMaxPosition)
    refuse(message, std::string(name) + " is farther than " + std::to_string(kMaxPosition) + " m");
  return position;
}

Pose checked_palm(const mr_hand_interaction::Hand& message) {
  Pose palm{checked(message, "palm", message.palm.position), from_message(message.palm).orientation};
  const double length = palm.orientation.norm();
  if (!(std::abs(length - 1.0) < 0.01)) refuse(message, "palm orientation is no unit quaternion");
  if (std::abs(length - 1.0) > kUnitTolerance) palm.orientation.normalize();
  return palm;
}

/// A wrist at (0, 0, 0) far from the palm is not known: it is placed as in an adult's hand of that palm.
Vector3 checked_wrist(const mr_hand_interaction::Hand& message, const Hand& hand) {
  constexpr double kMaxToPalm = 0.2;  // of large hands too [m]
  const Vector3 wrist = checked(message, "wrist", message.wrist);
  if (!wrist.isZero(0.0) || hand.palm.position.norm() < kMaxToPalm) return wrist;
  const double mirror = hand.side == Side::left ? -1.0 : 1.0;
  return hand.palm *
         (hand.palm_width / anatomy::kPalmWidth * Vector3(1.0, mirror, 1.0).cwiseProduct(anatomy::kWrist));
}

void add_phalanx(const mr_hand_interaction::Hand& message, const mr_hand_interaction::Phalanx& phalanx,
                 Hand& hand) {
  const std::string name =
      "finger " + std::to_string(phalanx.finger) + " bone " + std::to_string(phalanx.bone);
  if (phalanx.finger >= kFingers || phalanx.bone >= kBonesPerFinger) refuse(message, name + " is not known");
  const int index = capsule_index(phalanx.finger, phalanx.bone);
  if (hand.has(index)) refuse(message, name + " is given twice");
  const double radius = checked(message, "radius", phalanx.radius, 0.1);
  hand.capsules[index] = {checked(message, "start of a phalanx", phalanx.start),
                          checked(message, "end of a phalanx", phalanx.end), radius};
}

Hand checked_hand(const mr_hand_interaction::Hand& message) {
  if (message.side > mr_hand_interaction::Hand::RIGHT) refuse(message, "side is neither LEFT nor RIGHT");
  Hand hand;
  hand.id = message.id;
  hand.side = static_cast<Side>(message.side);
  hand.confidence = checked(message, "confidence", message.confidence, 1.0);
  hand.grab_strength = checked(message, "grab_strength", message.grab_strength, 1.0);
  hand.pinch_strength = checked(message, "pinch_strength", message.pinch_strength, 1.0);
  hand.palm = checked_palm(message);
  hand.palm_width = checked(message, "palm_width", message.palm_width, 0.3);
  hand.wrist = checked_wrist(message, hand);
  for (const auto& phalanx : message.phalanges) add_phalanx(message, phalanx, hand);
  hand.capsules[kPalm] = palm_capsule(hand.palm, hand.palm_width);
  return hand;
}

template <class Message>
Message xyz_message(const Vector3& v) {
  Message message;
  message.x = v.x(), message.y = v.y(), message.z = v.z();
  return message;
}

}  // namespace

mr_hand_interaction::Hand to_message(const Hand& hand, const Touching& touching) {
  mr_hand_interaction::Hand message;
  message.id = hand.id;
  message.side = static_cast<std::uint8_t>(hand.side);
  message.confidence = static_cast<float>(hand.confidence);
  message.grab_strength = static_cast<float>(hand.grab_strength);
  message.pinch_strength = static_cast<float>(hand.pinch_strength);
  message.palm = to_message(hand.palm);
  message.palm_width = static_cast<float>(hand.palm_width);
  message.wrist = to_message(hand.wrist);
  message.phalanges.reserve(kPhalanges);
  for (int i = 0; i < kPhalanges; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[i];
    mr_hand_interaction::Phalanx& phalanx = message.phalanges.emplace_back();
    phalanx.finger = static_cast<std::uint8_t>(finger_of(i));
    phalanx.bone = static_cast<std::uint8_t>(bone_of(i));
    phalanx.start = to_message(capsule.start);
    phalanx.end = to_message(capsule.end);
    phalanx.radius = static_cast<float>(capsule.radius);
    phalanx.touching = touching[i];
  }
  return message;
}

mr_hand_interaction::HandFrame to_message(const HandFrame& frame, const std::string& frame_id) {
  mr_hand_interaction::HandFrame message;
  message.header.stamp = to_ros_time(frame.stamp);
  message.header.frame_id = frame_id;
  for (const Hand& hand : frame.hands) message.hands.push_back(to_message(hand));
  return message;
}

HandFrame from_message(const mr_hand_interaction::HandFrame& message) {
  HandFrame frame;
  frame.stamp = from_ros_time(message.header.stamp);
  for (const auto& hand : message.hands) frame.hands.push_back(checked_hand(hand));
  return frame;
}

geometry_msgs::Point to_message(const Vector3& point) {
  return xyz_message<geometry_msgs::Point>(point);
}

geometry_msgs::Vector3 vector_message(const Vector3& v) {
  return xyz_message<geometry_msgs::Vector3>(v);
}

geometry_msgs::Twist to_message(const Twist& twist) {
  geometry_msgs::Twist message;
  message.linear = vector_message(twist.linear);
  message.angular = vector_message(twist.angular);
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

Twist from_message(const geometry_msgs::Twist& twist) {
  return {from_message(twist.linear), from_message(twist.angular)};
}

Pose from_message(const geometry_msgs::Transform& transform) {
  const auto& t = transform.translation;
  const auto& q = transform.rotation;
  return {{t.x, t.y, t.z}, Quaternion(q.w, q.x, q.y, q.z).normalized()};
}

std::string without_slash(const std::string& frame_id) {
  return frame_id.compare(0, 1, "/") == 0 ? frame_id.substr(1) : frame_id;
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
