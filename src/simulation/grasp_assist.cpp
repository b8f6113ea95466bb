#include "grasp_assist.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mrhi {
namespace {

/// As deep as a pulp gives, the springs of contact hold a body [m].
constexpr double kPulp = 0.003;
/// Normals nearer to the way of gravity than this (cosine) bear the weight of a body: there nothing gives
/// way.
constexpr double kBears = 0.3;
/// A hand that is deeper in a fixture than this is shown elsewhere, and grasps nothing where it is [m].
constexpr double kBuried = 0.015;
/// A touch that gives way from its first step on [m].
constexpr double kBegins = 1e-6;
/// A finger that has stopped comes to press by this of its depth a second [m/s].
constexpr double kRecovers = 0.03;
/// A body that slips, and is off where it was taken by this, is not held by contact [m].
constexpr double kSlipped = 0.0015;
/// So many fingers that close on a body grab it.
constexpr int kGrab = 2;
/// Part of the way to where both sides just touch the body again, by which the hand opens to let it go.
constexpr double kOpened = 0.9;
/// And at least by this, beyond a tracker's noise and what fingers do as they hold [m]. A hand that has
/// opened by this and has lost the body on one side has let it go, too.
constexpr double kOpenedLeast = 0.015;
/// Of a grip over that of a touch: several fingers, on two sides.
constexpr double kGripStiffness = 5.0;
/// Of a grip's springs from their middle, at least and at most [m].
constexpr double kSmallest = 0.04, kLargest = 0.06;
/// Of that way, fingers that have parted by more do not carry what they held any more.
constexpr double kOpens = 0.5;
/// Nor do those that open faster than this: half of it would be a kick [m/s].
constexpr double kLeaves = 0.35;
/// A hand that is further from what it bears has left it, whatever its fingers do [m].
constexpr double kAway = 0.02;
/// Bond of a hand that nothing limits [N].
constexpr double kUnlimited = 1e5;
/// Grip force over what slip needs, in people 1.2 to 2 (Johansson & Westling 1984).
constexpr double kMargin = 1.5;
bool holds(const Grip& grip, const ContactKey& key) {
  return grip.hand == key.hand && grip.body == key.body;
}

const Grip* bearing_grip(const std::vector<Grip>& grips, const ContactKey& key) {
  for (const Grip& grip : grips) {
    if (grip.bears && holds(grip, key)) return &grip;
  }
  return nullptr;
}

bool slips(const std::vector<Contact>& contacts, const Grip& grip) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.friction == Friction::slipping && contact.touching() && holds(grip, contact.key);
  });
}

/// As far as the hand opens to let go: most of the way to where both sides just touch.
double way_to_let_go(const Grip& grip, double part) {
  return std::max(kOpenedLeast, part * (grip.opening - grip.least));
}

/// Fingers part too fast, or have parted too far, to carry what they held.
bool leaves(const Grip& grip, const HandTrack& track, double seconds) {
  const double now = opening(grip, track.current);
  return now - opening(grip, track.previous) > kLeaves * seconds ||
         now - grip.least > way_to_let_go(grip, kOpens);
}

/// What a hand bears goes with its fingers, but not with those that leave it: it stays where the palm has it.
void follow(const HandTrack& track, double seconds, Grip& grip) {
  grip.placed = grip.bears;
  if (!grip.bears) return;
  grip.in_palm_before = grip.in_palm;
  if (!leaves(grip, track, seconds)) grip.in_palm = moved_in_palm(grip, track.current);
}

/// What contact holds is not followed; where the hand has it is found once it slips.
void find(const HandTrack& track, Grip& grip) {
  if (grip.placed) return;
  grip.placed = true;
  grip.in_palm_before = moved_in_palm(grip, track.previous);
  grip.in_palm = moved_in_palm(grip, track.current);
}

