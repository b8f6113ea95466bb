#include "step_motion.h"

#include <algorithm>
#include <cmath>

namespace mrhi {

/// w = R I^-1 R^T L, with L in world and I in the body's frame: momentum is the state.
MovingBody::MovingBody(const Body& of, const BodyState& state, const Vector3& gravity)
    : body(of),
      pose(state.pose),
      rotation(state.pose.orientation.toRotationMatrix()),
      acceleration(gravity),
      appeared(state.appeared) {
  if (of.fixed) {
    acceleration.setZero();
    return;
  }
  twist.linear = state.linear_momentum / of.mass;
  const Vector3 momentum = rotation.transpose() * state.angular_momentum;
  twist.angular = rotation * (of.inverse_inertia * momentum);
}

///     x(t) = x + v t + g t^2 / 2,   R(t) = exp(t [w]x) R
/// w is constant in the step, although the body may tumble: this is only for the first touch.
Pose MovingBody::at(double time) const {
  const double angle = twist.angular.norm() * time;
  Pose result{pose.position + time * (twist.linear + 0.5 * time * acceleration), pose.orientation};
  if (angle > 0.0) {
    result.orientation = Quaternion(Eigen::AngleAxisd(angle, twist.angular.normalized())) * pose.orientation;
  }
  return result;
}

/// Eq. 7: v + g t + w x r.
Vector3 MovingBody::velocity(double time, const Vector3& arm) const {
  return twist.linear + time * acceleration + twist.angular.cross(arm);
}

void CarrierMotion::carry(const Vector3& point, PhalanxMotion& motion) const {
  motion.velocity = rotation * motion.velocity + velocity(point);
  motion.spread = rotation * motion.spread + twist.angular.cross(motion.axis);
}

/// The velocity of a cubic is a mean of D + b, D - b - e and D + e, over T (Bernstein): it is at most |D| and
/// twice the longest bend, over T. A capsule that has only just appeared has no path: it stands still where
/// it is.
HandMotion::HandMotion(const HandTrack& track, int slot, double seconds)
    : seconds_(seconds),
      spawned_(track.emerged),
      palm_from_(track.previous.palm.orientation.toRotationMatrix()),
      turn_start_bend_(track.path.start_bend.turn),
      turn_end_bend_(track.path.end_bend.turn) {
  const Eigen::AngleAxisd turn(track.current.palm.orientation * track.previous.palm.orientation.conjugate());
  palm_turn_ = turn.angle() * turn.axis();
  const double rate = seconds > 0.0 ? 1.0 / seconds : 0.0;
  hand_.slot = slot;
  const Vector3 none = Vector3::Zero();
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &before = track.previous.capsules[c], &to = track.current.capsules[c];
    const bool moves = to.radius > 0.0 && before.radius > 0.0;
    hand_.radius[c] = to.radius;
    double longest = 0.0;
    for (const bool at_end : {false, true}) {
      EndPath& path = (at_end ? hand_.end : hand_.start)[c];
      const Vector3 &from = at_end ? before.end : before.start, &until = at_end ? to.end : to.start;
      const std::size_t point = 2 + 2 * c + (at_end ? 1 : 0);
      path = {until, none, none, none};
      if (!moves) continue;
      path = {from, until - from, track.path.start_bend.points[point], track.path.end_bend.points[point]};
      longest = std::max(longest, path.chord.squaredNorm());
    }
    hand_.speed[c] = moves ? rate * (std::sqrt(longest) + 2.0 * track.path.longest_bend) : 0.0;
  }
  move_to(0.0, 0.0);
}

///     R(f) = exp([f t + f (1 - f)^2 b - f^2 (1 - f) e]x) R_from,     t the turn, b and e its bends
Matrix3 HandMotion::palm_orientation(double fraction) const {
  const Vector3 turn = PathWeights::at(fraction)(palm_turn_, turn_start_bend_, turn_end_bend_);
  const double angle = turn.norm();
  if (angle == 0.0) return palm_from_;
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * palm_from_;
}

/// The rate of a rotation vector is the angular velocity but for terms of second order in the turn of a
/// frame.
void HandMotion::move_to(double fraction, double until) {
  hand_.place = PathWeights::at(fraction);
  hand_.rate = PathWeights::between(fraction, until, seconds_);
  hand_.spawned = spawned_ && fraction == 0.0;
  hand_.palm = palm_orientation(fraction);
  hand_.palm_spin = hand_.rate(palm_turn_, turn_start_bend_, turn_end_bend_);
  const CarrierMotion* carrier = hand_.carrier;
  if (carrier == nullptr) return;
  hand_.palm = carrier->rotation * hand_.palm;
  hand_.palm_spin = carrier->rotation * hand_.palm_spin + carrier->twist.angular;
}

void HandMotion::carry(const CarrierMotion* carrier) {
  hand_.carrier = carrier;
}

}  // namespace mrhi
