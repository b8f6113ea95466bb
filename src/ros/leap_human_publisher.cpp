#include "leap_human_publisher.h"

#include <mr_hand_interaction/LeapHuman.h>

#include <boost/algorithm/string/replace.hpp>
#include <stdexcept>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

namespace msg = mr_hand_interaction;

const HandJoints* hand_of(const JointsFrame& frame, Side side) {
  const HandJoints* found = nullptr;
  for (const HandJoints& hand : frame.hands) {
    if (hand.side != side) continue;
    if (found != nullptr)
      throw std::invalid_argument("a leap_motion/Human message holds one hand of each side");
    found = &hand;
  }
  return found;
}

/// Direction and normal in Leap's convention: towards the fingers, and out of the palm. Zero if a joint is
/// missing.
struct PalmAxes {
  Vector3 direction = Vector3::Zero(), normal = Vector3::Zero();

  explicit PalmAxes(const HandJoints& hand) {
    const auto &index = hand.joints[1][1], &middle = hand.joints[2][1], &little = hand.joints[4][1];
    const auto& wrist = hand.wrist ? hand.wrist : hand.joints[2][0];
    if (!index || !middle || !little || !wrist) return;
    direction = (*middle - *wrist).normalized();
    const Vector3 across = *little - *index;
    normal = (hand.side == Side::right ? direction.cross(across) : across.cross(direction)).normalized();
    direction = (direction - direction.dot(normal) * normal).normalized();
  }
};

/// Leap's basis (x, y, z in columns) of a bone, converted to a quaternion as the driver does: from its
/// transpose.
Quaternion driver_orientation(const Vector3& along, const Vector3& palm_normal) {
  const Vector3 backwards = -along;
  const Vector3 side = (-palm_normal).cross(backwards);
  if (side.norm() < 1e-9) return Quaternion::Identity();
  Matrix3 basis;
  basis.col(0) = side.normalized();
  basis.col(2) = backwards.normalized();
  basis.col(1) = basis.col(2).cross(basis.col(0));
  return Quaternion(basis).conjugate();
}

std::vector<float> floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

msg::LeapArm arm_message(const std_msgs::Header& header, const HandJoints& hand, const PalmAxes& palm) {
  constexpr double kForearm = 0.25;  // [m]
  const Vector3 wrist = hand.wrist.value_or(Vector3::Zero());
  const Vector3 elbow = hand.wrist ? Vector3(wrist - kForearm * palm.direction) : wrist;
  const Quaternion orientation = driver_orientation(palm.direction, palm.normal);
  msg::LeapArm arm;
  arm.header = header;
  arm.elbow = to_message(Pose{elbow, orientation});
  arm.wrist = to_message(Pose{wrist, orientation});
  arm.center = floats(0.5 * (elbow + wrist));
  arm.direction = vector_message(palm.direction);
  return arm;
}

/// A finger with those of its bones whose ends are known.
msg::LeapFinger finger_message(const std_msgs::Header& header, const HandJoints& hand, std::size_t number,
                               const PalmAxes& palm) {
  msg::LeapFinger finger;
  finger.header = header;
  finger.lmc_finger_id = static_cast<std::int32_t>(10 * hand.id + number);
  finger.type = static_cast<std::uint8_t>(number);
  finger.width = hand.finger_width[number].value_or(0.0f);
  double length = 0.0;
  const auto& joints = hand.joints[number];
  for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
    if (!joints[b] || !joints[b + 1]) continue;
    const Vector3 along = *joints[b + 1] - *joints[b];
    const Quaternion orientation = driver_orientation(along, palm.normal);
    if (b > 0) length += along.norm();
    msg::LeapBone bone;
    bone.header = header;
    bone.type = static_cast<std::uint8_t>(b);
    bone.length = static_cast<float>(along.norm());
    bone.width = finger.width;
    bone.bone_start = to_message(Pose{*joints[b], orientation});
    bone.bone_end = to_message(Pose{*joints[b + 1], orientation});
    bone.center = floats(0.5 * (*joints[b] + *joints[b + 1]));
    finger.bone_list.push_back(bone);
  }
  finger.length = static_cast<float>(length);
  return finger;
}

msg::LeapHand hand_message(const std_msgs::Header& header, const HandJoints* present) {
  msg::LeapHand message;
  message.header = header;
  const HandJoints hand = present != nullptr ? *present : HandJoints();
  const PalmAxes palm(hand);
  message.arm = arm_message(header, hand, palm);
  if (present == nullptr) return message;
  message.is_present = 1;
  message.lmc_hand_id = static_cast<std::int32_t>(hand.id);
  message.confidence = hand.confidence;
  message.direction = vector_message(palm.direction);
  message.normal = vector_message(palm.normal);
  message.grab_strength = hand.grab_strength;
  message.pinch_strength = hand.pinch_strength;
  message.palm_center = to_message(hand.palm_centre.value_or(Vector3::Zero()));
  message.palm_width = hand.palm_width.value_or(0.0f);
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    message.finger_list.push_back(finger_message(header, hand, finger, palm));
    if (message.finger_list.back().bone_list.empty()) message.finger_list.pop_back();
  }
  return message;
}

msg::LeapHuman human_message(const JointsFrame& frame, const std_msgs::Header& header, float rate) {
  msg::LeapHuman human;
  human.header = header;
  human.lmc_frame_id = static_cast<std::int32_t>(header.seq);
  human.right_hand = hand_message(header, hand_of(frame, Side::right));
  human.left_hand = hand_message(header, hand_of(frame, Side::left));
  human.nr_of_hands = static_cast<std::int32_t>(frame.hands.size());
  human.nr_of_fingers =
      static_cast<std::int32_t>(human.right_hand.finger_list.size() + human.left_hand.finger_list.size());
  human.current_frames_per_second = rate;
  return human;
}

}  // namespace

void write_leap(const JointsFrame& frame, const std::string& frame_id, std::uint32_t sequence, float rate,
                topic_tools::ShapeShifter& message) {
  using Human = msg::LeapHuman;
  // The driver's names: recordings are also read without this package.
  static const std::string definition = boost::replace_all_copy(
      std::string(ros::message_traits::definition<Human>()), "mr_hand_interaction/Leap", "leap_motion/");
  std_msgs::Header header;
  header.seq = sequence;
  header.stamp = to_ros_time(frame.stamp);
  header.frame_id = frame_id;
  const Human human = human_message(frame, header, rate);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(human));
  ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(out, human);
  ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.morph(ros::message_traits::md5sum<Human>(), "leap_motion/Human", definition, "");
  message.read(in);
}

}  // namespace mrhi
