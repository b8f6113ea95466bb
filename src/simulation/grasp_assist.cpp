#include "grasp_assist.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Depth that a fingertip pad complies by: up to there, the springs of contact hold a body [m].
constexpr double kPadDepth = 0.003;
/// A hand that is deeper in a fixture is rendered elsewhere, and grasps nothing where it is tracked [m].
constexpr double kBuriedDepth = 0.015;
/// Compliance of a light touch beyond its depth: more than any finger moves in a step, so that it applies no
/// force within the step either [m].
constexpr double kLight = 1.0;
/// Rate at which a finger that has stopped without an opposite touch regains its force [m/s].
constexpr double kRecoverySpeed = 0.03;
/// Cosine between the normals of touches on opposite faces, at most.
constexpr double kOpposite = -0.3;
/// Distance of a body from its place in the hand at which the grip becomes active [m].
constexpr double kMaxOffset = 0.0015;
/// Time constant of Grip::mean_aperture [s].
constexpr double kMeanAperture = 0.05;
/// A single frame's aperture counts beyond this multiple of the tracker's noise.
constexpr double kNoiseMargin = 4.0;
/// The hand has let go once it has opened by this fraction of the way to touch_aperture, and by this [m], and
/// both sides together are within kPadDepth of clearance.
constexpr double kReleaseFraction = 0.9, kMinRelease = 0.015;
/// Or by this, if the gaps between both sides and the body come to the clearance: there is room for it [m].
constexpr double kMinOpening = 0.0015, kReleaseClearance = 0.001;
/// Fingers that have opened by this fraction of that way, or open faster, do not carry the body [m/s].
constexpr double kOpensFraction = 0.5, kOpensSpeed = 1.0;
/// A hand that is farther from a body than this has left it, whatever its fingers do [m].
constexpr double kMaxDistance = 0.02;
/// A grip waits for a lost hand so long [s], and goes on if the hand returns within this of the pose in which
/// it held the body [m], [rad].
constexpr double kMaxLoss = 1.05, kReturnDistance = 0.03, kReturnAngle = 0.5;
/// Stiffness of a grip over that of a touch: several fingers, on two sides.
constexpr double kStiffnessRatio = 5.0;
/// Limits of the distance from the springs to their middle [m].
constexpr double kMinReach = 0.04, kMaxReach = 0.06;
/// Bond of a hand of unlimited strength [N].
constexpr double kUnlimitedBond = 1e5;
/// Normals may be so far from opposite at the most, whatever the friction [rad].
constexpr double kWidest = 1.5;

/// Opening by which the hand releases the body: `fraction` of the way to where both sides just touch it [m].
double release_opening(const Grip& grip, double fraction) {
  return std::max(kMinRelease, fraction * (grip.touch_aperture - grip.min_aperture));
}

/// Of a single frame's aperture [m].
double noise_margin(const HandTrack& track) {
  return kNoiseMargin * std::sqrt(track.filter.noise.variance);
}

/// By how much the hand has opened since it was most closed, without the tracker's noise [m].
double opened_by(const HandTrack& track, double seconds, Grip& grip) {
  const double now = aperture(grip, track.current);
  const double margin = noise_margin(track);
  grip.mean_aperture += (1.0 - std::exp(-seconds / kMeanAperture)) * (now - grip.mean_aperture);
  grip.mean_aperture = std::clamp(grip.mean_aperture, now - margin, now + margin);
  grip.min_aperture = std::min(grip.min_aperture, grip.mean_aperture);
  return grip.mean_aperture - grip.min_aperture;
}

/// Mean speed at which the grip's fingers open [m/s].
double opening_speed(const HandTrack& track, const Grip& grip) {
  double sum = 0.0;
  int count = 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    if (!grip.takes_part(finger)) continue;
    sum -= ClosingHand::closing_speed(track, grip.by_palm, finger);
    ++count;
  }
  return sum / count;
}

/// True if the fingers opened fast in the last frame, beyond the tracker's noise.
bool opens_now(const HandTrack& track, double seconds, const Grip& grip) {
  const double change = aperture(grip, track.current) - aperture(grip, track.previous);
  return change - noise_margin(track) > kOpensSpeed * seconds;
}

