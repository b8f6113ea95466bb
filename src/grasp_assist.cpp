#include "grasp_assist.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mrhi {
namespace {

/// As deep as a pulp gives, the springs of contact hold a body [m].
constexpr double kPulp = 0.003;
/// Fingers close if their opening shrinks faster than this [m/s], and than this part of the speed at which
/// they or what they close against move: a hand that slaps or nudges does not close.
constexpr double kClosingSpeed = 0.03;
constexpr double kClosingPart = 0.3;
/// A body between the fingers that is slower than this is not caught: they close round it [m/s].
constexpr double kSlow = 0.1;
/// Normals nearer to the way of gravity than this (cosine) bear the weight of a body: there nothing gives
/// way.
constexpr double kBears = 0.3;
/// A touch that gives way from its first step on [m].
constexpr double kBegins = 1e-6;
/// So many fingers that close on a body grab it.
constexpr int kGrab = 2;
/// Of a body near the line from a finger to what it closes against, for a grab and for a pinch [m].
constexpr double kAround = 0.05, kPinched = 0.01;
/// Part of the way to where both sides just touch the body again, by which the hand opens to let it go.
constexpr double kOpened = 0.9;
/// And at least by this, beyond a tracker's noise [m].
constexpr double kOpenedLeast = 0.006;
/// Of a grip over that of a touch: several fingers, on two sides.
constexpr double kGripStiffness = 6.0;
/// Of a grip's springs from their middle, at least and at most [m].
constexpr double kSmallest = 0.04, kLargest = 0.06;
/// Of that way, fingers that have parted by more do not carry what they held any more.
constexpr double kOpens = 0.5;
/// Bond of a hand that nothing limits [N].
constexpr double kUnlimited = 1e5;
/// Grip force over what slip needs, in people 1.2 to 2 (Johansson & Westling 1984).
constexpr double kMargin = 1.5;
/// Normals may be so far from opposite at the most, whatever the friction [rad].
constexpr double kWidest = 1.5;

bool holds(const Grip& grip, const ContactKey& key) {
  return grip.hand == key.hand && grip.body == key.body;
}

const Grip* grip_on(const std::vector<Grip>& grips, const ContactKey& key) {
  for (const Grip& grip : grips) {
    if (holds(grip, key)) return &grip;
  }
  return nullptr;
}

/// True once the hand has opened about as wide as where both its sides just touch the body.
bool has_opened(const Hand& hand, Grip& grip) {
  const double now = opening(grip, hand);
  grip.least = std::min(grip.least, now);
  return now - grip.least > std::max(kOpenedLeast, kOpened * (grip.opening - grip.least));
}

bool is_base(bool by_palm, int capsule) {
  if (by_palm) return capsule == kPalm || bone_of(capsule) == 0;
  return finger_of(capsule) == 0;
}

bool has_tip(const Hand& hand, int finger) {
  return hand.has(capsule_index(finger, 3));
}

/// The body goes with the fingers, but not with those that open: they leave it where the palm has it.
void follow(const HandTrack& track, Grip& grip) {
  grip.middle_before = grip.middle;
  const double opened = opening(grip, track.current) - grip.least;
  if (opened <= std::max(kOpenedLeast, kOpens * (grip.opening - grip.least)))
    grip.middle = middle(grip, track.current);
}

/// Contacts of one side of a grip.
struct Pads {
  Vector3 sum = Vector3::Zero();
  int count = 0;

  Vector3 middle() const { return sum / count; }
};

}  // namespace

GraspAssist::GraspAssist(const Scene& scene, const ContactFinder& finder, const Vector3& gravity,
                         const ContactConfiguration& configuration)
    : scene_(scene), finder_(finder), gravity_(gravity), configuration_(configuration) {
  closing_.reserve(kMaxHands * scene.bodies.size());
}

void GraspAssist::begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state) {
  if (!configuration_.grasp_assist) return;
  seconds_ = seconds;
  let_go(state);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active || state.hands[slot].appeared) continue;
    for (const NearBody& near : neighbours.near_hand(static_cast<int>(slot))) {
      const bool gripped = std::any_of(state.grips.begin(), state.grips.end(), [&](const Grip& grip) {
        return grip.hand == slot && grip.body == near.body;
      });
      if (!gripped && !scene_.bodies[static_cast<std::size_t>(near.body)].fixed)
        look_at(slot, near.body, state);
    }
  }
}

