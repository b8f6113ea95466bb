#include "renderer.h"

#include <algorithm>
#include <cmath>

#include "../math/rotation.h"

namespace mrhi {
namespace {

/// Compliances of joints relative to kShiftCompliance, in flexion and abduction [rad^2/m^2]: a fingertip
/// yields about thirty times as far by flexion as by a shift of the hand, and less by abduction.
constexpr double kFlexionCompliance = 1.0 / (0.03 * 0.03), kAbductionCompliance = 1.0 / (0.05 * 0.05);
/// Compliance of a finger without a proximal phalanx, which is not connected to the palm.
constexpr double kLooseCompliance = 1.0;
/// Smallest distance from a joint to the fingertip that bounds a turn [m].
constexpr double kMinReach = 0.001;
/// Weight of the anatomical axis of a thumb's hinges relative to the axis about which the thumb is bent.
constexpr double kAnatomicalWeight = 0.15;

Vector3 direction(const Capsule& bone) {
  return (bone.end - bone.start).normalized();
}

/// Right hand: along to the fingers (x), hinge to the thumb (y), so that a turn by +angle about it, x to -z,
/// closes the hand. A left hand is the mirror image in y: `along` is mirrored as a vector, `hinge` as an
/// axis, with its sign turned besides. A metacarpal that stands almost out of the palm leaves no hinge; then
/// the palm's own axes serve.
RootFrame root_frame(const Hand& hand, int finger) {
  const Matrix3 palm = hand.palm.orientation.toRotationMatrix();
  if (finger == 0) {
    const double side = hand.side == Side::left ? -1.0 : 1.0;
    const Vector3 along = thumb_rest().along, hinge = side * thumb_rest().hinge;
    const Vector3 mirror(1.0, side, 1.0);
    return {palm * along.cwiseProduct(mirror), palm * hinge.cwiseProduct(mirror)};
  }
  const int metacarpal = capsule_index(finger, 0);
  const Vector3 along = hand.has(metacarpal) ? direction(hand.capsules[metacarpal]) : palm.col(0);
  const Vector3 across = palm.col(2).cross(along);
  if (across.squaredNorm() < 0.01) return {palm.col(0), palm.col(1)};
  return {along, across.normalized()};
}

/// The hand with its palm lagging behind.
///     x' = c + R (x - c),   R_palm' = lag.frame R R_palm,   c the palm's position, R = lag.whole
void turn_palm(const Hand& tracked, const PalmLag& lag, Hand& turned) {
  turned = tracked;
  const Vector3& centre = tracked.palm.position;
  const Matrix3 whole = lag.whole.toRotationMatrix();
  turned.wrist = centre + whole * (tracked.wrist - centre);
  for (Capsule& capsule : turned.capsules) {
    capsule.start = centre + whole * (capsule.start - centre);
    capsule.end = centre + whole * (capsule.end - centre);
  }
  turned.palm.orientation = (lag.frame * lag.whole * tracked.palm.orientation).normalized();
}

}  // namespace

FingerChain::FingerChain(const Hand& tracked, int finger, const Vector3& shift, const Hand* lags_behind)
    : finger_(finger), tied_(has(tracked, 1)) {
  for (int index = 0; index < kBonesPerFinger; ++index) joints_[index] = bone(tracked, index).start + shift;
  find_axes(tracked);
  find_limits(tracked, lags_behind);
  placed_swing_ = swing_;
  placed_hinge_ = hinge_;
}

/// At the finger as tracked: swing is across the proximal phalanx and the root's axis, hinge is the root's
/// axis less its part along the phalanx, (along x root) x along.
void FingerChain::find_axes(const Hand& tracked) {
  root_ = Vector3::UnitY(), swing_ = Vector3::UnitZ(), hinge_ = Vector3::UnitY();
  if (!tied_) return;
  const RootFrame frame = root_frame(tracked, finger_);
  const Vector3 along = direction(bone(tracked, 1));
  root_ = frame.hinge;
  onward_ = frame.along;
  swing_ = along.cross(root_).normalized();
  hinge_ = swing_.cross(along);
  if (finger_ != 0 || !has(tracked, 2) || !has(tracked, 3)) return;
  // An opposing thumb turns about its own length: the bend itself then shows the axis.
  const Vector3 middle = direction(bone(tracked, 2));
  Vector3 bent = along.cross(middle) + middle.cross(direction(bone(tracked, 3)));
  bent -= bent.dot(along) * along;
  const double length = bent.norm();
  if (length > 0.0) {
    const Vector3 blended = kAnatomicalWeight * hinge_ + (std::max(0.0, bent.dot(hinge_)) / length) * bent;
    hinge_ = blended.normalized();
  }
}

/// Offsets count from the tracked angles: lower <= angle + offset <= upper. Limits are widened to the tracked
/// angle, so that 0 is allowed. The reach of a joint is the length of the bones beyond it, which bounds its
/// distance from the tip.
void FingerChain::find_limits(const Hand& tracked, const Hand* lags_behind) {
  const auto length = [&](int index) {
    return (bone(tracked, index).end - bone(tracked, index).start).norm();
  };
  lower_.setZero(), upper_.setZero(), reach_.setZero(), angles_.setZero();
  if (!tied_) {
    lower_.head<3>().setConstant(-1.0), upper_.head<3>().setConstant(1.0);
    return;
  }
  angles_ = angles(tracked, hinge_);
  std::array<bool, 4> free{{true, true, false, false}};
  reach_[0] = length(1);
  for (int joint = 2; joint < kBonesPerFinger && has(tracked, joint) && has(tracked, joint - 1); ++joint) {
    free[joint] = true;
    reach_.head(joint + 1) += length(joint);
  }
  reach_[1] = reach_[0];
  const FingerOffset as_tracked =
      lags_behind == nullptr ? angles_ : FingerChain(*lags_behind, finger_, Vector3::Zero()).angles_;
  const JointLimits limits = joint_limits(finger_);
  for (int i = 0; i < 4; ++i) {
    if (!free[i]) continue;
    lower_[i] = std::min(as_tracked[i], limits.lower[i]) - angles_[i];
    upper_[i] = std::max(as_tracked[i], limits.upper[i]) - angles_[i];
  }
}

/// With the frame (onward, root, up = onward x root): flexion atan2(-along.up, along.onward), abduction the
/// angle off the plane of onward and up, towards root. A hinge's angle is that between the bones before and
/// after, a and b, with its sign: atan2((a x b).hinge, a.b). What bends sideways there is not seen, and stays
/// as it is.
FingerOffset FingerChain::angles(const Hand& hand, const Vector3& hinge) const {
  const Vector3 along = direction(bone(hand, 1));
  const double onward = along.dot(onward_), upward = along.dot(onward_.cross(root_)),
               aside = along.dot(root_);
  FingerOffset angles(std::atan2(-upward, onward), std::atan2(aside, std::hypot(onward, upward)), 0.0, 0.0);
  for (int joint = 2; joint < kBonesPerFinger && has(hand, joint) && has(hand, joint - 1); ++joint) {
    const Vector3 before = direction(bone(hand, joint - 1)), after = direction(bone(hand, joint));
    angles[joint] = std::atan2(before.cross(after).dot(hinge), before.dot(after));
  }
  return angles;
}

FingerOffset FingerChain::pointing(const Hand& shown, const FingerChain& chain) const {
  if (!tied_ || !chain.tied_) return FingerOffset::Zero();
  return angles(shown, chain.placed_hinge_) - angles_;
}

FingerOffset FingerChain::like(const Hand& shown, const FingerChain& chain) const {
  return pointing(shown, chain).max(lower_).min(upper_);
}

/// Forward kinematics by products of exponentials, all axes as tracked: R_1 = exp(o0 root) exp(o1 swing),
/// R_k = R_{k-1} exp(o_k hinge). The factor on the right is the first to act, in the tracked finger's frame,
/// so that what turns a joint carries the axes of all beyond it; hinge is the same before and after its own
/// turn. With no offset points are added, not turned: the tracked hand to the last bit.
void FingerChain::place(const Hand& tracked, const FingerOffset& offset, const Vector3& shift, Hand& placed) {
  const int first = capsule_index(finger_, 0);
  placed_swing_ = swing_;
  placed_hinge_ = hinge_;
  const bool turned = tied_ && !(offset == 0.0).all();
  Matrix3 turn = Matrix3::Identity();
  if (turned) {
    const Matrix3 flexed = turn_about(root_, offset[0]);
    turn = flexed * turn_about(swing_, offset[1]);
    placed_swing_ = flexed * swing_;
    placed_hinge_ = turn * hinge_;
  }
  const Vector3 moved = tied_ ? shift : Vector3(shift + offset.head<3>().matrix());
  const Capsule* before = nullptr;
  Vector3 joint;
  for (int index = 1; index < kBonesPerFinger; ++index) {
    const Capsule& from = tracked.capsules[first + index];
    Capsule& to = placed.capsules[first + index];
    if (from.radius <= 0.0) continue;
    if (!turned) {
      to.start = from.start + moved;
      to.end = from.end + moved;
      joints_[index] = to.start;
      continue;
    }
    joint = before == nullptr ? Vector3(from.start + moved)
                              : Vector3(joint + turn * (from.start - before->start));
    if (index > 1 && offset[index] != 0.0) turn = turn * turn_about(hinge_, offset[index]);
    to.start = joints_[index] = joint;
    to.end = joint + turn * (from.end - from.start);
    before = &from;
  }
}

/// A turn about the axis a through the joint p moves x by a x (x - p), so that n.x grows by n.(a x (x - p)) =
/// a.((x - p) x n).
FingerOffset FingerChain::gradient(int bone, const Vector3& x, const Vector3& n) const {
  if (!tied_) return {n.x(), n.y(), n.z(), 0.0};
  const Vector3 at_root = (x - joints_[1]).cross(n);
  FingerOffset gradient(root_.dot(at_root), placed_swing_.dot(at_root), 0.0, 0.0);
  for (int joint = 2; joint <= bone; ++joint)
    gradient[joint] = placed_hinge_.dot((x - joints_[joint]).cross(n));
  return gradient;
}

/// sum |turn| reach: arcs are no shorter than chords, and turns of a chain add at most.
double FingerChain::displacement(const FingerOffset& change) const {
  if (!tied_) return change.head<3>().matrix().norm();
  return (change.abs() * reach_).sum();
}

FingerOffset FingerChain::swing(double distance) const {
  if (!tied_) return FingerOffset::Constant(distance);
  return distance * FingerOffset(1.0, 0.5, 0.5, 0.5) / reach_.max(kMinReach);
}

FingerOffset FingerChain::compliance() const {
  if (!tied_) return FingerOffset(kLooseCompliance, kLooseCompliance, kLooseCompliance, 0.0);
  return {kFlexionCompliance, kAbductionCompliance, kFlexionCompliance, kFlexionCompliance};
}

JointLimits joint_limits(int finger) {
  if (finger == 0) {
    return {kDegree * FingerOffset(-35.0, -40.0, -15.0, -20.0),
            kDegree * FingerOffset(50.0, 55.0, 60.0, 85.0)};
  }
  return {kDegree * FingerOffset(-40.0, -25.0, -5.0, -20.0), kDegree * FingerOffset(95.0, 25.0, 115.0, 85.0)};
}

const RootFrame& thumb_rest() {
  static const Quaternion turn = Eigen::AngleAxisd(38.0 * kDegree, Vector3::UnitZ()) *
                                 Eigen::AngleAxisd(18.0 * kDegree, Vector3::UnitY()) *
                                 Eigen::AngleAxisd(-60.0 * kDegree, Vector3::UnitX());
  static const RootFrame rest{turn * Vector3::UnitX(), turn * Vector3::UnitY()};
  return rest;
}

void HandChain::begin(const Hand& tracked, const PalmLag& lag) {
  tracked_ = &tracked;
  lags_behind_ = nullptr;
  if (!lag.zero()) {
    lags_behind_ = &tracked;
    turn_palm(tracked, lag, turned_);
    tracked_ = &turned_;
  }
  shift_.setZero();
  known_.fill(false);
}

/// A finger that has had a chain goes through it from then on, also without an offset: its joints must be
/// known as placed now.
void HandChain::place(const HandOffset& offset, Hand& placed) {
  shift_ = offset.shift;
  placed.palm = {tracked_->palm.position + shift_, tracked_->palm.orientation};
  placed.wrist = tracked_->wrist + shift_;
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& from = tracked_->capsules[c];
    if (from.radius <= 0.0) continue;
    const int moves = finger_that_moves(c);
    if (moves >= 0 && known_[moves]) continue;
    placed.capsules[c].start = from.start + shift_;
    placed.capsules[c].end = from.end + shift_;
  }
  for (int f = 0; f < kFingers; ++f) {
    const FingerOffset& turned = offset.fingers[f];
    if (known_[f] || !(turned == 0.0).all()) finger(f).place(*tracked_, turned, shift_, placed);
  }
}

FingerChain& HandChain::finger(int f) {
  if (!known_[f]) {
    fingers_[f] = FingerChain(*tracked_, f, shift_, lags_behind_);
    known_[f] = true;
  }
  return fingers_[f];
}

}  // namespace mrhi