bool still_closes(const HandTrack& track, const Grip& grip) {
  for (int finger = 0; finger < kFingers; ++finger)
    if (grip.takes_part(finger) && ClosingHand::closes(track, grip.by_palm, finger)) return true;
  return false;
}

/// A grip that is taken anew keeps the pads of its former fingers; those of new fingers start where they are.
void keep_pads(const Grip& before, const Hand& from, Grip& grip) {
  grip.pads = before.pads;
  if (grip.fingers == before.fingers && grip.by_palm == before.by_palm) return;
  const DistalEnds here = distal_ends(from);
  const Pose in_palm = moved_in_palm(before, from);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const auto finger = static_cast<int>(i / 2);
    const bool took_part = before.takes_part(finger) || (finger == 0 && !before.by_palm);
    if (!took_part) grip.pads[i] = in_palm.to_local(here[i]);
  }
}

}  // namespace

/// Contact models other than `implicit` know neither grips nor compliance.
GraspAssist::GraspAssist(const Scene& scene, const ContactFinder& finder, const Operators& operators,
                         const Configuration& configuration)
    : scene_(scene),
      operators_(operators),
      closing_hand_(scene, finder),
      configuration_(configuration.contact) {
  closing_.reserve(kMaxHands * scene.bodies.size());
  poses_.reserve(scene.bodies.size());
  const bool implicit = configuration.contact_model == ContactModelKind::implicit;
  std::vector<std::size_t> by_root(scene.bodies.size(), scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto body = static_cast<int>(b);
    std::size_t& index = by_root[static_cast<std::size_t>(floating_root(scene, body).value_or(body))];
    if (index == scene.bodies.size()) {
      GraspMode mode = grasp_of(scene, body);
      if (mode == GraspMode::parameter)
        mode = configuration_.grasp_assist ? GraspMode::assist : GraspMode::free;
      if (!implicit || scene.bodies[b].fixed) mode = GraspMode::free;
      acts_ = acts_ || mode != GraspMode::free;
      index = objects_.size();
      objects_.emplace_back();
      modes_.push_back(mode);
    }
    objects_[index].push_back(body);
    object_index_.push_back(index);
    friction_angle_.push_back(std::atan(scene.bodies[b].material.static_friction));
  }
}

bool GraspAssist::only_fingers_of(const Grip& grip, const std::vector<Contact>& contacts) const {
  return std::none_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.depth > 0.0 && is_in(grip, contact.key.hand, contact.key.body) &&
           !is_base(grip.by_palm, contact.key.capsule) && !is_base(true, contact.key.capsule) &&
           !grip.takes_part(finger_of(contact.key.capsule));
  });
}

GraspAssist::TouchingSides GraspAssist::touching_sides(const Grip& grip,
                                                       const std::vector<Contact>& contacts) const {
  TouchingSides sides;
  for (const Contact& contact : contacts) {
    if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body)) continue;
    (is_base(grip.by_palm, contact.key.capsule) ? sides.base : sides.fingers) = true;
  }
  return sides;
}

/// True if the hand touches the same object on a face opposite to this contact's, or is about to (contacts
/// begin 1 mm before the surface).
bool GraspAssist::is_opposed(const Contact& contact, const std::vector<Contact>& contacts) const {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& other) {
    return other.key.hand == contact.key.hand && !other.ignored &&
           object_index_[other.key.body] == object_index_[contact.key.body] &&
           other.normal.dot(contact.normal) < kOpposite;
  });
}

bool GraspAssist::slips(const std::vector<Contact>& contacts, const Grip& grip) const {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.friction == Friction::slipping && contact.touching() &&
           is_in(grip, contact.key.hand, contact.key.body);
  });
}

/// Poses of the object's bodies in the frame that the hand in `slot` moves in. Until the next call.
const std::vector<Pose>& GraspAssist::poses_of(std::size_t slot, std::size_t body,
                                               const SimulationState& state) const {
  poses_.clear();
  for (const int part : object_of(body))
    poses_.push_back(operators_.in_hands_frame(slot, static_cast<std::size_t>(part), state));
  return poses_;
}

/// True if a part of the object appeared where the hand is.
bool GraspAssist::is_shown_in(std::size_t slot, std::size_t body, const SimulationState& state) const {
  const Object& object = object_of(body);
  return std::any_of(object.begin(), object.end(), [&](int part) {
    return state.interactions[slot * state.bodies.size() + static_cast<std::size_t>(part)].shown_in;
  });
}

