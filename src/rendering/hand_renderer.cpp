#include <algorithm>
#include <cmath>

#include "../collision/neighbours.h"
#include "renderer.h"

namespace mrhi {
namespace {

/// Search margin around a hand that is pushed out: it may meet bodies within this distance [m].
constexpr double kPushMargin = 0.1;
/// Displacement that is assumed for a hand without a previous frame [m].
constexpr double kUnknownDisplacement = 1.0;
/// Longest time for which a hand stays behind a body that the tracked hand has passed through [ns], without
/// coming nearer by this [m].
constexpr Nanoseconds kMaxTimeBehind = 1'000'000'000;
constexpr double kMinProgress = 0.001;

/// Search margin for bodies around the tracked hand [m].
double margin(const HandOffset& offset) {
  return offset.zero() ? kLookAhead : offset.shift.norm() + kPushMargin;
}

/// Compares bits: a hand placed again from the same numbers is the same.
bool same_place(const Hand& a, const Hand& b) {
  const auto same = [](const Capsule& x, const Capsule& y) {
    return x.radius == y.radius && x.start == y.start && x.end == y.end;
  };
  return a.palm.position == b.palm.position && a.wrist == b.wrist &&
         a.palm.orientation.coeffs() == b.palm.orientation.coeffs() &&
         std::equal(a.capsules.begin(), a.capsules.end(), b.capsules.begin(), same);
}

bool same_offset(const HandOffset& a, const HandOffset& b) {
  const auto same = [](const FingerOffset& x, const FingerOffset& y) { return (x == y).all(); };
  return a.shift == b.shift && a.lag.whole.coeffs() == b.lag.whole.coeffs() &&
         a.lag.frame.coeffs() == b.lag.frame.coeffs() &&
         std::equal(a.fingers.begin(), a.fingers.end(), b.fingers.begin(), same);
}

/// The search for axes of the palm ends when joint limits displace phalanges by less than this [m].
constexpr double kMaxLimitDisplacement = 0.0005;
/// First and last turn of that search [rad].
constexpr double kFirstTurn = 0.2, kLastTurn = 0.02;
/// Smallest cross product of the palm's bones that defines its axes [m^2].
constexpr double kMinPalmArea = 1e-4;

/// Axes of a palm from its bones (wrist, roots of index and little finger), or its orientation without them.
/// x points from the wrist between both roots, z is normal to both, y = z x x. z points out of a right hand's
/// palm and out of a left hand's back; only rotations between two poses of one hand are computed.
Quaternion axes_by_bones(const Hand& hand) {
  const int index = capsule_index(1, 1), little = capsule_index(4, 1);
  if (!hand.has(index) || !hand.has(little)) return hand.palm.orientation;
  const Vector3 a = hand.capsules[index].start - hand.wrist;
  const Vector3 b = hand.capsules[little].start - hand.wrist;
  const Vector3 out = a.cross(b);
  if (out.norm() < kMinPalmArea) return hand.palm.orientation;
  Matrix3 axes;
  axes.col(0) = (a + b).normalized();
  axes.col(2) = out.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quaternion(axes);
}

/// Time constant with which an offset returns to zero [s].
constexpr double kTimeConstant = 0.05;
/// Largest return of the hand in a frame, and again of a finger on it [m].
constexpr double kMaxReturn = 0.0008;
/// Largest return of a fingertip with the palm in a frame [m].
constexpr double kMaxPalmReturn = 0.0004;
/// Offsets below this are zero [m].
constexpr double kMinOffset = 1e-6;
/// Distance from the palm's position to the fingertips, and from a finger's root to its tip [m].
constexpr double kHandReach = 0.15, kFingerReach = 0.1;

/// Fraction of an offset of the size `distance` [m] that remains after a frame. The offset decays
/// exponentially, but by no more than `max_return` [m] a frame.
double remaining_fraction(double distance, double decay, double max_return = kMaxReturn) {
  if (distance <= kMinOffset) return 0.0;
  return 1.0 - std::min(1.0 - decay, max_return / distance);
}

Quaternion turned_back(const Quaternion& turn, double reach, double decay) {
  const double angle = turn.angularDistance(Quaternion::Identity());
  const double left = remaining_fraction(reach * angle, decay, kMaxPalmReturn);
  return left == 0.0 ? Quaternion::Identity() : Quaternion::Identity().slerp(left, turn);
}

double decay_since(const HandOffset& offset, Nanoseconds stamp) {
  return std::exp(-to_seconds(stamp - offset.stamp) / kTimeConstant);
}

/// The offset after a frame's return towards zero, within the present limits of the joints. `chain` has the
/// palm with its lag after the frame (lag_returning).
HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain) {
  HandOffset left = offset;
  if (offset.zero()) return left;
  left.lag = lag_returning(offset, stamp);
  const double decay = decay_since(offset, stamp);
  left.shift *= remaining_fraction(offset.shift.norm(), decay);
  for (int f = 0; f < kFingers; ++f) {
    FingerOffset& turned = left.fingers[f];
    if ((turned == 0.0).all() && left.lag.zero()) continue;
    const FingerChain& finger = chain.finger(f);
    turned = turned.max(finger.lower()).min(finger.upper());
    turned *= remaining_fraction(finger.displacement(turned), decay);
    if (!left.lag.zero()) turned = turned.max(finger.lower()).min(finger.upper());
  }
  return left;
}

}  // namespace