/// What was taken before goes on from where its pads were then; pads that are new to it from where they are.
void keep_pads(const Grip& before, const Hand& from, Grip& grip) {
  grip.pads = before.pads;
  if (grip.fingers == before.fingers && grip.by_palm == before.by_palm) return;
  const DistalEnds here = distal_ends(from);
  const Pose in_palm = moved_in_palm(before, from);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const auto finger = static_cast<int>(i / 2);
    const bool carried = before.takes_part(finger) || (finger == 0 && !before.by_palm);
    if (!carried) grip.pads[i] = in_palm.to_local(here[i]);
  }
}

/// Contacts of one side of a grip.
struct Pads {
  Vector3 sum = Vector3::Zero();
  int count = 0;

  Vector3 middle() const { return sum / count; }
};

struct Sides {
  Pads base, fingers;

  Sides(const Grip& grip, const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) {
      if (!holds(grip, contact.key) || !contact.touching()) continue;
      Pads& side = of(grip, contact);
      side.sum += contact.point;
      ++side.count;
    }
  }
  Pads& of(const Grip& grip, const Contact& contact) {
    return is_base(grip.by_palm, contact.key.capsule) ? base : fingers;
  }
  bool both() const { return base.count > 0 && fingers.count > 0; }
};

}  // namespace

GraspAssist::GraspAssist(const Scene& scene, const ContactFinder& finder, const Vector3& gravity,
                         const ContactConfiguration& configuration)
    : scene_(scene), closing_hand_(scene, finder), gravity_(gravity), configuration_(configuration) {
  closing_.reserve(kMaxHands * scene.bodies.size());
}

void GraspAssist::begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state) {
  if (!configuration_.grasp_assist) return;
  seconds_ = seconds;
  closing_hand_.begin_frame(seconds);
  let_go(state);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active || state.hands[slot].appeared || buried(slot, state)) continue;
    for (const NearBody& near : neighbours.near_hand(static_cast<int>(slot))) {
      const auto body = static_cast<std::size_t>(near.body);
      // What is held by hands that do not close any more is known.
      const bool known = std::any_of(state.grips.begin(), state.grips.end(), [&](const Grip& grip) {
        return grip.hand == slot && grip.body == body && (grip.bears || !grip.closes);
      });
      const bool appeared = state.interactions[slot * state.bodies.size() + body].shown_in;
      if (!known && !appeared && !scene_.bodies[body].fixed) look_at(slot, near.body, state);
    }
  }
}

bool GraspAssist::buried(std::size_t slot, const SimulationState& state) const {
  return std::any_of(state.contacts.begin(), state.contacts.end(), [&](const Contact& contact) {
    return contact.key.hand == slot && contact.touching() && contact.depth > kBuried &&
           scene_.bodies[contact.key.body].fixed;
  });
}

void GraspAssist::let_go(SimulationState& state) {
  closing_.clear();
  const auto ends = [&](Grip& grip) {
    const HandTrack& track = state.hands[grip.hand];
    grip.closes = false;
    for (int finger = 0; finger < kFingers; ++finger)
      grip.closes =
          grip.closes || (grip.takes_part(finger) && closing_hand_.closes(track, grip.by_palm, finger));
    if (track.active && !track.appeared && !opens(state, grip)) {
      follow(track, seconds_, grip);
      // Between a wall and what it holds no hand would find room.
      if (grip.bears && buried(grip.hand, state))
        state.interactions[grip.hand * state.bodies.size() + grip.body].shown_in = true;
      return false;
    }
    // What the fingers are still in they leave without a push.
    for (Contact& contact : state.contacts) {
      if (grip.bears && holds(grip, contact.key)) contact.given = std::max(contact.given, contact.depth);
    }
    return true;
  };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), ends), state.grips.end());
}

bool GraspAssist::opens(const SimulationState& state, Grip& grip) const {
  const Hand& hand = state.hands[grip.hand].current;
  const Sides sides(grip, state.contacts);
  if (grip.bears && sides.base.count + sides.fingers.count == 0 &&
      !closing_hand_.is_near(hand, grip.body, state.bodies[grip.body].pose, kAway))
    return true;
  const double now = opening(grip, hand);
  grip.least = std::min(grip.least, now);
  const double opened = now - grip.least;
  if (opened > way_to_let_go(grip, kOpened)) return true;
  return opened > kOpenedLeast && !sides.both();
}