void GraspAssist::begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state) {
  seconds_ = seconds;
  closing_.clear();
  if (!acts_) state.grips.clear();
  if (!acts_) return;
  const auto over = [&](Grip& grip) { return ends(state, grip); };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), over), state.grips.end());
  for (Grip& grip : state.grips)
    if (!grip.lost) follow(state, grip);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active || track.appeared || is_buried(slot, state)) continue;
    const std::vector<NearBody>& near = neighbours.near_hand(static_cast<int>(slot));
    for (auto one = near.begin(); one != near.end(); ++one) {
      const auto body = static_cast<std::size_t>(one->body);
      const bool looked_at = std::any_of(near.begin(), one, [&](const NearBody& before) {
        return object_index_[static_cast<std::size_t>(before.body)] == object_index_[body];
      });
      if (mode_of(body) == GraspMode::assist && scene_.bodies[body].flies && !looked_at &&
          !is_shown_in(slot, body, state) &&
          closing_hand_.closes_on(track, object_of(body), poses_of(slot, body, state)))
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
  const auto is_over = [&](Grip& grip) {
    const HandTrack& track = state.hands[grip.hand];
    if (track.active) return false;
    if (!grip.lost) {
      grip.lost = track.last_seen;
      grip.body_in_palm =
          track.current.palm.inverse() * operators_.in_hands_frame(grip.hand, grip.body, state);
      grip.active = false;
    }
    return grip.released || to_seconds(now - *grip.lost) > kMaxLoss;
  };
  state.grips.erase(std::remove_if(state.grips.begin(), state.grips.end(), is_over), state.grips.end());
}

/// True if a hand that was lost has returned about as it held the body: the grip goes on, from where the body
/// is in the hand now.
bool GraspAssist::holds_again(const SimulationState& state, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  const Pose pose = operators_.in_hands_frame(grip.hand, grip.body, state);
  const Pose in_palm = track.current.palm.inverse() * pose;
  const double now = aperture(grip, track.current);
  if ((in_palm.position - grip.body_in_palm.position).norm() > kReturnDistance ||
      in_palm.orientation.angularDistance(grip.body_in_palm.orientation) > kReturnAngle ||
      now - grip.min_aperture > kMinRelease)
    return false;
  grip.lost.reset();
  grip.mean_aperture = now;
  grip.pads = distal_ends(track.current);
  grip.in_palm = Pose();
  for (std::size_t i = 0; i < kGripPoints; ++i)
    grip.in_hand[i] = track.current.palm.to_local(pose * grip.in_body[i]);
  grip.active = true;
  return true;
}

/// True if the grip is over. A hand that lets go of a body that it supported is still in it: it exerts no
/// force until it has left the body, or closes on it again.
bool GraspAssist::ends(const SimulationState& state, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  if (grip.lost) return track.active && !holds_again(state, grip);
  const GraspMode mode = mode_of(grip.body);
  if (!track.active || track.appeared || mode == GraspMode::free) return true;
  const TouchingSides touching = touching_sides(grip, state.contacts);
  if (mode == GraspMode::never) {
    grip.released = true;
    grip.active = false;
    return touching.none();
  }
  if (grip.released) return touching.none() || still_closes(track, grip);
  if (seconds_ <= 0.0 || !opens(state, touching, grip)) return false;
  // Parts of a linkage follow the fingers as they open, as tongs do: their contacts keep their force.
  grip.released = grip.active && object_of(grip.body).size() == 1;
  grip.active = false;
  return !grip.released;
}

/// True if the hand has opened enough to release the body, or has left it.
bool GraspAssist::opens(const SimulationState& state, const TouchingSides& touching, Grip& grip) const {
  const HandTrack& track = state.hands[grip.hand];
  grip.opened = opened_by(track, seconds_, grip);
  grip.opens =
      opening_speed(track, grip) > kOpensSpeed || grip.opened > release_opening(grip, kOpensFraction);
  const bool is_wide = grip.opened > release_opening(grip, kReleaseFraction);
  if (touching.both() && !is_wide) return false;
  const auto gap = [&](bool of_base) {
    return closing_hand_.gap(track.current, grip.by_palm, of_base, object_of(grip.body),
                             poses_of(grip.hand, grip.body, state), kMaxDistance);
  };
  const double base = gap(true), fingers = gap(false);
  const double room = base + fingers - 0.5 * noise_margin(track);
  return (grip.opened > kMinOpening && room > kReleaseClearance) || (is_wide && room > -kPadDepth) ||
         std::min(base, fingers) >= kMaxDistance;
}

