#include "grasp_assist.h"

#include <algorithm>
#include <cmath>

#include "../math/registration.h"

namespace mrhi {
namespace {

/// Compression of a fingertip pad up to which contact springs alone hold a body [m].
constexpr double kPadDepth = 0.003;
/// Largest depth in a fixture at which a hand grasps: a deeper hand is rendered elsewhere [m].
constexpr double kBuriedDepth = 0.015;
/// Compliance, beyond its depth, of a hand inside a body that it must not grasp: more than any finger moves
/// in a step, so that it applies no force within the step either [m].
constexpr double kNoForceCompliance = 1.0;
/// Rate at which a finger that has stopped or is opposed regains its force [m/s]. Where the last 2 mm came
/// back at once, simulated operators dropped the long cuboid three times as often.
constexpr double kRecoverySpeed = 0.03;
/// Distance of a body from its place in the hand at which the grip becomes active [m].
constexpr double kMaxOffset = 0.0015;
/// Time constant of Grip::mean_aperture [s].
constexpr double kMeanAperture = 0.05;
/// A single frame's aperture counts beyond this multiple of the tracker's noise.
constexpr double kNoiseMargin = 4.0;
/// The hand has released the body if the gaps between both sides and the body sum to this clearance [m],
constexpr double kReleaseClearance = 0.0008;
/// or to -kPadDepth, once it has opened by this fraction of the distance to touch_aperture, and by this [m].
constexpr double kReleaseFraction = 0.9, kMinRelease = 0.015;
/// Fingers that have opened by this fraction of that distance do not carry the body.
constexpr double kOpeningFraction = 0.5;
/// Once the hand has opened by this, a grip that has lost a side does not become active, and one that has
/// lost both is not [m].
constexpr double kMinOpening = 0.0015;
/// A grip waits this long for a lost hand [s]. It continues if the hand returns within this of the pose in
/// which it held the body [m], [rad].
constexpr double kMaxLoss = 1.05, kReturnDistance = 0.03, kReturnAngle = 0.5;
/// Stiffness of a grip over that of a contact: several fingers, on two sides.
constexpr double kStiffnessRatio = 5.0;
/// Distance from the springs to their centre [m].
constexpr double kSpringDistance = 0.04;
/// Time constant at which a grip's springs comply with the contacts [s].
constexpr double kComplianceTime = 0.1;
/// Bond of a hand of unlimited strength [N].
constexpr double kUnlimitedBond = 1e5;

/// Opening at which the hand releases the body: `fraction` of that at which both sides just touch it [m].
double release_opening(const Grip& grip, double fraction) {
  return std::max(kMinRelease, fraction * (grip.touch_aperture - grip.min_aperture));
}

/// Noise of a single frame's aperture [m].
double noise_margin(const HandTrack& track) {
  return kNoiseMargin * std::sqrt(track.filter.noise.variance);
}

/// Opening of the hand since its aperture was smallest, without the tracker's noise [m].
double opened_by(const HandTrack& track, double seconds, Grip& grip) {
  const double now = aperture(grip, track.current);
  const double margin = noise_margin(track);
  grip.mean_aperture += (1.0 - std::exp(-seconds / kMeanAperture)) * (now - grip.mean_aperture);
  grip.mean_aperture = std::clamp(grip.mean_aperture, now - margin, now + margin);
  grip.min_aperture = std::min(grip.min_aperture, grip.mean_aperture);
  return grip.mean_aperture - grip.min_aperture;
}

/// True if the hand, at this fraction of the frame, has opened beyond the tracker's noise: of an active grip,
/// beyond where both sides just touch the body.
bool is_open_at(double fraction, const HandTrack& track, const Grip& grip) {
  const double before = aperture(grip, track.previous);
  const double now = before + fraction * (aperture(grip, track.current) - before);
  if (now - std::min(grip.min_aperture, before) - noise_margin(track) <= kMinOpening) return false;
  return !grip.active || now > grip.touch_aperture + kReleaseClearance;
}

bool is_closing(const HandTrack& track, const Grip& grip) {
  for (int finger = 0; finger < kFingers; ++finger)
    if (grip.takes_part(finger) && ClosingHand::closes(track, grip.by_palm, finger)) return true;
  return false;
}

/// Begins the wait for a hand that was lost, or that jumped, with the body at this pose in its palm.
void lose(Nanoseconds now, const Pose& body_in_palm, Grip& grip) {
  grip.lost = now;
  grip.body_in_palm = body_in_palm;
  grip.active = false;
}

/// Pose of the body in the palm by the grip's springs, as they are without extension.
Pose grip_pose(const Grip& grip) {
  const auto fit = registered(grip.in_body.data(), grip.in_hand.data(), kGripPoints);
  if (!fit) return grip.in_palm;
  return grip.in_palm * Pose{fit->to - fit->rotation * fit->from, Quaternion(fit->rotation)};
}

}  // namespace

GraspAssist::GraspAssist(const Scene& scene, const ContactFinder& finder, const Operators& operators,
                         const Configuration& configuration)
    : scene_(scene),
      operators_(operators),
      closing_hand_(scene, finder),
      configuration_(configuration.contact),
      objects_(scene, configuration) {
  closing_.reserve(kMaxHands * scene.bodies.size());
  poses_.reserve(scene.bodies.size());
}

/// Poses of the object's bodies in the frame that the hand in `slot` moves in. Valid until the next call.
const std::vector<Pose>& GraspAssist::poses_of(std::size_t slot, std::size_t body,
                                               const SimulationState& state) const {
  poses_.clear();
  for (const int part : objects_.object_of(body))
    poses_.push_back(operators_.in_hands_frame(slot, static_cast<std::size_t>(part), state));
  return poses_;
}

/// True if a part of the object appeared inside the hand.
bool GraspAssist::is_shown_in(std::size_t slot, std::size_t body, const SimulationState& state) const {
  const Object& object = objects_.object_of(body);
  return std::any_of(object.begin(), object.end(), [&](int part) {
    return state.interactions[slot * state.bodies.size() + static_cast<std::size_t>(part)].shown_in;
  });
}

void GraspAssist::begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state) {
  seconds_ = seconds;
  closing_.clear();
  if (!objects_.any_graspable()) return state.grips.clear();
  const auto is_over = [&](Grip& grip) { return has_ended(state, grip); };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), is_over), state.grips.end());
  for (Grip& grip : state.grips)
    if (!grip.lost) follow(state, grip);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active || track.appeared || is_buried(slot, state)) continue;
    const std::vector<NearBody>& near = neighbours.near_hand(static_cast<int>(slot));
    for (auto one = near.begin(); one != near.end(); ++one) {
      const auto body = static_cast<std::size_t>(one->body);
      const bool seen = std::any_of(near.begin(), one, [&](const NearBody& before) {
        return objects_.same_object(static_cast<std::size_t>(before.body), body);
      });
      if (!seen && objects_.mode_of(body) == GraspMode::assist && scene_.bodies[body].flies &&
          !is_shown_in(slot, body, state) &&
          closing_hand_.closes_on(track, objects_.object_of(body), poses_of(slot, body, state)))
        closing_.push_back({slot, body});
    }
  }
}