/// On what hangs on joints no touch gives way: tongs are closed by pressing either arm from one side.
void GraspAssist::look_at(std::size_t slot, int body, SimulationState& state) {
  const auto look =
      closing_hand_.look_at(state.hands[slot], body, state.bodies[static_cast<std::size_t>(body)].pose);
  if (look.opposed) {
    if (look.opposed->depth > kPulp) take(slot, body, *look.opposed, state);
  } else if (look.closing != 0 && scene_.bodies[static_cast<std::size_t>(body)].flies) {
    int fingers = 0;
    for (int finger = 1; finger < kFingers; ++finger) fingers += look.closing >> finger & 1;
    closing_.push_back({slot, static_cast<std::size_t>(body), fingers >= kGrab});
  }
}

/// What the hand has taken before and has not had to bear is taken anew, but is off by where it was then.
void GraspAssist::take(std::size_t slot, int body, const ClosingHand::Opposed& opposed,
                       SimulationState& state) const {
  const auto b = static_cast<std::size_t>(body);
  const Hand &from = state.hands[slot].previous, &to = state.hands[slot].current;
  const Pose& pose = state.bodies[b].pose;
  const Material& material = scene_.bodies[b].material;
  Grip grip;
  grip.hand = static_cast<std::uint8_t>(slot);
  grip.body = static_cast<std::uint16_t>(body);
  grip.by_palm = opposed.by_palm;
  grip.fingers = opposed.taking_part;
  grip.least = opening(grip, from);
  grip.opening = std::max(grip.least, opening(grip, to) + opposed.squeeze);
  int fingers = 0;
  for (int finger = 0; finger < kFingers; ++finger) fingers += grip.takes_part(finger) ? 1 : 0;
  const HandStrength& strength = configuration_.hand;
  const double push = std::min(grip.by_palm ? strength.palm : strength.finger, fingers * strength.finger);
  grip.point.fill(Vector3::Zero());
  grip.velocity.fill(Vector3::Zero());
  grip.bond = std::min(2.0 * material.static_friction * push, kUnlimited) / kGripPoints;
  grip.stiffness = kGripStiffness * material.stiffness / kGripPoints;
  const Vector3 centre = 0.5 * (opposed.base + opposed.fingers);
  const double reach = std::clamp(0.5 * (opposed.base - opposed.fingers).norm(), kSmallest, kLargest);
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 corner(i % 2 == 0 ? -1 : 1, i < 2 ? -1 : 1, i == 0 || i == 3 ? 1 : -1);
    const Vector3 point = centre + reach / std::sqrt(3.0) * corner;
    grip.in_hand[i] = from.palm.to_local(point);
    grip.in_body[i] = pose.to_local(point);
  }
  const auto after = [](const Grip& x, const Grip& y) {
    return x.hand < y.hand || (x.hand == y.hand && x.body < y.body);
  };
  const auto place = std::lower_bound(state.grips.begin(), state.grips.end(), grip, after);
  if (place == state.grips.end() || after(grip, *place)) {
    grip.pads = distal_ends(from);
    state.grips.insert(place, grip);
    return;
  }
  grip.least = std::min(grip.least, place->least);
  if (place->by_palm == grip.by_palm) grip.fingers |= place->fingers;
  grip.in_hand = place->in_hand, grip.in_body = place->in_body;
  keep_pads(*place, from, grip);
  *place = grip;
}

