#include "hand_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/tracking/hand_track.h"
#include "renderer.h"

namespace mrhi {
namespace {

constexpr double kFarthestPush = 0.1;  // bodies nearer than this may be met while the hand is pushed out [m]
constexpr double kFromNowhere = 1.0;   // that a hand is said to have moved that was not there before [m]
/// A hand stays this long behind a body that the tracked hand has passed through, without coming nearer by as
/// much as this [m].
constexpr Nanoseconds kStaysBehind = 1'000'000'000;
constexpr double kProgress = 0.001;

/// Around the tracked hand, in which bodies are looked for [m].
double margin(const HandOffset& offset) {
  return offset.zero() ? kAhead : offset.shift.norm() + kFarthestPush;
}

/// To the bit: what is placed anew from the same numbers is the same.
bool same_place(const Hand& a, const Hand& b) {
  const auto same = [](const Capsule& x, const Capsule& y) {
    return x.radius == y.radius && x.start == y.start && x.end == y.end;
  };
  return a.palm.position == b.palm.position && a.wrist == b.wrist &&
         a.palm.orientation.coeffs() == b.palm.orientation.coeffs() &&
         std::equal(a.capsules.begin(), a.capsules.end(), b.capsules.begin(), same);
}

bool same_way(const HandOffset& a, const HandOffset& b) {
  const auto same = [](const FingerOffset& x, const FingerOffset& y) { return (x == y).all(); };
  return a.shift == b.shift && a.lag.whole.coeffs() == b.lag.whole.coeffs() &&
         a.lag.frame.coeffs() == b.lag.frame.coeffs() &&
         std::equal(a.fingers.begin(), a.fingers.end(), b.fingers.begin(), same);
}

constexpr double kHeld = 0.0005;    // joints that their limits keep from staying by less do not matter [m]
constexpr double kFirstTurn = 0.2;  // of the search for axes of the palm in which they can [rad]
constexpr double kLastTurn = 0.02;  // [rad]
constexpr double kFlatPalm = 1e-4;  // less than this is no palm [m^2]

/// Axes of a palm by its bones: wrist and roots of index and little finger. By its orientation if it has
/// none. x between the roots of index and little finger as seen from the wrist, z across both, y = z x x. z
/// points into a right hand's palm and out of a left hand's back: no matter, as only the turn between two of
/// one hand is asked for.
Quaternion axes_by_bones(const Hand& hand) {
  const int index = capsule_index(1, 1), little = capsule_index(4, 1);
  if (!hand.has(index) || !hand.has(little)) return hand.palm.orientation;
  const Vector3 a = hand.capsules[static_cast<std::size_t>(index)].start - hand.wrist;
  const Vector3 b = hand.capsules[static_cast<std::size_t>(little)].start - hand.wrist;
  const Vector3 out = a.cross(b);
  if (out.norm() < kFlatPalm) return hand.palm.orientation;
  Matrix3 axes;
  axes.col(0) = (a + b).normalized();
  axes.col(2) = out.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quaternion(axes);
}

constexpr double kTimeConstant = 0.05;   // [s]
constexpr double kLongestWay = 0.0008;   // in a frame, of the hand, and again of a finger on it [m]
constexpr double kHome = 1e-6;           // nearer than this is back [m]
constexpr double kLongestTurn = 0.0004;  // in a frame, of a fingertip with the palm [m]
constexpr double kHandReach = 0.15;      // of the hand from its palm's position [m]
constexpr double kFingerReach = 0.1;     // of a finger from its root [m]

/// What is left of an offset that reaches this far. An offset of the size `way` goes back by the part 1 -
/// exp(-t / 50 ms), but by no more than `longest`: exponential when near, a constant way a frame when far.
double share_left(double way, double decayed, double longest = kLongestWay) {
  if (way <= kHome) return 0.0;
  return 1.0 - std::min(1.0 - decayed, longest / way);
}

Quaternion turned_back(const Quaternion& turn, double reach, double decayed) {
  const double angle = turn.angularDistance(Quaternion::Identity());
  const double left = share_left(reach * angle, decayed, kLongestTurn);
  return left == 0.0 ? Quaternion::Identity() : Quaternion::Identity().slerp(left, turn);
}

double decayed_share(const HandOffset& offset, Nanoseconds stamp) {
  return std::exp(-to_seconds(stamp - offset.stamp) / kTimeConstant);
}

/// The offset on its way back to none, likewise, within the joints' limits of now: an offset that was right a
/// frame ago may be beyond them. `chain` has the palm so (lag_returning).
HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain) {
  HandOffset left = offset;
  if (offset.zero()) return left;
  left.lag = lag_returning(offset, stamp);
  const double decayed = decayed_share(offset, stamp);
  left.shift *= share_left(offset.shift.norm(), decayed);
  for (int f = 0; f < kFingers; ++f) {
    FingerOffset& turned = left.fingers[static_cast<std::size_t>(f)];
    if ((turned == 0.0).all() && left.lag.zero()) continue;
    const FingerChain& finger = chain.finger(f);
    turned = turned.max(finger.lower()).min(finger.upper());
    turned *= share_left(finger.way(turned), decayed);
    if (!left.lag.zero()) turned = turned.max(finger.lower()).min(finger.upper());
  }
  return left;
}

}  // namespace

