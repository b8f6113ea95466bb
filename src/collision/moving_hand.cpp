#include "moving_hand.h"

#include <algorithm>
#include <cmath>

namespace mrhi {

/// Ends move by (to - from) / T, with T the frame's time; the palm turns at one rate about the axis of R_to
/// R_from^-1, the shorter way. A capsule that has only just appeared has no way: it stands still where it is.
HandMotion::HandMotion(const HandTrack& track, int slot, double seconds)
    : seconds_(seconds),
      emerged_(track.emerged),
      palm_from_(track.previous.palm.orientation.toRotationMatrix()),
      palm_turn_(track.current.palm.orientation * track.previous.palm.orientation.conjugate()) {
  const double rate = seconds > 0.0 ? 1.0 / seconds : 0.0;
  hand_.slot = slot;
  hand_.palm_spin = (rate * palm_turn_.angle()) * palm_turn_.axis();
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &before = track.previous.capsules[c], &to = track.current.capsules[c];
    const bool moves = to.radius > 0.0 && before.radius > 0.0;
    Vector3 &start = hand_.start_velocity[c], &end = hand_.end_velocity[c];
    hand_.from[c] = moves ? before : to;
    hand_.from[c].radius = to.radius;
    start = rate * (to.start - hand_.from[c].start);
    end = rate * (to.end - hand_.from[c].end);
    hand_.speed[c] = std::sqrt(std::max(start.squaredNorm(), end.squaredNorm()));
  }
  move_to(0.0);
}

///     R(f) = exp(f angle [axis]x) R_from
void HandMotion::move_to(double fraction) {
  hand_.time = fraction * seconds_;
  hand_.emerged = emerged_ && fraction == 0.0;
  hand_.palm =
      Eigen::AngleAxisd(fraction * palm_turn_.angle(), palm_turn_.axis()).toRotationMatrix() * palm_from_;
}

}  // namespace mrhi