/// A supported body follows the fingers, but not fingers that open.
void GraspAssist::follow(SimulationState& state, Grip& grip) {
  const HandTrack& track = state.hands[grip.hand];
  grip.closes = still_closes(track, grip);
  grip.in_palm_before = grip.in_palm;
  if (!grip.opens) grip.in_palm = moved_in_palm(grip, track.current);
  if (!grip.active) return;
  if (grip.closes && scene_.bodies[grip.body].flies) closing_.push_back({grip.hand, grip.body});
  // A hand that is rendered before a fixture does not collide with what it holds there.
  if (!is_buried(grip.hand, state)) return;
  for (const int part : object_of(grip.body))
    state.interactions[grip.hand * state.bodies.size() + static_cast<std::size_t>(part)].shown_in = true;
}

/// Two contacts hold a body if the friction cones of both contain the other (Nguyen 1988): their normals are
/// then at most two friction angles from opposite. see(base, other, n.n'), until it returns false.
template <typename See>
void GraspAssist::each_opposed(std::size_t slot, std::size_t body, bool by_palm,
                               const std::vector<Contact>& contacts, const See& see) const {
  const auto touches = [&](const Contact& contact) {
    return contact.depth > 0.0 && contact.key.hand == slot &&
           object_index_[contact.key.body] == object_index_[body];
  };
  for (const Contact& base : contacts) {
    if (!touches(base) || !is_base(by_palm, base.key.capsule)) continue;
    const double angle = friction_angle_[base.key.body];
    for (const Contact& other : contacts) {
      if (!touches(other) || (base.ignored && other.ignored) || is_base(true, other.key.capsule) ||
          is_base(by_palm, other.key.capsule))
        continue;
      const double across = base.normal.dot(other.normal);
      if (across >= 0.0) continue;  // before the cosine, which is dear
      if (across > -std::cos(std::min(angle + friction_angle_[other.key.body], kWidest))) continue;
      if (!see(base, other, across)) return;
    }
  }
}

bool GraspAssist::is_opposed(std::size_t slot, std::size_t body, bool by_palm,
                             const std::vector<Contact>& contacts) const {
  bool found = false;
  each_opposed(slot, body, by_palm, contacts,
               [&](const Contact&, const Contact&, double) { return !(found = true); });
  return found;
}

std::optional<GraspAssist::Opposed> GraspAssist::opposed(std::size_t slot, std::size_t body, bool by_palm,
                                                         const std::vector<Contact>& contacts) const {
  Opposed result;
  double most = 1.0;
  each_opposed(slot, body, by_palm, contacts, [&](const Contact& base, const Contact& other, double across) {
    const int bit = 1 << finger_of(other.key.capsule);
    result.taking_part = static_cast<std::uint8_t>(result.taking_part | bit);
    result.depth = std::max({result.depth, base.depth, other.depth});
    if (across >= most) return true;
    most = across;
    result.squeeze = base.depth + other.depth;
    result.base = base.point, result.fingers = other.point;
    result.body = base.key.body;
    return true;
  });
  result.by_palm = by_palm;
  return result.taking_part != 0 ? std::optional<Opposed>(result) : std::nullopt;
}