bool GraspAssist::is_buried(std::size_t slot, const SimulationState& state) const {
  return std::any_of(state.contacts.begin(), state.contacts.end(), [&](const Contact& contact) {
    return contact.key.hand == slot && contact.touching() && contact.depth > kBuriedDepth &&
           scene_.bodies[contact.key.body].fixed;
  });
}

void GraspAssist::lose_hands(Nanoseconds now, SimulationState& state) {
  closing_.clear();
  take_held_objects(false, 1.0, state);
  const auto is_over = [&](Grip& grip) {
    const HandTrack& track = state.hands[grip.hand];
    if (track.active) return false;
    if (!grip.lost)
      lose(track.last_seen,
           track.current.palm.inverse() * operators_.in_hands_frame(grip.hand, grip.body, state), grip);
    return grip.released || to_seconds(now - *grip.lost) > kMaxLoss;
  };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), is_over), state.grips.end());
}

/// True if a lost hand has returned near the pose in which it held the body: the grip continues from where
/// the body is in the hand now.
bool GraspAssist::resumes(const SimulationState& state, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  const Pose pose = operators_.in_hands_frame(grip.hand, grip.body, state);
  const Pose in_palm = track.current.palm.inverse() * pose;
  if ((in_palm.position - grip.body_in_palm.position).norm() > kReturnDistance ||
      in_palm.orientation.angularDistance(grip.body_in_palm.orientation) > kReturnAngle)
    return false;
  grip.lost.reset();
  grip.mean_aperture = aperture(grip, track.current);
  grip.pads = distal_ends(track.current);
  grip.in_palm = Pose();
  for (std::size_t i = 0; i < kGripPoints; ++i)
    grip.in_hand[i] = track.current.palm.to_local(pose * grip.in_body[i]);
  grip.active = true;
  return true;
}

