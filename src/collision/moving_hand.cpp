#include "mr_hand_interaction/collision/moving_hand.h"

#include <algorithm>

namespace mrhi {

Vector3 MovingHand::surface_velocity(int capsule, double s, const Vector3& offset) const {
  const auto c = static_cast<std::size_t>(capsule);
  const Vector3 axis = capsules[c].end - capsules[c].start;
  const Vector3 spread = end_velocity[c] - start_velocity[c];
  const double length_squared = axis.squaredNorm();
  Vector3 velocity = start_velocity[c] + s * spread;
  if (length_squared > 0.0) velocity += (axis.cross(spread) / length_squared).cross(offset);
  return velocity;
}

HandMotion::HandMotion(const HandTrack& track, int slot, double seconds)
    : from_(track.previous.capsules),
      seconds_(seconds),
      emerged_(track.emerged),
      palm_from_(track.previous.palm.orientation.toRotationMatrix()),
      palm_turn_(track.current.palm.orientation * track.previous.palm.orientation.conjugate()) {
  const double rate = seconds > 0.0 ? 1.0 / seconds : 0.0;
  hand_.slot = slot;
  hand_.palm_spin = (rate * palm_turn_.angle()) * palm_turn_.axis();
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule& to = track.current.capsules[c];
    Vector3 &start = hand_.start_velocity[c], &end = hand_.end_velocity[c];
    start.setZero(), end.setZero();
    if (to.radius > 0.0 && from_[c].radius > 0.0) {
      start = rate * (to.start - from_[c].start);
      end = rate * (to.end - from_[c].end);
    } else {
      from_[c] = to;
    }
    hand_.capsules[c].radius = to.radius;
    hand_.speed[c] = std::max(start.norm(), end.norm());
    hand_.top_speed = std::max(hand_.top_speed, hand_.speed[c]);
  }
  move_to(0.0);
}

void HandMotion::move_to(double fraction) {
  const double time = fraction * seconds_;
  hand_.emerged = emerged_ && fraction == 0.0;
  hand_.palm =
      Eigen::AngleAxisd(fraction * palm_turn_.angle(), palm_turn_.axis()).toRotationMatrix() * palm_from_;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    hand_.capsules[c].start = from_[c].start + time * hand_.start_velocity[c];
    hand_.capsules[c].end = from_[c].end + time * hand_.end_velocity[c];
  }
}

}  // namespace mrhi