/// Takes each object that a hand has between opposing contacts. A grip that is active, released or lost stays
/// as it is; any other goes on with the fingers that have come to it.
void GraspAssist::take_what_is_held(double fraction, SimulationState& state) const {
  const std::vector<Contact>& contacts = state.contacts;
  for (auto one = contacts.begin(); one != contacts.end(); ++one) {
    const std::size_t slot = one->key.hand, body = one->key.body;
    if (one->depth <= 0.0 || mode_of(body) == GraspMode::free) continue;
    if (one != contacts.begin() && (one - 1)->depth > 0.0 && (one - 1)->key.hand == slot &&
        (one - 1)->key.body == body)
      continue;  // the same body: looked at
    const bool looked_at = std::any_of(contacts.begin(), one, [&](const Contact& before) {
      return before.depth > 0.0 && before.key.hand == slot &&
             object_index_[before.key.body] == object_index_[body];
    });
    if (looked_at) continue;
    const auto known = std::find_if(state.grips.begin(), state.grips.end(),
                                    [&](const Grip& grip) { return is_in(grip, slot, body); });
    const bool is_new = known == state.grips.end();
    if (!is_new && (known->active || known->released || known->lost)) continue;
    // In most steps no finger has come to it.
    if (!is_new && !known->by_palm && only_fingers_of(*known, contacts) &&
        is_opposed(slot, body, false, contacts))
      continue;
    if (is_buried(slot, state) || is_shown_in(slot, body, state)) continue;
    auto found = opposed(slot, body, false, contacts);
    if (!found) found = opposed(slot, body, true, contacts);
    if (!found || (mode_of(body) != GraspMode::never && found->depth <= kPadDepth)) continue;
    if (is_new || known->by_palm != found->by_palm || (found->taking_part & ~known->fingers) != 0)
      take(slot, *found, fraction, state);
  }
}

/// A body that was taken before and needed no support is taken anew, but keeps its place in the hand.
/// The springs of a grip on a linkage act on the part that the thumb or the palm touches.
void GraspAssist::take(std::size_t slot, const Opposed& opposed, double fraction,
                       SimulationState& state) const {
  const auto known = std::find_if(state.grips.begin(), state.grips.end(),
                                  [&](const Grip& grip) { return is_in(grip, slot, opposed.body); });
  const bool is_new = known == state.grips.end();
  const std::size_t b = is_new ? opposed.body : known->body;
  const Hand &from = state.hands[slot].previous, &to = state.hands[slot].current;
  const Pose pose = operators_.in_hands_frame(slot, b, state);
  const Material& material = scene_.bodies[b].material;
  Grip grip;
  grip.hand = static_cast<std::uint8_t>(slot);
  grip.body = static_cast<std::uint16_t>(b);
  grip.released = mode_of(b) == GraspMode::never;
  grip.by_palm = opposed.by_palm;
  grip.fingers = opposed.taking_part;
  grip.min_aperture = grip.mean_aperture = aperture(grip, from);
  const double now = grip.min_aperture + fraction * (aperture(grip, to) - grip.min_aperture);
  grip.touch_aperture = std::max(grip.min_aperture, now + opposed.squeeze);
  int fingers = 0;
  for (int finger = 0; finger < kFingers; ++finger) fingers += grip.takes_part(finger) ? 1 : 0;
  const HandStrength& strength = configuration_.hand;
  const double force = std::min(grip.by_palm ? strength.palm : strength.finger, fingers * strength.finger);
  grip.point.fill(Vector3::Zero());
  grip.velocity.fill(Vector3::Zero());
  grip.bond = std::min(2.0 * material.static_friction * force, kUnlimitedBond) / kGripPoints;
  grip.stiffness = kStiffnessRatio * material.stiffness / kGripPoints;
  const Vector3 centre = 0.5 * (opposed.base + opposed.fingers);
  const double reach = std::clamp(0.5 * (opposed.base - opposed.fingers).norm(), kMinReach, kMaxReach);
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 corner(i % 2 == 0 ? -1 : 1, i < 2 ? -1 : 1, i == 0 || i == 3 ? 1 : -1);
    const Vector3 point = centre + reach / std::sqrt(3.0) * corner;
    grip.in_hand[i] = from.palm.to_local(point);
    grip.in_body[i] = pose.to_local(point);
  }
  if (is_new) {
    grip.pads = distal_ends(from);
  } else {
    grip.min_aperture = std::min(grip.min_aperture, known->min_aperture);
    if (known->by_palm == grip.by_palm) grip.fingers |= known->fingers;
    grip.in_hand = known->in_hand, grip.in_body = known->in_body;
    keep_pads(*known, from, grip);
  }
  grip.in_palm_before = moved_in_palm(grip, from);
  grip.in_palm = moved_in_palm(grip, to);
  place(fraction, fraction, state.hands[slot], grip);
  if (is_new)
    for (std::size_t i = 0; i < kGripPoints; ++i)
      grip.in_body[i] = state.bodies[b].pose.to_local(grip.point[i]);
  const auto after = [](const Grip& x, const Grip& y) {
    return x.hand < y.hand || (x.hand == y.hand && x.body < y.body);
  };
  if (is_new) {
    state.grips.insert(std::lower_bound(state.grips.begin(), state.grips.end(), grip, after), grip);
  } else {
    *known = grip;
  }
}