/// True if the grip is over. A hand that releases a body that it supported is still inside it: it touches it
/// lightly until it has left the body, or closes on it again.
bool GraspAssist::has_ended(const SimulationState& state, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  if (grip.lost)  // a hand that is seen again elsewhere may yet return to the body
    return track.active && !resumes(state, grip) && to_seconds(track.last_seen - *grip.lost) > kMaxLoss;
  const GraspMode mode = objects_.mode_of(grip.body);
  if (!track.active || mode == GraspMode::free) return true;
  if (track.appeared) {  // it jumped away, which is as good as a loss
    lose(track.last_seen, grip_pose(grip), grip);
    return grip.released;
  }
  const TouchingGroups touching = objects_.touching_groups(grip, state.contacts);
  if (mode == GraspMode::never) {
    grip.released = true;
    grip.active = false;
    return touching.none();
  }
  if (grip.released) return touching.none() || is_closing(track, grip);
  if (seconds_ <= 0.0 || !has_opened(state, touching, grip)) return false;
  // The links of a linkage follow the fingers as they open, like tongs: their contacts keep their force.
  grip.released = grip.active && objects_.object_of(grip.body).size() == 1;
  grip.active = false;
  return !grip.released;
}

/// True if the hand has opened enough to release the body, or has left it.
bool GraspAssist::has_opened(const SimulationState& state, const TouchingGroups& touching, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  grip.opened = opened_by(track, seconds_, grip);
  const bool is_wide = grip.opened > release_opening(grip, kReleaseFraction);
  if (touching.both() && !is_wide) return false;
  const auto gap = [&](bool of_base) {
    return closing_hand_.gap(track.current, grip.by_palm, of_base, objects_.object_of(grip.body),
                             poses_of(grip.hand, grip.body, state));
  };
  return gap(true) + gap(false) > (is_wide ? -kPadDepth : kReleaseClearance);
}

/// Moves the grip with its fingers, unless they open.
void GraspAssist::follow(SimulationState& state, Grip& grip) {
  const HandTrack& track = state.hands[grip.hand];
  grip.closes = is_closing(track, grip);
  grip.in_palm_before = grip.in_palm;
  if (grip.opened <= release_opening(grip, kOpeningFraction))
    grip.in_palm = moved_in_palm(grip, track.current);
  if (!grip.active) return;
  if (grip.closes && scene_.bodies[grip.body].flies) closing_.push_back({grip.hand, grip.body});
  // A hand that is rendered before a fixture does not collide with what it holds there.
  if (!is_buried(grip.hand, state)) return;
  for (const int part : objects_.object_of(grip.body))
    state.interactions[grip.hand * state.bodies.size() + static_cast<std::size_t>(part)].shown_in = true;
}