void GraspAssist::let_go(SimulationState& state) {
  closing_.clear();
  const auto ends = [&](Grip& grip) {
    const HandTrack& track = state.hands[grip.hand];
    grip.closes = false;
    for (int finger = 0; finger < kFingers; ++finger)
      grip.closes = grip.closes || (grip.takes_part(finger) && closes(track, grip.by_palm, finger));
    if (track.active && !track.appeared && !has_opened(track.current, grip)) {
      follow(track, grip);
      return false;
    }
    // What the fingers are still in they leave without a push.
    for (Contact& contact : state.contacts) {
      if (holds(grip, contact.key)) contact.given = std::max(contact.given, contact.depth);
    }
    return true;
  };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), ends), state.grips.end());
}

/// The opening between a finger and what it closes against shrinks, and not by the way while the hand sweeps.
bool GraspAssist::closes(const HandTrack& track, bool by_palm, int finger) const {
  const Hand &from = track.previous, &to = track.current;
  const Vector3 tip = tip_of(from, finger), base = base_of(from, by_palm);
  const Vector3 tip_way = tip_of(to, finger) - tip, base_way = base_of(to, by_palm) - base;
  const double shrinks = (tip - base).norm() - (tip + tip_way - base - base_way).norm();
  const double most = std::max(tip_way.norm(), base_way.norm());
  return shrinks > std::max(kClosingSpeed * seconds_, kClosingPart * most);
}

/// Distance of the body from the line between a finger and what it closes against; < 0 where it lies between.
double GraspAssist::way_off(const Hand& hand, bool by_palm, int finger, int body, const Pose& pose) const {
  const Capsule way{base_of(hand, by_palm), tip_of(hand, finger), 0.0};
  double least = std::numeric_limits<double>::infinity();
  const auto shapes = static_cast<int>(scene_.bodies[static_cast<std::size_t>(body)].shapes.size());
  for (int shape = 0; shape < shapes; ++shape) {
    const auto features = finder_.closest(way, body, shape, pose, kAround);
    if (features) least = std::min(least, features->distance);
  }
  return least;
}

/// What a finger does about a body that is near the line to what it closes against.
void GraspAssist::look_along(const HandTrack& track, bool by_palm, int finger, int body,
                             const BodyState& state, Look& look) const {
  const Body& of = scene_.bodies[static_cast<std::size_t>(body)];
  const double off = way_off(track.current, by_palm, finger, body, state.pose);
  if (off > kAround) return;
  const bool closing = closes(track, by_palm, finger);
  const bool slow = state.linear_momentum.norm() < kSlow * of.mass;
  if ((closing && off <= kPinched) || (off <= 0.0 && slow)) look.closing = Closing::pinch;
  if (by_palm && closing) ++look.fingers;
  if (off > 0.0) return;
  if (!look.touches) look.touches = touches(track.current, body, state.pose);
  const auto here = opposed(*look.touches, by_palm, finger, of.material.static_friction);
  std::optional<Opposed>& found = look.opposed;
  if (!here || (found && found->by_palm != by_palm)) return;
  const std::uint8_t others = found ? found->taking_part : std::uint8_t(0);
  if (!found || here->depth > found->depth) found = here;
  found->taking_part = static_cast<std::uint8_t>(others | 1 << finger);
}

void GraspAssist::look_at(std::size_t slot, int body, SimulationState& state) {
  const HandTrack& track = state.hands[slot];
  const BodyState& body_state = state.bodies[static_cast<std::size_t>(body)];
  Look look;
  for (const bool by_palm : {false, true}) {
    for (int finger = by_palm ? 0 : 1; finger < kFingers; ++finger) {
      if (has_tip(track.current, finger) && (by_palm || has_tip(track.current, 0)))
        look_along(track, by_palm, finger, body, body_state, look);
    }
  }
  if (look.opposed) {
    if (look.opposed->depth > kPulp) take(slot, body, *look.opposed, state);
  } else if (look.closing != Closing::none) {
    closing_.push_back(
        {slot, static_cast<std::size_t>(body), look.fingers >= kGrab ? Closing::grab : look.closing});
  }
}

