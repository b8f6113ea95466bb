#include "mr_hand_interaction/collision/moving_hand.h"

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

Vector3 MovingHand::angular_velocity(int capsule) const {
  const auto c = static_cast<std::size_t>(capsule);
  const Vector3 axis = capsules[c].end - capsules[c].start;
  const double length_squared = axis.squaredNorm();
  if (length_squared <= 0.0) return palm_spin;
  const Vector3 across = axis.cross(end_velocity[c] - start_velocity[c]) / length_squared;
  return across + (axis.dot(palm_spin) / length_squared) * axis;
}

MovingHand moving_hand(const HandTrack& track, int slot, double fraction, double seconds) {
  MovingHand hand;
  hand.slot = slot;
  hand.emerged = track.emerged && fraction == 0.0;
  const double rate = seconds > 0.0 ? 1.0 / seconds : 0.0;
  const Eigen::AngleAxisd turn(track.current.palm.orientation * track.previous.palm.orientation.conjugate());
  hand.palm_spin = (rate * turn.angle()) * turn.axis();
  hand.palm = Eigen::AngleAxisd(fraction * turn.angle(), turn.axis()) * track.previous.palm.orientation;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &from = track.previous.capsules[c], &to = track.current.capsules[c];
    Capsule& capsule = hand.capsules[c];
    capsule = to;
    if (to.radius <= 0.0 || from.radius <= 0.0) {
      hand.start_velocity[c] = hand.end_velocity[c] = Vector3::Zero();
      continue;
    }
    capsule.start = from.start + fraction * (to.start - from.start);
    capsule.end = from.end + fraction * (to.end - from.end);
    hand.start_velocity[c] = rate * (to.start - from.start);
    hand.end_velocity[c] = rate * (to.end - from.end);
  }
  return hand;
}

}  // namespace mrhi