/// Begins a grip on each object that a hand has between opposing contacts, or adds fingers to it. A `seen`
/// hand takes beyond kPadDepth; a lost one all that it held, as its springs are gone. Does not change a grip
/// that is active, released or lost. The grip of an object that must not be grasped is released from the
/// start, and begins at the first opposing contacts, be they another hand's.
void GraspAssist::take_held_objects(bool seen, double fraction, SimulationState& state) const {
  const std::vector<Contact>& contacts = state.contacts;
  for (auto one = contacts.begin(); one != contacts.end(); ++one) {
    const std::size_t slot = one->key.hand, body = one->key.body;
    const GraspMode mode = objects_.mode_of(body);
    if (one->depth <= 0.0 || mode == GraspMode::free || state.hands[slot].active != seen) continue;
    if (mode == GraspMode::never) {
      if (find_grip(slot, body, state) != state.grips.end() || !objects_.is_opposed(*one, contacts, true))
        continue;
      OpposingContacts one_of_them;
      one_of_them.body = body, one_of_them.fingers_mask = 1 << 1;
      one_of_them.base = one_of_them.fingers = one->point;
      take(slot, one_of_them, fraction, state);
      continue;
    }
    const bool visited = std::any_of(contacts.begin(), one, [&](const Contact& before) {
      return before.depth > 0.0 && before.key.hand == slot && objects_.same_object(before.key.body, body);
    });
    if (visited) continue;
    const auto known = find_grip(slot, body, state);
    const bool is_new = known == state.grips.end();
    if (!is_new && (known->active || known->released || known->lost)) continue;
    // In most steps the same fingers touch it as before.
    if (!is_new && !known->by_palm && objects_.only_fingers_of(*known, contacts) &&
        objects_.is_opposed(slot, body, false, contacts))
      continue;
    if (is_buried(slot, state) || is_shown_in(slot, body, state)) continue;
    auto found = objects_.opposing_contacts(slot, body, false, contacts);
    if (!found) found = objects_.opposing_contacts(slot, body, true, contacts);
    if (!found || (seen && found->depth <= kPadDepth)) continue;
    if (is_new || known->by_palm != found->by_palm || (found->fingers_mask & ~known->fingers) != 0)
      take(slot, *found, fraction, state);
  }
}

std::vector<Grip>::iterator GraspAssist::find_grip(std::size_t slot, std::size_t body,
                                                   SimulationState& state) const {
  return std::find_if(state.grips.begin(), state.grips.end(),
                      [&](const Grip& grip) { return objects_.is_in(grip, slot, body); });
}

/// Begins a grip, in place of one that has fewer fingers. The springs of a grip on a linkage act on the link
/// that the thumb or the palm touches.
void GraspAssist::take(std::size_t slot, const OpposingContacts& opposing, double fraction,
                       SimulationState& state) const {
  const std::size_t b = opposing.body;
  const Hand &from = state.hands[slot].previous, &to = state.hands[slot].current;
  const Material& material = scene_.bodies[b].material;
  Grip grip;
  grip.hand = static_cast<std::uint8_t>(slot);
  grip.body = static_cast<std::uint16_t>(b);
  grip.released = objects_.mode_of(b) == GraspMode::never;
  grip.by_palm = opposing.by_palm;
  grip.fingers = opposing.fingers_mask;
  const auto known = find_grip(slot, b, state);
  if (known != state.grips.end()) {
    if (known->by_palm == grip.by_palm) grip.fingers |= known->fingers;
    state.grips.erase(known);
  }
  grip.min_aperture = grip.mean_aperture = aperture(grip, from);
  const double now = grip.min_aperture + fraction * (aperture(grip, to) - grip.min_aperture);
  grip.touch_aperture = std::max(grip.min_aperture, now + opposing.squeeze);
  int fingers = 0;
  for (int finger = 0; finger < kFingers; ++finger) fingers += grip.takes_part(finger) ? 1 : 0;
  const HandStrength& strength = configuration_.hand;
  const double force = std::min(grip.by_palm ? strength.palm : strength.finger, fingers * strength.finger);
  grip.point.fill(Vector3::Zero());
  grip.velocity.fill(Vector3::Zero());
  grip.bond = std::min(2.0 * material.static_friction * force, kUnlimitedBond) / kGripPoints;
  grip.stiffness = kStiffnessRatio * material.stiffness / kGripPoints;
  const Vector3 centre = 0.5 * (opposing.base + opposing.fingers);
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 corner(i % 2 == 0 ? -1 : 1, i < 2 ? -1 : 1, i == 0 || i == 3 ? 1 : -1);
    grip.in_hand[i] = from.palm.to_local(centre + kSpringDistance / std::sqrt(3.0) * corner);
  }
  grip.pads = distal_ends(from);
  grip.in_palm_before = moved_in_palm(grip, from);
  grip.in_palm = moved_in_palm(grip, to);
  place_springs(fraction, fraction, state.hands[slot], grip);
  for (std::size_t i = 0; i < kGripPoints; ++i)
    grip.in_body[i] = state.bodies[b].pose.to_local(grip.point[i]);
  const auto after = [](const Grip& x, const Grip& y) {
    return x.hand < y.hand || (x.hand == y.hand && x.body < y.body);
  };
  state.grips.insert(std::lower_bound(state.grips.begin(), state.grips.end(), grip, after), grip);
}

