#include "hand_joints.h"

namespace mrhi {
namespace {

/// Ends of two bones nearer than this are one joint [m].
constexpr double kSameJoint = 1e-6;

}  // namespace

JointNet::JointNet(const Hand& hand) {
  joints_.reserve(2 * kCapsules);
  for (int c = 0; c < kCapsules; ++c) {
    const auto i = static_cast<std::size_t>(c);
    start_[i] = end_[i] = -1;
    radius_[i] = hand.capsules[i].radius;
    if (!hand.has(c)) continue;
    start_[i] = joint_at(hand.capsules[i].start);
    end_[i] = joint_at(hand.capsules[i].end);
    link(start_[i], end_[i]);
  }
  // The palm keeps its width: neighbouring knuckles and bases, and the palm's capsule tied to both.
  int previous = -1;
  for (int finger = 1; finger < kFingers; ++finger) {
    const int metacarpal = capsule_index(finger, 0);
    if (!hand.has(metacarpal)) continue;
    const auto m = static_cast<std::size_t>(metacarpal);
    if (previous >= 0) {
      link(start_[static_cast<std::size_t>(previous)], start_[m]);
      link(end_[static_cast<std::size_t>(previous)], end_[m]);
    }
    if (hand.has(kPalm)) {
      link(start_[kPalm], start_[m]);
      link(end_[kPalm], end_[m]);
    }
    previous = metacarpal;
  }
  const int thumb = capsule_index(0, 1), index = capsule_index(1, 0);
  if (hand.has(thumb) && hand.has(index)) {
    link(start_[static_cast<std::size_t>(thumb)], start_[static_cast<std::size_t>(index)]);
  }
}

void JointNet::push(int capsule, double s, const Vector3& shift) {
  const auto i = static_cast<std::size_t>(capsule);
  const double at_start = 1.0 - s, at_end = s;
  const double scale = 1.0 / (at_start * at_start + at_end * at_end);
  joints_[static_cast<std::size_t>(start_[i])] += scale * at_start * shift;
  joints_[static_cast<std::size_t>(end_[i])] += scale * at_end * shift;
}

void JointNet::restore_lengths() {
  for (const Link& l : links_) {
    Vector3 &a = joints_[static_cast<std::size_t>(l.a)], &b = joints_[static_cast<std::size_t>(l.b)];
    const Vector3 apart = b - a;
    const double length = apart.norm();
    if (length <= 0.0) continue;
    const Vector3 half = (0.5 * (length - l.length) / length) * apart;
    a += half;
    b -= half;
  }
}

Capsule JointNet::capsule(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return {joints_[static_cast<std::size_t>(start_[i])], joints_[static_cast<std::size_t>(end_[i])],
          radius_[i]};
}

Hand JointNet::apply(const Hand& hand) const {
  Hand moved = hand;
  for (int c = 0; c < kCapsules; ++c) {
    if (hand.has(c)) moved.capsules[static_cast<std::size_t>(c)] = capsule(c);
  }
  if (hand.has(kPalm)) {
    const Vector3 shift = moved.capsules[kPalm].centre() - hand.capsules[kPalm].centre();
    moved.palm.position += shift;
    moved.wrist += shift;
  }
  return moved;
}

int JointNet::joint_at(const Vector3& point) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if ((joints_[i] - point).squaredNorm() < kSameJoint * kSameJoint) return static_cast<int>(i);
  }
  joints_.push_back(point);
  return static_cast<int>(joints_.size()) - 1;
}

void JointNet::link(int a, int b) {
  links_.push_back(
      {a, b, (joints_[static_cast<std::size_t>(a)] - joints_[static_cast<std::size_t>(b)]).norm()});
}

}  // namespace mrhi