/// Points are weighted by the share w of each contact. Running mean: m <- m + w / sum w (x - m).
void note_touches(const std::vector<Contact>& contacts, int slot, RenderedHand& rendered) {
  rendered.touching.fill(false);
  std::array<double, kCapsules> shares{};
  for (const Contact& contact : contacts) {
    if (contact.key.hand != slot || !contact.touching()) continue;
    const std::size_t c = contact.key.capsule;
    Pressed& pressed = rendered.pressed[c];
    if (!rendered.touching[c]) pressed = Pressed();
    rendered.touching[c] = true;
    pressed.force += std::abs(contact.normal.dot(contact.force));
    shares[c] += contact.share;
    if (shares[c] > 0.0) pressed.point += contact.share / shares[c] * (contact.point - pressed.point);
  }
}

void HandRenderer::render(HandFrameView& view, HandOffset& offset, RenderedHand& rendered) {
  note_touches(view.contacts, view.slot, rendered);
  if (view.track.appeared) offset = HandOffset();
  view_ = &view;
  last_ = &offset, placed_ = &rendered.hand;
  keep_outside(begin());
  for (const bool fixtures : {false, true}) {
    const bool stays_behind = left_behind();
    if (leap_ <= kMaxDepth && !stays_behind) break;
    if (!show_in(fixtures)) continue;
    keep_outside(finder_.begin(view, margin(offset)));
  }
  if (offset_.zero()) rendered.hand = view.track.current;
  offset_.stamp = view.stamp;
  offset = offset_;
  if (!offset.zero()) shown_[view.slot] = {view.track.current, rendered.hand, offset};
}

/// Places the hand outside all bodies except those that it is shown in. `near`: the finder has found bodies.
void HandRenderer::keep_outside(bool near) {
  *placed_ = view_->track.current;
  view_->shown_before = nullptr;
  view_->moved = 0.0;
  const bool is_offset = !last_->zero();
  offset_ = HandOffset();
  clearances_.clear();
  if (is_offset || near) {
    chain_.begin(view_->track.current, lag_returning(*last_, view_->stamp));
    offset_ = returning(*last_, view_->stamp, chain_);
    chain_.place(offset_, *placed_);
  }
  const HandOffset reference = offset_;
  const double min_gap = near ? finder_.find(*placed_, clearances_) : 0.0;
  penetrates_ = min_gap < -kClearDepth;
  leap_ = 0.0;
  if (penetrates_ || is_offset) look_back();
  if (penetrates_) move_outside(min_gap);
  if (view_->shown_before != nullptr) limit_pace(reference);
}

/// Called if the hand can only leave the bodies by a leap: it is then shown in them until it is clear, as in
/// a body that is spawned there. Returns false if it was shown in all of them already.
bool HandRenderer::show_in(bool fixtures) const {
  bool any = false;
  for (const Clearance& clearance : clearances_) {
    const bool fixed = finder_.fixed(clearance.key.body);
    if (fixed && !fixtures) continue;
    any = any || !view_->interactions[clearance.key.body].shown_in;
    view_->interactions[clearance.key.body].shown_in = true;
  }
  return any;
}

/// Finds the bodies near the hand, except those that it is shown in. The hand is no longer shown in bodies
/// that it was clear of in the previous frame.
bool HandRenderer::begin() {
  const bool near = finder_.begin(*view_, margin(*last_));
  if (!finder_.shown_in_any()) return near;
  const Hand& from = view_->track.appeared ? view_->track.current : view_->track.previous;
  Hand shown = from;
  chain_before_.begin(from, last_->lag);
  chain_before_.place(*last_, shown);
  finder_.end_shown_in(shown);
  return finder_.begin(*view_, margin(*last_));
}