/// Sets the contact's compliance. A finger that closes on a body touches it lightly until another part of the
/// hand opposes it, and so does a hand that has released it: the finger's own motion adds no force. It
/// resists the body's motion, so it still carries what it carried, and what falls onto it. A finger that has
/// stopped, or is opposed, regains its force slowly.
void GraspAssist::set_compliance(const SimulationState& state, double step, Contact& contact) const {
  const bool released = std::any_of(state.grips.begin(), state.grips.end(), [&](const Grip& grip) {
    return grip.released && objects_.is_in(grip, contact.key.hand, contact.key.body);
  });
  if (!released && contact.compliance <= 0.0 && closing_.empty()) return;
  const bool closes = std::any_of(closing_.begin(), closing_.end(), [&](const ClosingPair& pair) {
    return pair.hand == contact.key.hand && objects_.same_object(pair.body, contact.key.body);
  });
  const double kept = std::min(contact.compliance, std::max(contact.depth, 0.0));
  if (!released && (!closes || objects_.is_opposed(contact, state.contacts))) {
    contact.compliance = std::max(kept - kRecoverySpeed * step, 0.0);
    return;
  }
  contact.struck = true;
  if (objects_.mode_of(contact.key.body) == GraspMode::never) {
    contact.compliance = std::max(contact.depth, 0.0) + kNoForceCompliance;
    return;
  }
  Vector3 velocity = contact.hand_velocity;
  if (const CarrierMotion* carrier = operators_.carrier(contact.key.hand))
    velocity -= carrier->velocity(contact.hand_point);
  contact.compliance = kept + step * std::max(0.0, -contact.normal.dot(velocity));
}

void GraspAssist::place_springs(double fraction, double until, const HandTrack& track, Grip& grip) const {
  const Pose from = track.previous.palm * grip.in_palm_before;
  const Pose to = track.current.palm * grip.in_palm;
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 start = from * grip.in_hand[i], chord = to * grip.in_hand[i] - start;
    // The point's path is curved like the palm's.
    const Vector3 arm = start - track.previous.palm.position;
    const auto bend = [&arm](const HandVelocity& of) -> Vector3 { return of.points[0] + of.turn.cross(arm); };
    const Vector3 start_bend = bend(track.path.start_bend), end_bend = bend(track.path.end_bend);
    grip.point[i] = start + PathWeights::at(fraction)(chord, start_bend, end_bend);
    grip.velocity[i] = PathWeights::between(fraction, until, seconds_)(chord, start_bend, end_bend);
    if (const CarrierMotion* carrier = operators_.carrier(grip.hand)) {
      grip.point[i] = carrier->to_world(grip.point[i]);
      grip.velocity[i] = carrier->rotation * grip.velocity[i] + carrier->velocity(grip.point[i]);
    }
  }
}

/// Leaves to the contacts what they do alone: the springs' mean extension fades in the direction in which
/// base and fingers load the body, and where it opposes their friction.
void GraspAssist::comply_with_contacts(double step, const SimulationState& state, Grip& grip) const {
  Vector3 line = Vector3::Zero(), friction = Vector3::Zero();
  for (const Contact& contact : state.contacts) {
    if (!contact.touching() || !objects_.is_in(grip, contact.key.hand, contact.key.body)) continue;
    line += is_base(grip.by_palm, contact.key.capsule) ? contact.normal : -contact.normal;
    friction += contact.force - contact.normal.dot(contact.force) * contact.normal;
  }
  line.normalize(), friction.normalize();
  const Pose& pose = state.bodies[grip.body].pose;
  Vector3 extension = Vector3::Zero();
  for (std::size_t i = 0; i < kGripPoints; ++i)
    extension += (grip.point[i] - pose * grip.in_body[i]) / kGripPoints;
  Vector3 needless = extension.dot(line) * line;
  needless += std::min((extension - needless).dot(friction), 0.0) * friction;
  const Vector3 compliance =
      pose.orientation.conjugate() * (std::min(step / kComplianceTime, 1.0) * needless);
  for (Vector3& end : grip.in_body) end += compliance;
}