GraspAssist::Touches GraspAssist::touches(const Hand& hand, int body, const Pose& pose) const {
  Touches result;
  const auto shapes = static_cast<int>(scene_.bodies[static_cast<std::size_t>(body)].shapes.size());
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(c)];
    Touch& touch = result[static_cast<std::size_t>(c)];
    for (int shape = 0; shape < shapes && capsule.radius > 0.0; ++shape) {
      const auto features = finder_.closest(capsule, body, shape, pose, 0.0);
      if (!features || (touch.touches && -features->distance <= touch.depth)) continue;
      touch = {true, -features->distance, capsule.radius, features->normal, features->point};
    }
  }
  return result;
}

/// Two points hold a body if the friction cones of both contain the other (Nguyen 1988): their normals are
/// then at most two friction angles from opposite. Points deep in the body tell no more than this.
std::optional<GraspAssist::Opposed> GraspAssist::opposed(const Touches& touches, bool by_palm, int finger,
                                                         double friction) const {
  double most = -std::cos(std::min(2.0 * std::atan(friction), kWidest));
  std::optional<Opposed> result;
  for (int c = 0; c < kCapsules; ++c) {
    const Touch& base = touches[static_cast<std::size_t>(c)];
    if (!base.touches || !is_base(by_palm, c)) continue;
    for (int bone = 1; bone < kBonesPerFinger; ++bone) {
      const Touch& other = touches[static_cast<std::size_t>(capsule_index(finger, bone))];
      if (!other.touches || base.normal.dot(other.normal) > most) continue;
      most = base.normal.dot(other.normal);
      const double width = (base.point - other.point).norm() + base.radius + other.radius;
      result = Opposed{std::max(base.depth, other.depth), width, base.point, other.point, by_palm, 0};
    }
  }
  return result;
}

void GraspAssist::take(std::size_t slot, int body, const Opposed& opposed, SimulationState& state) const {
  const auto b = static_cast<std::size_t>(body);
  const Hand& hand = state.hands[slot].previous;  // where it is as the frame begins
  const Pose& pose = state.bodies[b].pose;
  const Material& material = scene_.bodies[b].material;
  Grip grip;
  grip.hand = static_cast<std::uint8_t>(slot);
  grip.body = static_cast<std::uint16_t>(body);
  grip.by_palm = opposed.by_palm;
  grip.fingers = opposed.taking_part;
  grip.least = opening(grip, hand);
  grip.opening = std::max(grip.least, opposed.width);
  int fingers = 0;
  for (int finger = 0; finger < kFingers; ++finger) fingers += grip.takes_part(finger) ? 1 : 0;
  const HandStrength& strength = configuration_.hand;
  const double push = std::min(grip.by_palm ? strength.palm : strength.finger, fingers * strength.finger);
  grip.bond = std::min(2.0 * material.static_friction * push, kUnlimited) / kGripPoints;
  grip.stiffness = kGripStiffness * material.stiffness / kGripPoints;
  const Vector3 centre = 0.5 * (opposed.base + opposed.fingers);
  const double reach = std::clamp(0.5 * (opposed.base - opposed.fingers).norm(), kSmallest, kLargest);
  grip.middle_before = mrhi::middle(grip, hand);
  grip.middle = mrhi::middle(grip, state.hands[slot].current);
  const Pose frame = grip_frame(hand, grip.middle_before);
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 corner(i % 2 == 0 ? -1 : 1, i < 2 ? -1 : 1, i == 0 || i == 3 ? 1 : -1);
    const Vector3 point = centre + reach / std::sqrt(3.0) * corner;
    grip.in_hand[i] = frame.to_local(point);
    grip.in_body[i] = pose.to_local(point);
  }
  const auto after = [](const Grip& x, const Grip& y) {
    return x.hand < y.hand || (x.hand == y.hand && x.body < y.body);
  };
  state.grips.insert(std::upper_bound(state.grips.begin(), state.grips.end(), grip, after), grip);
}