/// Places the hand as it was shown in the previous frame.
///
/// `moved` bounds the relative displacement since then: that of the farthest joint, and |v| + |w| R of the
/// fastest body times the time.
void HandRenderer::look_back() {
  if (last_->zero()) finder_.begin(*view_, kPushMargin);
  view_->moved = kUnknownDisplacement;
  if (view_->track.appeared) return;
  const Shown& known = shown_[view_->slot];
  if (same_offset(known.offset, *last_) && same_place(known.tracked, view_->track.previous)) {
    before_ = known.hand;
  } else {
    place_before();
  }
  view_->shown_before = &before_;
  tracked_displacement_ = farthest_joint(view_->track.previous, view_->track.current);
  elapsed_ = to_seconds(view_->stamp - last_->stamp);
  view_->moved = tracked_displacement_ + finder_.fastest_body() * elapsed_;
}

void HandRenderer::place_before() {
  before_ = view_->track.previous;
  chain_before_.begin(view_->track.previous, last_->lag);
  chain_before_.place(*last_, before_);
}

/// True once the tracked hand has been clear of all bodies for kMaxTimeBehind and the rendered hand has not
/// come nearer to it.
bool HandRenderer::left_behind() {
  const auto holds = [&](const Contact& contact) {
    return contact.key.hand == view_->slot && contact.touching();
  };
  const bool held = std::any_of(view_->contacts.begin(), view_->contacts.end(), holds);
  if (!penetrates_ || held || !finder_.clear(view_->track.current)) {
    offset_.left = 0.0;
    return false;
  }
  const double left = displacement(HandOffset(), offset_);
  if (offset_.left == 0.0 || left < offset_.left - kMinProgress) {
    offset_.left = left;
    offset_.left_since = view_->stamp;
  }
  return view_->stamp - offset_.left_since >= kMaxTimeBehind;
}

double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies, const Interaction* interactions) {
  double deepest = 0.0;
  const std::vector<int> near = near_bodies(hand, scene, bodies, 0.0);
  for (int capsule = 0; capsule < kCapsules; ++capsule) {
    if (!hand.has(capsule)) continue;
    for (const int body : near) {
      if (interactions[body].shown_in) continue;
      for (int shape = 0; shape < static_cast<int>(scene.bodies[body].shapes.size()); ++shape) {
        const auto features = finder.closest(hand.capsules[capsule], body, shape, bodies[body].pose, 0.0);
        if (features) deepest = std::max(deepest, -features->distance);
      }
    }
  }
  return deepest;
}

/// Distance by which joint limits keep phalanges from where they were shown, with this lag, summed over the
/// fingers [m].
double HandRenderer::limit_displacement(const PalmLag& lag) {
  chain_.begin(view_->track.current, lag);
  double held = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const FingerChain& finger = chain_.finger(f);
    const FingerOffset pointed = finger.pointing(before_, chain_before_.finger(f));
    held += finger.displacement(pointed - pointed.max(finger.lower()).min(finger.upper()));
  }
  return held;
}

/// The frame lag with which the palm's axes stay as they were shown: frame whole R_tracked = R_before.
Quaternion HandRenderer::frame_staying(const Quaternion& whole) const {
  return (before_.palm.orientation * (whole * view_->track.current.palm.orientation).conjugate())
      .normalized();
}

/// The lag with which the palm's bones stay as they were shown. Its axes, about which joint limits count, are
/// chosen so that the fingers can stay as well. Compass search: turns about each world axis either way while
/// that improves, then half the turn. The objective has kinks, so no derivative is used.
PalmLag HandRenderer::lag_staying() {
  place_before();
  PalmLag lag;
  lag.whole = (axes_by_bones(before_) * axes_by_bones(view_->track.current).conjugate()).normalized();
  double held = limit_displacement(lag);
  const auto try_frame = [&](const Quaternion& frame) {
    const PalmLag other{lag.whole, frame.normalized()};
    const double then = limit_displacement(other);
    if (then >= held) return false;
    held = then, lag = other;
    return true;
  };
  try_frame(frame_staying(lag.whole));
  for (double turn = kFirstTurn; turn > kLastTurn && held > kMaxLimitDisplacement; turn *= 0.5) {
    for (int direction = 0; direction < 6; ++direction) {
      const Vector3 axis = (direction < 3 ? 1.0 : -1.0) * Vector3::Unit(direction % 3);
      while (held > kMaxLimitDisplacement &&
             try_frame(Quaternion(Eigen::AngleAxisd(turn, axis)) * lag.frame)) {
      }
    }
  }
  return lag;
}

bool HandOffset::zero() const {
  if (!lag.zero()) return false;
  for (const FingerOffset& finger : fingers) {
    if (!(finger == 0.0).all()) return false;
  }
  return shift == Vector3::Zero();
}

PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp) {
  PalmLag left;
  if (offset.lag.zero()) return left;
  const double decay = decay_since(offset, stamp);
  left.whole = turned_back(offset.lag.whole, kHandReach, decay);
  left.frame = turned_back(offset.lag.frame, kFingerReach, decay);
  return left;
}

}  // namespace mrhi