/// Leaves the joints of a linkage to the fingers: the springs resist only the mean motion of the links that
/// both sides touch. Their ends on the base's link move back by this link's motion relative to that mean, and
/// their damping omits it.
void GraspAssist::leave_joints_free(double step, SimulationState& state, Grip& grip) const {
  if (objects_.object_of(grip.body).size() == 1) return;
  const auto velocity = [&](std::size_t body, const Vector3& point) -> Vector3 {
    const Twist twist = twist_of(scene_.bodies[body], state.bodies[body]);
    return twist.linear + twist.angular.cross(point - state.bodies[body].pose.position);
  };
  const Pose& pose = state.bodies[grip.body].pose;
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 end = pose * grip.in_body[i], of_base = velocity(grip.body, end);
    Vector3 relative = Vector3::Zero();  // velocity of the base's link relative to the fingers' links, summed
    int count = 0;
    for (const Contact& contact : state.contacts) {
      if (!contact.touching() || !objects_.is_in(grip, contact.key.hand, contact.key.body) ||
          is_base(grip.by_palm, contact.key.capsule))
        continue;
      relative += of_base - velocity(contact.key.body, end);
      ++count;
    }
    if (count == 0) return;
    const Vector3 by_joints = 0.5 / count * relative;
    grip.in_body[i] = pose.to_local(end - step * by_joints);
    grip.velocity[i] += by_joints;
  }
}

/// Largest distance of a spring's end on the body from its end on the hand [m].
double GraspAssist::offset(const SimulationState& state, const Grip& grip) const {
  const Pose& pose = state.bodies[grip.body].pose;
  double largest = 0.0;
  for (std::size_t i = 0; i < kGripPoints; ++i)
    largest = std::max(largest, (pose * grip.in_body[i] - grip.point[i]).norm());
  return largest;
}

bool GraspAssist::is_held_elsewhere(const SimulationState& state, const Grip& grip) const {
  return std::any_of(state.grips.begin(), state.grips.end(), [&](const Grip& other) {
    return other.hand != grip.hand && !other.released && !other.lost &&
           objects_.same_object(other.body, grip.body) &&
           objects_.touching_groups(other, state.contacts).both();
  });
}

/// True if the hand has opened and nothing of it is at the object. A hand that returned into it is.
bool GraspAssist::has_left(const SimulationState& state, const Grip& grip) const {
  return grip.opened > kMinOpening && !state.hands[grip.hand].appeared &&
         std::none_of(state.contacts.begin(), state.contacts.end(), [&](const Contact& contact) {
           return (contact.touching() || contact.ignored) &&
                  objects_.is_in(grip, contact.key.hand, contact.key.body);
         });
}

void GraspAssist::begin_step(double fraction, double step, SimulationState& state) const {
  if (!objects_.any_graspable()) return;
  take_held_objects(true, fraction, state);
  const double until = seconds_ > 0.0 ? std::min(1.0, fraction + step / seconds_) : fraction;
  for (Grip& grip : state.grips) {
    const bool touching = objects_.touching_groups(grip, state.contacts).both();
    const HandTrack& track = state.hands[grip.hand];
    const bool present = !grip.lost && !track.appeared;
    if (!touching && (has_left(state, grip) || is_held_elsewhere(state, grip) ||
                      (present && is_open_at(fraction, track, grip)))) {
      grip.active = false;
      continue;
    }
    const bool lost = touching ? objects_.slips(grip, state.contacts) ||
                                     !objects_.is_opposed(grip.hand, grip.body, grip.by_palm, state.contacts)
                               : grip.opened <= kMinOpening;
    if (!grip.active && (!lost || grip.released || grip.lost)) continue;
    place_springs(fraction, until, track, grip);
    leave_joints_free(step, state, grip);
    if (grip.active) comply_with_contacts(step, state, grip);
    if (grip.active || offset(state, grip) <= kMaxOffset) continue;
    grip.active = true;
    for (std::size_t i = 0; i < kGripPoints; ++i)
      grip.in_body[i] = state.bodies[grip.body].pose.to_local(grip.point[i]);
  }
  for (Contact& contact : state.contacts) set_compliance(state, step, contact);
}

}  // namespace mrhi