/// A touch that begins gives way if the hand closes on the body with several fingers, or has something beyond
/// the surface that is touched: a fingertip that taps on a face has not.
bool GraspAssist::gives_way(const Contact& contact, const SimulationState& state) const {
  const auto on = std::find_if(closing_.begin(), closing_.end(), [&](const ClosingOn& x) {
    return x.hand == contact.key.hand && x.body == contact.key.body;
  });
  if (on == closing_.end()) return false;
  if (contact.normal.dot(gravity_) > kBears * gravity_.norm()) return false;
  if (on->closing == Closing::grab) return true;
  const Hand& hand = state.hands[contact.key.hand].current;
  const auto beyond = [&](const Vector3& point) { return contact.normal.dot(point - contact.point) < 0.0; };
  const int capsule = contact.key.capsule;
  const bool palm = is_base(true, capsule), thumb = finger_of(capsule) == 0;
  if (!palm && beyond(hand.palm.position)) return true;
  for (int finger = 0; finger < kFingers; ++finger) {
    const bool faces = palm || thumb || finger == 0;
    if (faces && has_tip(hand, finger) && beyond(tip_of(hand, finger))) return true;
  }
  return false;
}

/// Of the depth, a finger that closes round a body presses nothing; when it has stopped it presses from
/// there.
void GraspAssist::give_way(const SimulationState& state, Contact& contact) const {
  const bool may = contact.depth <= 0.0 || contact.given > 0.0;
  const Grip* grip = grip_on(state.grips, contact.key);
  const bool gives = grip != nullptr ? grip->fresh || (grip->closes && may)
                                     : may && !closing_.empty() && gives_way(contact, state);
  if (gives) {
    contact.given = std::max(contact.depth, kBegins);
    contact.struck = true;
  } else {
    contact.given = std::min(contact.given, std::max(contact.depth, 0.0));
  }
}

void GraspAssist::begin_step(double fraction, SimulationState& state) const {
  if (!configuration_.grasp_assist) return;
  for (Contact& contact : state.contacts) give_way(state, contact);
  for (Grip& grip : state.grips) {
    grip.fresh = false;
    const HandTrack& track = state.hands[grip.hand];
    const Pose from = grip_frame(track.previous, grip.middle_before);
    const Pose to = grip_frame(track.current, grip.middle);
    for (std::size_t i = 0; i < kGripPoints; ++i) {
      const Vector3 start = from * grip.in_hand[i], way = to * grip.in_hand[i] - start;
      grip.point[i] = start + fraction * way;
      grip.velocity[i] = seconds_ > 0.0 ? Vector3(way / seconds_) : Vector3::Zero();
    }
  }
}

/// The grip's force, and the squeeze that friction needs to bear it, as the contacts that touch would share
/// them, beside what their own springs give: the sum of all is the force on the body.
void GraspAssist::share_force(SimulationState& state) const {
  for (const Grip& grip : state.grips) {
    Pads base, fingers;
    const auto side = [&](const Contact& contact) -> Pads& {
      return is_base(grip.by_palm, contact.key.capsule) ? base : fingers;
    };
    const auto takes_part = [&grip](const Contact& contact) {
      return holds(grip, contact.key) && contact.touching();
    };
    for (const Contact& contact : state.contacts) {
      if (!takes_part(contact)) continue;
      side(contact).sum += contact.point;
      ++side(contact).count;
    }
    Vector3 squeeze = Vector3::Zero();
    if (base.count > 0 && fingers.count > 0) {
      const Vector3 across = fingers.middle() - base.middle();
      const double friction = std::max(scene_.bodies[grip.body].material.static_friction, 0.1);
      const double push = kMargin * grip.force.norm() / (2.0 * friction);
      if (across.norm() > 0.0) squeeze = push * across.normalized();
    }
    for (Contact& contact : state.contacts) {
      if (!takes_part(contact)) continue;
      const bool of_base = is_base(grip.by_palm, contact.key.capsule);
      contact.friction = grip.slips ? Friction::slipping : Friction::sticking;
      contact.force +=
          grip.force / (base.count + fingers.count) + (of_base ? 1.0 : -1.0) / side(contact).count * squeeze;
    }
  }
}

}  // namespace mrhi