/// A touch that begins gives way if the hand closes on the body with several fingers, or has something beyond
/// the surface that is touched.
bool GraspAssist::gives_way(const Contact& contact, const SimulationState& state) const {
  const auto on = std::find_if(closing_.begin(), closing_.end(), [&](const ClosingOn& x) {
    return x.hand == contact.key.hand && x.body == contact.key.body;
  });
  if (on == closing_.end()) return false;
  if (contact.normal.dot(gravity_) > kBears * gravity_.norm()) return false;
  if (on->grabs) return true;
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

/// Of the depth, a finger that closes round a body presses nothing. When it has stopped it presses from
/// there, and by and by in full, if no grip bears the body.
void GraspAssist::give_way(const SimulationState& state, double step, Contact& contact) const {
  const bool may = contact.depth <= 0.0 || contact.given > 0.0;
  const Grip* grip = bearing_grip(state.grips, contact.key);
  const bool gives = grip != nullptr ? grip->fresh || (grip->closes && may)
                                     : may && !closing_.empty() && gives_way(contact, state);
  if (gives) {
    contact.given = std::max(contact.depth, kBegins);
    contact.struck = true;
  } else if (contact.given > 0.0) {
    const double recovered = grip == nullptr ? kRecovers * step : 0.0;
    contact.given = std::max(std::min(contact.given, contact.depth) - recovered, 0.0);
  }
}

/// Where the springs' ends on the hand are, and how fast.
void GraspAssist::place(double fraction, double until, const HandTrack& track, Grip& grip) const {
  const Pose from = track.previous.palm * grip.in_palm_before;
  const Pose to = track.current.palm * grip.in_palm;
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 start = from * grip.in_hand[i], chord = to * grip.in_hand[i] - start;
    // The point bends with the palm that carries it.
    const Vector3 arm = start - track.previous.palm.position;
    const auto bend = [&arm](const HandVelocity& of) -> Vector3 { return of.points[0] + of.turn.cross(arm); };
    const Vector3 start_bend = bend(track.path.start_bend), end_bend = bend(track.path.end_bend);
    grip.point[i] = start + PathWeights::at(fraction)(chord, start_bend, end_bend);
    grip.velocity[i] = PathWeights::between(fraction, until, seconds_)(chord, start_bend, end_bend);
  }
}

/// How far the body is off where the hand has taken it [m].
double GraspAssist::off(const SimulationState& state, const Grip& grip) const {
  const Pose& pose = state.bodies[grip.body].pose;
  double most = 0.0;
  for (std::size_t i = 0; i < kGripPoints; ++i)
    most = std::max(most, (pose * grip.in_body[i] - grip.point[i]).norm());
  return most;
}

void GraspAssist::begin_step(double fraction, double step, SimulationState& state) const {
  if (!configuration_.grasp_assist) return;
  const double until = seconds_ > 0.0 ? std::min(1.0, fraction + step / seconds_) : fraction;
  for (Grip& grip : state.grips) {
    grip.fresh = false;
    const HandTrack& track = state.hands[grip.hand];
    if (!grip.bears && (!slips(state.contacts, grip) || leaves(grip, track, seconds_))) continue;
    find(track, grip);
    place(fraction, until, track, grip);
    if (grip.bears || off(state, grip) <= kSlipped) continue;
    grip.bears = grip.fresh = true;
    for (std::size_t i = 0; i < kGripPoints; ++i)
      grip.in_body[i] = state.bodies[grip.body].pose.to_local(grip.point[i]);
  }
  for (Contact& contact : state.contacts) give_way(state, step, contact);
}

/// The grip's force, and the squeeze that friction needs to bear it, as the contacts that touch would share
/// them, beside what their own springs give: the sum of all is the force on the body.
void GraspAssist::share_force(SimulationState& state) const {
  for (const Grip& grip : state.grips) {
    if (!grip.bears) continue;
    Sides sides(grip, state.contacts);
    Vector3 squeeze = Vector3::Zero();
    if (sides.both()) {
      const Vector3 across = sides.fingers.middle() - sides.base.middle();
      const double friction = std::max(scene_.bodies[grip.body].material.static_friction, 0.1);
      const double push = kMargin * grip.force.norm() / (2.0 * friction);
      if (across.norm() > 0.0) squeeze = push * across.normalized();
    }
    for (Contact& contact : state.contacts) {
      if (!holds(grip, contact.key) || !contact.touching()) continue;
      const double sign = is_base(grip.by_palm, contact.key.capsule) ? 1.0 : -1.0;
      contact.friction = grip.slips ? Friction::slipping : Friction::sticking;
      contact.force += grip.force / (sides.base.count + sides.fingers.count) +
                       sign / sides.of(grip, contact).count * squeeze;
    }
  }
}

}  // namespace mrhi
