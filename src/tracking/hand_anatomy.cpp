#include "hand_anatomy.h"

#include <algorithm>
#include <stdexcept>

#include "../math/registration.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

struct Correspondences {
  std::array<Vector3, 10> anatomical, measured;
  std::size_t size = 0;

  void add(const Vector3& anatomical_point, const std::optional<Vector3>& measured_point) {
    if (!measured_point) return;
    anatomical[size] = anatomical_point;
    measured[size++] = *measured_point;
  }
};

Vector3 mirrored(const Vector3& point, Side side) {
  return side == Side::left ? Vector3(point.x(), -point.y(), point.z()) : point;
}

/// The wrist moves against the palm, so it serves only where the metacarpals' bases are not known.
Correspondences correspondences(const HandJoints& hand) {
  Correspondences points;
  points.add(Vector3::Zero(), hand.palm_centre);
  for (std::size_t i = 0; i < 4; ++i) {
    points.add(mirrored(anatomy::kMetacarpalBases[i], hand.side), hand.joints[i + 1][0]);
  }
  const bool bases_known = points.size > (hand.palm_centre ? 1u : 0u);
  for (std::size_t i = 0; i < 4; ++i)
    points.add(mirrored(anatomy::kKnuckles[i], hand.side), hand.joints[i + 1][1]);
  if (!bases_known) points.add(mirrored(anatomy::kWrist, hand.side), hand.wrist);
  return points;
}

}  // namespace

/// The inverse way: out of the adult's palm to the device.
Vector3 PalmFit::place(const Vector3& anatomical) const {
  return palm * (scale * mirrored(anatomical, side));
}

///     sum |s R a_i + t - m_i|^2 -> min,   t = mean m - s R mean a
/// over a scale s, a rotation R and a place t, a_i of the adult's palm, m_i measured in the device's frame
/// (Umeyama 1991). A left hand is fitted to the mirrored palm, not by a reflection: R is a rotation for both.
std::optional<PalmFit> fit_palm(const HandJoints& hand) {
  const Correspondences points = correspondences(hand);
  const auto found = registered(points.anatomical.data(), points.measured.data(), points.size);
  if (!found) return std::nullopt;
  PalmFit fit;
  fit.side = hand.side;
  fit.scale = found->scale;
  fit.palm.orientation = Quaternion(found->rotation).normalized();
  fit.palm.position = found->to - fit.scale * (found->rotation * found->from);
  if (!(fit.scale > kSmallestHand && fit.scale < kLargestHand)) return std::nullopt;
  return fit;
}

namespace {

constexpr double kShortestBone = 1e-6;  // [m]; the thumb's metacarpal has length zero in Leap's skeleton

/// Rounded to float32. Volatile, because GCC 12 at -O2 drops the conversion there and back where it
/// vectorises it.
double as_float(double value) {
  const volatile float rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

double fraction(float value) {
  return static_cast<double>(std::min(std::max(value, 0.0f), 1.0f));
}

/// A tracker's width is a diameter and a float; what is put in for it is rounded as if the tracker had given
/// it.
double bone_radius(const HandJoints& joints, const PalmFit& fit, std::size_t finger, std::size_t bone) {
  const auto& own = joints.bone_width[finger][bone];
  const auto& width = own ? own : joints.finger_width[finger];
  return as_float(width ? 0.5 * static_cast<double>(*width) : fit.scale * anatomy::kFingerRadii[finger]);
}

/// The finger's joints with the metacarpal's base filled in. The thumb has no metacarpal in the palm.
std::array<std::optional<Vector3>, 5> complete_finger(const HandJoints& joints, const PalmFit& fit,
                                                      std::size_t finger) {
  auto completed = joints.joints[finger];
  if (finger > 0 && !completed[0] && completed[1])
    completed[0] = fit.place(anatomy::kMetacarpalBases[finger - 1]);
  return completed;
}

/// Joint i is where bone i begins and bone i - 1 ends, in the device's frame; capsules are in world. A bone
/// without length would have no direction: it is left out, as if the tracker had not given it.
void place_finger(const HandJoints& joints, const PalmFit& fit, std::size_t finger,
                  const Pose& device_in_world, Hand& hand) {
  const auto completed = complete_finger(joints, fit, finger);
  for (std::size_t bone = 0; bone < kBonesPerFinger; ++bone) {
    const auto& start = completed[bone];
    const auto& end = completed[bone + 1];
    if (!start || !end || (*end - *start).norm() < kShortestBone) continue;
    hand.capsules[finger * kBonesPerFinger + bone] = {device_in_world * *start, device_in_world * *end,
                                                      bone_radius(joints, fit, finger, bone)};
  }
}

Vector3 wrist_of(const HandJoints& joints, const PalmFit& fit) {
  const Vector3 wrist = joints.wrist.value_or(fit.place(anatomy::kWrist));
  return {as_float(wrist.x()), as_float(wrist.y()), as_float(wrist.z())};
}

}  // namespace

/// Along the palm's x, from the wrist to the fingers: 0.4 of its width between the ends' centres and 0.3
/// thick, so that it is 0.7 long over all.
Capsule palm_capsule(const Pose& palm, double palm_width) {
  const Vector3 half = 0.2 * palm_width * (palm.orientation * Vector3::UnitX());
  return {palm.position - half, palm.position + half, 0.15 * palm_width};
}

Hand complete_hand(const HandJoints& joints, const Pose& device_in_world) {
  const std::string found = defect(joints);
  if (!found.empty()) throw std::invalid_argument("hand " + std::to_string(joints.id) + ": " + found);
  const PalmFit fit = *fit_palm(joints);
  Hand hand;
  hand.id = joints.id;
  hand.side = joints.side;
  hand.confidence = fraction(joints.confidence);
  hand.grab_strength = fraction(joints.grab_strength);
  hand.pinch_strength = fraction(joints.pinch_strength);
  hand.palm = device_in_world * Pose{joints.palm_centre.value_or(fit.palm.position), fit.palm.orientation};
  // The product of two unit quaternions is of length 1 but for rounding.
  hand.palm.orientation.normalize();
  hand.palm_width =
      joints.palm_width ? static_cast<double>(*joints.palm_width) : as_float(fit.scale * anatomy::kPalmWidth);
  hand.wrist = device_in_world * wrist_of(joints, fit);
  for (std::size_t finger = 0; finger < kFingers; ++finger)
    place_finger(joints, fit, finger, device_in_world, hand);
  hand.capsules[kPalm] = palm_capsule(hand.palm, hand.palm_width);
  return hand;
}

}  // namespace mrhi