/// By the share of each contact. The mean, by shares w, as it goes: m <- m + w / sum w (x - m).
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

HandRenderer::HandRenderer(const Scene& scene, const ContactFinder& finder)
    : impl_(std::make_unique<Impl>(scene, finder)) {}
HandRenderer::~HandRenderer() = default;

void HandRenderer::render(const HandTrack& track, int slot, Nanoseconds stamp,
                          const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts,
                          Interaction* interactions, HandOffset& offset, RenderedHand& rendered) {
  Impl& impl = *impl_;
  note_touches(contacts, slot, rendered);
  if (track.appeared) offset = HandOffset();
  ClearanceFinder::Setting setting{track.current, slot, bodies, contacts, nullptr, 0.0, interactions};
  impl.setting = &setting, impl.track = &track, impl.stamp = stamp;
  impl.last = &offset, impl.placed = &rendered.hand;
  impl.keep_outside(impl.begin());
  for (const bool fixtures : {false, true}) {
    const bool stays_behind = impl.left_behind();
    if (impl.leap <= kTolerated && !stays_behind) break;
    if (!impl.show_in(fixtures)) continue;
    impl.keep_outside(impl.finder.begin(setting, margin(offset)));
  }
  const bool away = !impl.offset.zero();
  if (!away) rendered.hand = track.current;
  impl.offset.stamp = stamp;
  offset = impl.offset;
  if (away) impl.kept[static_cast<std::size_t>(slot)] = {true, track.current, rendered.hand, offset};
}

/// The hand outside of all bodies but those that it is shown in; the finder has begun with what is `near` it.
void HandRenderer::Impl::keep_outside(bool near) {
  *placed = track->current;
  setting->shown_before = nullptr;
  setting->moved = 0.0;
  const bool away = !last->zero();
  offset = HandOffset();
  clearances.clear();
  if (away || near) {
    chain.begin(track->current, lag_returning(*last, stamp));
    offset = returning(*last, stamp, chain);
    chain.place(offset, *placed);
  }
  const HandOffset reference = offset;
  const double least = near ? finder.find(*placed, *setting, kAhead, clearances) : 0.0;
  pushed = least < -kClear;
  leap = 0.0;
  if (pushed || away) look_back();
  if (pushed) push_out(least);
  if (setting->shown_before != nullptr) keep_pace(reference);
}

/// Bodies and joints leave the hand no way out that is not a leap: it is shown in them until it is clear of
/// them, as in a body that appears. True if there are such.
bool HandRenderer::Impl::show_in(bool fixtures) const {
  bool any = false;
  for (const Clearance& clearance : clearances) {
    const bool fixed = finder.fixed(clearance.key.body);
    if (fixed && !fixtures) continue;
    any = any || !setting->interactions[clearance.key.body].shown_in;
    setting->interactions[clearance.key.body].shown_in = true;
  }
  return any;
}

/// Finds what is near the hand, but for what it is shown in. That ends with what the hand, as it was shown,
/// was clear of.
bool HandRenderer::Impl::begin() {
  const bool near = finder.begin(*setting, margin(*last));
  if (!finder.shown_in_any()) return near;
  const Hand& from = track->appeared ? track->current : track->previous;
  Hand shown = from;
  chain_before.begin(from, last->lag);
  chain_before.place(*last, shown);
  finder.end_shown_in(shown, setting->interactions);
  return finder.begin(*setting, margin(*last));
}

