#include <algorithm>
#include <cmath>

#include "skin_parts.h"

namespace mrhi {
namespace {

using BoneWeights = std::array<double, kSkinBones>;

constexpr double kSharpness = 6.0;       // of the division between fingers
constexpr double kThumbSharpness = 3.0;  // between the thumb and the palm: flesh that gives way widely
constexpr double kLeastShare = 0.05;     // of a finger; less is none
constexpr double kWristZone = 0.015;     // half of the way over which the wrist hands over to the palm [m]
constexpr double kThumbZone = 0.026;     // and to the thumb [m]
constexpr double kPalmZone = 0.010;      // off the palm's capsule, where the skin ceases to be its [m]

constexpr double kDeepest = 1.6;  // of the inside of a joint that counts [radii]
constexpr double kEase = 0.4;     // of the way round a joint: 0 bends evenly, 1 most in the middle

double distance_to_axis(const Capsule& capsule, const Vector3& p) {
  const Vector3 along = capsule.end - capsule.start;
  const double s = std::clamp((p - capsule.start).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - capsule.axis_point(s)).norm();
}

/// By (nearest / distance)^6 in radii, less a share below which it counts as none, and divided by their sum.
std::array<double, kFingers> finger_weights(const Vector3& p) {
  std::array<double, kFingers> distance{}, weight{};
  for (int f = 0; f < kFingers; ++f) {
    double& nearest = distance[static_cast<std::size_t>(f)];
    nearest = 1e9;
    for (int b = first_bone(f); b < kBonesPerFinger; ++b) {
      const Capsule& capsule = rest_hand().hand.capsules[static_cast<std::size_t>(capsule_index(f, b))];
      nearest = std::min(nearest, distance_to_axis(capsule, p) / capsule.radius);
    }
  }
  const double nearest = *std::min_element(distance.begin(), distance.end());
  double sum = 0.0;
  for (std::size_t f = 0; f < kFingers; ++f) {
    const double sharpness = f == 0 ? kThumbSharpness : kSharpness;
    const double share = nearest > 0.0 ? std::pow(nearest / distance[f], sharpness) : distance[f] == nearest;
    sum += weight[f] = std::max(0.0, share - kLeastShare);
  }
  for (double& w : weight) w /= sum;
  return weight;
}

/// How far the point is past the joint where the bone begins: 0 before it, 1 beyond. A joint's zone is wider
/// at the inside, where skin folds, than at the back: `inside` is 0 at the back of the bone, 1 one radius
/// below its axis.
double passed(int finger, int index, const Vector3& p) {
  const SkinBone& bone = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, index))];
  const Vector3 q = bone.axes.transpose() * (p - bone.start);
  if (index == first_bone(finger)) {
    const double zone = finger == 0 ? kThumbZone : kWristZone;
    return smooth_step(-zone, zone, q.x()) * smooth_step(kSleeveHem, kSleeveHem + kThumbZone, p.x());
  }
  const double inside = 0.5 * (1.0 - std::clamp(q.z() / bone.radius, -kDeepest, 1.0));
  const double zone = bone.radius * (index == 1 ? 1.0 + 0.9 * inside : 0.75 + 0.65 * inside);
  const double even = std::clamp(0.5 + 0.5 * q.x() / zone, 0.0, 1.0);
  return even + kEase * (smooth_step(0.0, 1.0, even) - even);
}

/// Along the finger each joint's t passes the weight on: with u = 2 t - 1 the bend has 1 - |u|, the bone
/// beyond max(0, u), the one before max(0, -u), which are 1 together for every t.
void add_finger(int finger, double share, const Vector3& p, BoneWeights& weights) {
  int before = kWristBone;
  double left = share;  // not yet handed to a bone further in
  for (int b = first_bone(finger); b < kBonesPerFinger; ++b) {
    const double t = passed(finger, b, p);
    const int bone = capsule_index(finger, b);
    const bool bends = b > 0;
    const double on = left * (bends ? std::max(0.0, 2.0 * t - 1.0) : t);
    const double bend = bends ? left * (1.0 - std::abs(2.0 * t - 1.0)) : 0.0;
    weights[static_cast<std::size_t>(before)] += left - on - bend;
    if (bends) weights[static_cast<std::size_t>(bend_index(finger, b))] += bend;
    left = on;
    before = bone;
  }
  weights[static_cast<std::size_t>(before)] += left;
}

}  // namespace

/// The sum over fingers of w_f times the sum over its bones, 1 each: it is 1.
BoneWeights skin_weights(const Vector3& point) {
  BoneWeights weights{};
  const auto fingers = finger_weights(point);
  for (int f = 0; f < kFingers; ++f) {
    if (fingers[static_cast<std::size_t>(f)] > 0.0)
      add_finger(f, fingers[static_cast<std::size_t>(f)], point, weights);
  }
  return weights;
}

/// A bend counts half for the bone before and half for the bone after; the thumb's first has no bone before
/// it. The wrist counts for the middle metacarpal.
std::array<float, kCapsules> capsule_shares(const Vector3& point) {
  const BoneWeights weights = skin_weights(point);
  std::array<float, kCapsules> shares{};
  for (int f = 0; f < kFingers; ++f) {
    for (int b = first_bone(f); b < kBonesPerFinger; ++b) {
      const auto i = static_cast<std::size_t>(capsule_index(f, b));
      shares[i] += static_cast<float>(weights[i]);
      if (b == 0) continue;
      const auto half = static_cast<float>(0.5 * weights[static_cast<std::size_t>(bend_index(f, b))]);
      shares[i] += half;
      if (b > first_bone(f)) shares[i - 1] += half;
    }
  }
  shares[static_cast<std::size_t>(capsule_index(2, 0))] += static_cast<float>(weights[kWristBone]);
  const Capsule& palm = rest_hand().hand.capsules[kPalm];
  shares[kPalm] =
      static_cast<float>(1.0 - smooth_step(0.0, kPalmZone, distance_to_axis(palm, point) - palm.radius));
  return shares;
}

}  // namespace mrhi