/// A finger that closes touches without force until the hand has the body between two sides. A finger that
/// has stopped before that regains its force slowly.
void GraspAssist::set_compliance(const SimulationState& state, double step, Contact& contact) const {
  const bool released = std::any_of(state.grips.begin(), state.grips.end(), [&](const Grip& grip) {
    return grip.released && is_in(grip, contact.key.hand, contact.key.body);
  });
  if (!released && contact.compliance <= 0.0 && (closing_.empty() || contact.depth > 0.0)) return;
  const bool closes = std::any_of(closing_.begin(), closing_.end(), [&](const ClosingPair& pair) {
    return pair.hand == contact.key.hand && object_index_[pair.body] == object_index_[contact.key.body];
  });
  const bool opposed = closes && is_opposed(contact, state.contacts);
  if (released || (closes && !opposed)) {
    contact.struck = true;
    contact.compliance = std::max(contact.depth, 0.0) + kLight;
  } else {
    const double kept = std::min(contact.compliance, contact.depth) - kRecoverySpeed * step;
    contact.compliance = opposed ? 0.0 : std::max(kept, 0.0);
  }
}

/// Where the springs' ends on the hand are, and how fast.
void GraspAssist::place(double fraction, double until, const HandTrack& track, Grip& grip) const {
  const Pose from = track.previous.palm * grip.in_palm_before;
  const Pose to = track.current.palm * grip.in_palm;
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 start = from * grip.in_hand[i], chord = to * grip.in_hand[i] - start;
    // The point's path bends with the palm's.
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

/// The joints of a linkage move as the fingers tell: the springs act against the mean motion of the links
/// that both sides touch. Their ends on the base's link go back by what this link moves against that mean,
/// and their damping leaves it out.
void GraspAssist::leave_joints_free(double step, SimulationState& state, Grip& grip) const {
  if (object_of(grip.body).size() == 1) return;
  const auto velocity = [&](std::size_t body, const Vector3& point) -> Vector3 {
    const Twist twist = twist_of(scene_.bodies[body], state.bodies[body]);
    return twist.linear + twist.angular.cross(point - state.bodies[body].pose.position);
  };
  const Pose& pose = state.bodies[grip.body].pose;
  for (std::size_t i = 0; i < kGripPoints; ++i) {
    const Vector3 end = pose * grip.in_body[i], of_base = velocity(grip.body, end);
    Vector3 against = Vector3::Zero();  // of the base's link against those of the fingers
    int count = 0;
    for (const Contact& contact : state.contacts) {
      if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body) ||
          is_base(grip.by_palm, contact.key.capsule))
        continue;
      against += of_base - velocity(contact.key.body, end);
      ++count;
    }
    if (count == 0) return;
    const Vector3 by_joints = 0.5 / count * against;
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

void GraspAssist::begin_step(double fraction, double step, SimulationState& state) const {
  if (!acts_) return;
  take_what_is_held(fraction, state);
  const double until = seconds_ > 0.0 ? std::min(1.0, fraction + step / seconds_) : fraction;
  for (Grip& grip : state.grips) {
    const bool touching = touching_sides(grip, state.contacts).both();
    const bool lost = touching ? slips(state.contacts, grip) ||
                                     !is_opposed(grip.hand, grip.body, grip.by_palm, state.contacts)
                               : grip.opened <= kMinOpening;
    if (!grip.active && (!lost || grip.opens || grip.released || grip.lost)) continue;
    place(fraction, until, state.hands[grip.hand], grip);
    leave_joints_free(step, state, grip);
    if (grip.active || offset(state, grip) <= kMaxOffset) continue;
    if (opens_now(state.hands[grip.hand], seconds_, grip)) continue;
    grip.active = true;
    for (std::size_t i = 0; i < kGripPoints; ++i)
      grip.in_body[i] = state.bodies[grip.body].pose.to_local(grip.point[i]);
  }
  for (Contact& contact : state.contacts) set_compliance(state, step, contact);
}

}  // namespace mrhi
