#include "mr_hand_interaction/tracking/joint_gaps.h"

#include "../math/registration.h"

namespace mrhi {
namespace {

template <typename Joints>
auto& joint(Joints& hand, std::size_t i) {
  return i == 0 ? hand.wrist : hand.joints[(i - 1) / 5][(i - 1) % 5];
}

}  // namespace

/// All of them, as those that are in both have. x' = to + R (x - from) with the rotation R between the joints
/// that are in both (least squares, without their scale). Without one what was known is forgotten.
void JointGaps::Memory::move_on(const Points& now) {
  std::array<Vector3, kJoints> from, to;
  std::size_t size = 0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!points[i] || !now[i]) continue;
    from[size] = *points[i];
    to[size++] = *now[i];
  }
  const auto motion = registered(from.data(), to.data(), size);
  for (auto& point : points) {
    if (!motion) point.reset();
    if (point) *point = motion->to + motion->rotation * (*point - motion->from);
  }
}

/// A joint is put in from its last place, moved on frame by frame, up to kLongest after it was seen itself:
/// what has been put in counts as known for the next frame, but not as seen.
void JointGaps::Memory::take(HandJoints& hand, Nanoseconds at) {
  for (std::size_t i = 0; i < kJoints; ++i)
    if (joint(hand, i) && !joint(hand, i)->allFinite()) return;  // it will be refused
  if (at <= stamp || at - stamp > kLongest) points = Points();
  Points now;
  bool gaps = false;
  for (std::size_t i = 0; i < kJoints; ++i) {
    now[i] = joint(hand, i);
    if (now[i]) seen[i] = at;
    gaps = gaps || (points[i] && !now[i]);
  }
  if (gaps) move_on(now);
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (now[i] || at - seen[i] > kLongest) points[i] = now[i];
    joint(hand, i) = points[i];
  }
  stamp = at;
}

void JointGaps::fill(JointsFrame& frame) {
  for (HandJoints& hand : frame.hands) sides_[static_cast<std::size_t>(hand.side)].take(hand, frame.stamp);
}

}  // namespace mrhi
