#include "leap_human_encoder.h"

#include <algorithm>
#include <stdexcept>

#include "leap_human_definition.h"
#include "wire_writer.h"

namespace mrhi {
namespace {

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

/// Direction and normal as Leap has them: to the fingers, and out of the palm. Zero where a joint is missing.
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

/// Leap's basis (x, y, z in columns) of a bone, as the driver turns it into a quaternion: from its transpose.
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

class HumanWriter {
 public:
  HumanWriter(Nanoseconds stamp, const std::string& frame_id, std::uint32_t sequence)
      : stamp_(stamp), frame_id_(frame_id), sequence_(sequence) {}

  void human(const JointsFrame& frame, float frames_per_second) {
    const HandJoints *right = hand_of(frame, Side::right), *left = hand_of(frame, Side::left);
    std::int32_t fingers = 0;
    for (const HandJoints& hand : frame.hands) fingers += finger_count(hand);
    header();
    out_.number(static_cast<std::int32_t>(sequence_));
    out_.number(static_cast<std::int32_t>(frame.hands.size()));
    out_.number(fingers);
    out_.number(std::int32_t{0});  // gestures
    out_.number(frames_per_second);
    out_.text("");
    hand_message(right);
    hand_message(left);
  }

  std::vector<std::uint8_t> bytes() const { return out_.bytes(); }

 private:
  using Finger = std::array<std::optional<Vector3>, 5>;

  static bool has_bone(const Finger& joints, std::size_t bone) { return joints[bone] && joints[bone + 1]; }
  static bool has_any_bone(const Finger& joints) {
    for (std::size_t bone = 0; bone < kBonesPerFinger; ++bone) {
      if (has_bone(joints, bone)) return true;
    }
    return false;
  }
  static std::int32_t finger_count(const HandJoints& hand) {
    return static_cast<std::int32_t>(std::count_if(hand.joints.begin(), hand.joints.end(), has_any_bone));
  }

  void header() {
    out_.number(sequence_);
    out_.number(static_cast<std::uint32_t>(stamp_ / 1000000000));
    out_.number(static_cast<std::uint32_t>(stamp_ % 1000000000));
    out_.text(frame_id_);
  }

  void hand_message(const HandJoints* given) {
    const HandJoints hand = given != nullptr ? *given : HandJoints();
    const PalmAxes palm(hand);
    header();
    out_.number(static_cast<std::int32_t>(given != nullptr ? hand.id : 0));
    out_.number(static_cast<std::uint8_t>(given != nullptr));
    out_.number(std::uint8_t{0});  // valid_gestures
    out_.number(0.0f);             // time_visible
    out_.number(given != nullptr ? hand.confidence : 0.0f);
    for (int angle = 0; angle < 3; ++angle) out_.number(0.0f);  // roll, pitch, yaw
    out_.vector(palm.direction);
    out_.vector(palm.normal);
    out_.number(hand.grab_strength);
    out_.number(hand.pinch_strength);
    out_.number(std::uint32_t{0});  // palm_velocity
    out_.vector(hand.palm_centre.value_or(Vector3::Zero()));
    out_.number(hand.palm_width.value_or(0.0f));
    out_.number(0.0f);              // sphere_radius
    out_.number(std::uint32_t{0});  // sphere_center
    out_.text("");
    finger_list(hand, palm);
    out_.number(std::uint32_t{0});  // gesture_list
    arm(hand, palm);
  }

  void finger_list(const HandJoints& hand, const PalmAxes& palm) {
    out_.number(static_cast<std::uint32_t>(finger_count(hand)));
    for (std::size_t finger = 0; finger < kFingers; ++finger) {
      const Finger& joints = hand.joints[finger];
      if (!has_any_bone(joints)) continue;
      const float width = hand.finger_width[finger].value_or(0.0f);
      double length = 0.0;
      std::uint32_t bones = 0;
      for (std::size_t bone = 0; bone < kBonesPerFinger; ++bone) {
        if (!has_bone(joints, bone)) continue;
        ++bones;
        if (bone > 0) length += (*joints[bone + 1] - *joints[bone]).norm();
      }
      header();
      out_.number(static_cast<std::int32_t>(10 * hand.id + finger));
      out_.number(static_cast<std::uint8_t>(finger));
      out_.number(static_cast<float>(length));
      out_.number(width);
      out_.text("");
      out_.number(bones);
      for (std::size_t bone = 0; bone < kBonesPerFinger; ++bone) {
        if (has_bone(joints, bone)) bone_message(bone, *joints[bone], *joints[bone + 1], width, palm.normal);
      }
    }
  }

  void bone_message(std::size_t bone, const Vector3& start, const Vector3& end, float width,
                    const Vector3& palm_normal) {
    const Quaternion orientation = driver_orientation(end - start, palm_normal);
    header();
    out_.number(static_cast<std::uint8_t>(bone));
    out_.number(static_cast<float>((end - start).norm()));
    out_.number(width);
    out_.text("");
    out_.pose({start, orientation});
    out_.pose({end, orientation});
    out_.floats(0.5 * (start + end));
  }

  void arm(const HandJoints& hand, const PalmAxes& palm) {
    constexpr double kForearm = 0.25;  // [m]
    const bool known = hand.wrist.has_value();
    const Vector3 wrist = hand.wrist.value_or(Vector3::Zero());
    const Vector3 elbow = known ? Vector3(wrist - kForearm * palm.direction) : wrist;
    const Quaternion orientation = driver_orientation(palm.direction, palm.normal);
    header();
    out_.pose({elbow, orientation});
    out_.pose({wrist, orientation});
    out_.floats(0.5 * (elbow + wrist));
    out_.vector(palm.direction);
  }

  const Nanoseconds stamp_;
  const std::string& frame_id_;
  const std::uint32_t sequence_;
  WireWriter out_;
};

}  // namespace

const std::string& LeapHumanEncoder::definition() {
  static const std::string text = kLeapHumanDefinition;
  return text;
}

std::vector<std::uint8_t> LeapHumanEncoder::encode(const JointsFrame& frame, const std::string& frame_id,
                                                   std::uint32_t sequence, float frames_per_second) {
  HumanWriter writer(frame.stamp, frame_id, sequence);
  writer.human(frame, frames_per_second);
  return writer.bytes();
}

}  // namespace mrhi