/// At the frame before.
///
/// `moved` bounds what can have come into each other since: the farthest joint's way and the fastest body's,
/// |v| + |w| R times the time.
void HandRenderer::Impl::look_back() {
  if (last->zero()) finder.begin(*setting, kFarthestPush);
  setting->moved = kFromNowhere;
  if (track->appeared) return;
  const Shown& known = kept[static_cast<std::size_t>(setting->slot)];
  tracked_before = track->previous;
  offset_before = *last;
  chain_before_set = false;
  if (known.known && same_way(known.offset, offset_before) && same_place(known.tracked, tracked_before)) {
    before = known.hand;
  } else {
    place_before();
  }
  setting->shown_before = &before;
  tracked_way = farthest_joint(track->previous, track->current);
  elapsed = to_seconds(stamp - offset_before.stamp);
  setting->moved = tracked_way + finder.fastest_body(setting->bodies) * elapsed;
}

void HandRenderer::Impl::place_before() {
  before = tracked_before;
  chain_before.begin(tracked_before, offset_before.lag);
  chain_before.place(offset_before, before);
  chain_before_set = true;
}

/// As it was placed then.
FingerChain& HandRenderer::Impl::finger_before(int index) {
  if (!chain_before_set) place_before();
  return chain_before.finger(index);
}

/// True once the tracked hand has been clear of everything for a while and the rendered one has not come any
/// nearer to it.
bool HandRenderer::Impl::left_behind() {
  const auto holds = [&](const Contact& contact) {
    return contact.key.hand == setting->slot && contact.touching();
  };
  const bool held = std::any_of(setting->contacts.begin(), setting->contacts.end(), holds);
  if (!pushed || held || !finder.clear(setting->tracked)) {
    offset.left = 0.0;
    return false;
  }
  const double left = way(HandOffset(), offset);
  if (offset.left == 0.0 || left < offset.left - kProgress) {
    offset.left = left;
    offset.left_since = stamp;
  }
  return stamp - offset.left_since >= kStaysBehind;
}

double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies, const Interaction* interactions) {
  double deepest = 0.0;
  const std::vector<int> near = near_bodies(hand, scene, bodies, 0.0);
  for (int capsule = 0; capsule < kCapsules; ++capsule) {
    if (!hand.has(capsule)) continue;
    for (const int body : near) {
      const auto b = static_cast<std::size_t>(body);
      if (interactions[b].shown_in) continue;
      for (int shape = 0; shape < static_cast<int>(scene.bodies[b].shapes.size()); ++shape) {
        const auto features = finder.closest(hand.capsules[static_cast<std::size_t>(capsule)], body, shape,
                                             bodies[b].pose, 0.0);
        if (features) deepest = std::max(deepest, -features->distance);
      }
    }
  }
  return deepest;
}

/// With this lag, how far joints' limits keep phalanges from where they were shown, all fingers together [m].
double HandRenderer::Impl::held_by_limits(const PalmLag& lag) {
  chain.begin(setting->tracked, lag);
  double held = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const FingerChain& finger = chain.finger(f);
    const FingerOffset wanted = finger.pointing(before, finger_before(f));
    held += finger.way(wanted - wanted.max(finger.lower()).min(finger.upper()));
  }
  return held;
}

/// The palm's axes are not turned from how they were shown. frame whole R_tracked = R_before.
Quaternion HandRenderer::Impl::frame_staying(const Quaternion& whole) const {
  return (before.palm.orientation * (whole * setting->tracked.palm.orientation).conjugate()).normalized();
}

/// The palm's bones are not turned from how they were shown; its axes, to which joints' limits count, such
/// that the fingers can stay too, as far as there are such. Compass search: a turn about each axis of world
/// either way, as long as it is better, then half the turn. What limits hold has kinks, so that no derivative
/// is asked for.
PalmLag HandRenderer::Impl::lag_staying() {
  PalmLag lag;
  lag.whole = (axes_by_bones(before) * axes_by_bones(setting->tracked).conjugate()).normalized();
  double held = held_by_limits(lag);
  const auto try_frame = [&](const Quaternion& frame) {
    const PalmLag other{lag.whole, frame.normalized()};
    const double then = held_by_limits(other);
    if (then >= held) return false;
    held = then, lag = other;
    return true;
  };
  try_frame(frame_staying(lag.whole));
  for (double turn = kFirstTurn; turn > kLastTurn && held > kHeld; turn *= 0.5) {
    for (int direction = 0; direction < 6; ++direction) {
      const Vector3 axis = (direction < 3 ? 1.0 : -1.0) * Vector3::Unit(direction % 3);
      while (held > kHeld && try_frame(Quaternion(Eigen::AngleAxisd(turn, axis)) * lag.frame)) {
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
  const double decayed = decayed_share(offset, stamp);
  left.whole = turned_back(offset.lag.whole, kHandReach, decayed);
  left.frame = turned_back(offset.lag.frame, kFingerReach, decayed);
  return left;
}

}  // namespace mrhi
