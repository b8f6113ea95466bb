#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "../rendering/renderer.h"
#include "../response/finger_limits.h"
#include "simulation_impl.h"

namespace mrhi {
namespace {

/// Tests the sum of its numbers: opposite infinities give NaN.
bool finite(const Hand& hand) {
  Vector3 sum = hand.palm.position + hand.wrist;
  double radii = hand.palm.orientation.coeffs().sum();
  for (const Capsule& capsule : hand.capsules) {
    sum += capsule.start + capsule.end;
    radii += capsule.radius;
  }
  return std::isfinite(sum.sum() + radii);
}
bool finite(const Contact& contact) {
  return contact.force.allFinite() && contact.impulse.allFinite() && contact.point.allFinite() &&
         contact.normal.allFinite() && std::isfinite(contact.depth);
}

std::string name_of(const Hand& hand) {
  return "hand " + std::to_string(hand.id);
}

bool before(const Contact& contact, const ContactKey& key) {
  return contact.key < key;
}

/// The mean force is the transferred momentum over the frame's time. A contact that has ended is reported at
/// its last place, without depth.
void add_transfer(const FrameTransfer& transfer, std::vector<Contact>& contacts) {
  const std::size_t touching = contacts.size();
  const double rate = transfer.seconds > 0.0 ? 1.0 / transfer.seconds : 0.0;
  for (const Contact& moved : transfer.contacts) {
    const auto end = contacts.begin() + touching;
    auto same = std::lower_bound(contacts.begin(), end, moved.key, before);
    if (same == end || !(same->key == moved.key)) {
      contacts.push_back(moved);
      same = contacts.end() - 1;
      same->depth = std::min(same->depth, 0.0);
    }
    same->impulse = moved.impulse;
    same->force = rate * moved.force;
    same->torque = rate * moved.torque;
    same->peak_force = moved.peak_force;
  }
  if (contacts.size() > touching) {
    std::sort(contacts.begin(), contacts.end(),
              [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
}

/// The hand's active or released grip on the object that the body belongs to: the body or its linkage.
const Grip* grip_on(const Scene& scene, const std::vector<Grip>& grips, std::size_t slot, int body) {
  const auto object = [&](int part) { return floating_root(scene, part).value_or(part); };
  for (const Grip& grip : grips)
    if (grip.hand == slot && (grip.active || grip.released) && object(grip.body) == object(body))
      return &grip;
  return nullptr;
}

/// Distances at which hovering over a body begins and ends [m].
constexpr double kHoverBegins = 0.03, kHoverEnds = 0.045;
/// Largest ratio of the loads' vector sum to the sum of their norms with which a grasp begins, and lasts.
constexpr double kMaxImbalance = 0.6, kMaxLastingImbalance = 0.75;

/// Normal loads of contacts, by their depths and the strength of the fingers. A finger that has gone through
/// the object applies no more force than one that complies at its surface.
struct Load {
  Vector3 sum = Vector3::Zero();
  double total = 0.0;
  int capsules = 0;
  bool struck = false;
};

template <typename Counts>
Load load_of(const Scene& scene, const std::vector<Contact>& contacts, Counts&& counts) {
  Load load;
  int last_capsule = -1;
  for (const Contact& contact : contacts) {
    if (!counts(contact.key)) continue;
    if (contact.impulse != Vector3::Zero()) load.struck = true;
    if (!contact.touching()) continue;
    const double stiffness = contact.share * scene.bodies[contact.key.body].material.stiffness;
    const double normal = std::min(stiffness * contact.depth, contact.strength);
    load.sum += normal * contact.normal;
    load.total += normal;
    const int capsule = kCapsules * contact.key.hand + contact.key.capsule;
    if (capsule != last_capsule) ++load.capsules;
    last_capsule = capsule;
  }
  return load;
}

bool is_balanced(const Load& load, double max_imbalance) {
  return load.capsules >= 2 && load.sum.norm() <= max_imbalance * load.total;
}

/// True if the loads of the hand on an object balance, or those of all hands while those of the others do
/// not: each side of a box that two hands lift.
template <typename OfObject>
bool grasps(const Scene& scene, int slot, const std::vector<Contact>& contacts, double max_imbalance,
            const OfObject& of_object) {
  const auto balances = [&](const auto& counts) {
    return is_balanced(load_of(scene, contacts, counts), max_imbalance);
  };
  if (balances([&](const ContactKey& key) { return key.hand == slot && of_object(key); })) return true;
  return balances(of_object) &&
         !balances([&](const ContactKey& key) { return key.hand != slot && of_object(key); });
}

bool is_near(const Hand& hand, int body, const ContactFinder& finder, const Body& shape_of, const Pose& pose,
             double distance) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[c];
    if (capsule.radius <= 0.0) continue;
    const double reach = shape_of.bounding_radius + capsule.radius + distance;
    if ((capsule.centre() - pose.position).norm() > reach + 0.5 * (capsule.end - capsule.start).norm())
      continue;
    for (int shape = 0; shape < static_cast<int>(shape_of.shapes.size()); ++shape) {
      if (finder.closest(capsule, body, shape, pose, distance)) return true;
    }
  }
  return false;
}

}  // namespace

InteractionLevel seen_level(const Hand& hand, int slot, int body, const ContactFinder& finder,
                            const Scene& scene, const Pose& body_pose, const std::vector<Contact>& contacts,
                            InteractionLevel before) {
  const auto of_hand = [&](const ContactKey& key) { return key.hand == slot && key.body == body; };
  const Load load = load_of(scene, contacts, of_hand);
  const double max_imbalance = before == InteractionLevel::grasp ? kMaxLastingImbalance : kMaxImbalance;
  // A linkage is grasped as a whole: both arms of tongs, each loaded from one side.
  const std::optional<int> root = scene.joints.empty() ? std::nullopt : floating_root(scene, body);
  const auto of_body = [&](const ContactKey& key) { return key.body == body; };
  const auto of_linkage = [&](const ContactKey& key) { return floating_root(scene, key.body) == root; };
  if (load.capsules >= 1 && (grasps(scene, slot, contacts, max_imbalance, of_body) ||
                             (root && grasps(scene, slot, contacts, max_imbalance, of_linkage))))
    return InteractionLevel::grasp;
  if (load.capsules >= 1 || load.struck) return InteractionLevel::contact;
  const double distance = before == InteractionLevel::none ? kHoverBegins : kHoverEnds;
  const Body& shape_of = scene.bodies[body];
  return is_near(hand, body, finder, shape_of, body_pose, distance) ? InteractionLevel::hover
                                                                    : InteractionLevel::none;
}

bool is_finite(const BodyState& state) {
  return std::isfinite(state.pose.position.sum() + state.pose.orientation.coeffs().sum() +
                       state.linear_momentum.sum() + state.angular_momentum.sum());
}

void Simulation::Impl::lose_hands_that_are_not_finite(Nanoseconds now) {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    HandTrack& track = state.hands[slot];
    if (!track.active || finite(track.current)) continue;
    result.not_finite.push_back(name_of(track.current));
    end_interactions(slot, now);
    result.events.push_back({now, EventKind::hand_lost, -1, track.current.id});
    track = HandTrack();
    state.offsets[slot] = HandOffset();
    state.mass_lags[slot] = MassLag();
  }
}

/// Shows the tracked hand if the rendered one is not finite.
void Simulation::Impl::show_hands_that_are_finite() {
  for (std::size_t i = 0; i < result.rendered.size(); ++i) {
    if (finite(result.rendered[i].hand)) continue;
    result.not_finite.push_back("rendered " + name_of(result.tracked[i]));
    result.rendered[i].hand = result.tracked[i];
    std::fill(state.offsets.begin(), state.offsets.end(), HandOffset());
    std::fill(state.mass_lags.begin(), state.mass_lags.end(), MassLag());
  }
}

void Simulation::Impl::leave_out_contacts_that_are_not_finite() {
  const auto end = std::remove_if(result.contacts.begin(), result.contacts.end(), [this](const Contact& c) {
    if (finite(c)) return false;
    result.not_finite.push_back("contact with '" + scene.bodies[c.key.body].name + "'");
    return true;
  });
  result.contacts.erase(end, result.contacts.end());
}

void Simulation::Impl::find_final_contacts() {
  std::vector<Contact>& contacts = result.contacts;
  for (HandMotion& hand : hands) hand.move_to(1.0, 1.0);
  contacts.reserve(state.contacts.capacity());  // the finder keeps what it is given, for the next step
  contacts = state.contacts;
  neighbours.begin_step(state.bodies, 0.0);
  finder.find(hands, neighbours, state.bodies, 0.0, contacts);
  for (Contact& contact : contacts)
    contact.impulse.setZero(), contact.force.setZero(), contact.torque = contact.peak_force = 0.0;
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(), [](const Contact& c) { return !c.touching(); }),
      contacts.end());
  share_strength(configuration.contact.hand, contacts);
}

void Simulation::Impl::update_interactions() {
  const std::size_t bodies = scene.bodies.size();
  const bool struck = std::any_of(transfer.contacts.begin(), transfer.contacts.end(),
                                  [](const Contact& contact) { return !contact.impulse.isZero(0.0); });
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active) continue;
    const HandTrack& track = operators.in_world(slot, state);
    const Eigen::AlignedBox3d hand = box_around(track.current);
    for (std::size_t b = 0; b < bodies; ++b) {
      const int body = static_cast<int>(b);
      const bool near =
          is_near(hand, state.bodies[b].pose.position, scene.bodies[b].bounding_radius + kHoverEnds);
      Interaction& interaction = state.interactions[slot * bodies + b];
      const bool may_end = interaction.level != InteractionLevel::none || struck;
      const bool is_held_fixture = scene.bodies[b].fixed && !operators.none();
      if ((scene.bodies[b].fixed && !is_held_fixture) || scene.bodies[b].is_operator || (!near && !may_end))
        continue;
      const Grip* const grip = grip_on(scene, state.grips, slot, body);
      InteractionLevel seen = InteractionLevel::contact;
      if (grip == nullptr || (grip->active && grip->body != b))
        seen = seen_level(track.current, static_cast<int>(slot), body, finder, scene, state.bodies[b].pose,
                          result.contacts, interaction.level);
      // A supported object is grasped; of a linkage, the links that the hand touches.
      if (grip != nullptr && grip->active && seen == InteractionLevel::contact)
        seen = InteractionLevel::grasp;
      if (grasp_of(scene, body) == GraspMode::never) seen = std::min(seen, InteractionLevel::contact);
      update_interaction(seen, {state.time, EventKind::hover_begin, body, track.current.id}, interaction,
                         result.events);
    }
  }
}

void Simulation::Impl::report(Nanoseconds stamp) {
  result.stamp = stamp;
  operators.end_frame(state);
  find_final_contacts();
  add_transfer(transfer, result.contacts);
  for (GraspSupport support : transfer.assists) {
    support.force /= transfer.seconds, support.torque /= transfer.seconds;
    result.assists.push_back(support);
  }
  update_interactions();
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot)
    if (state.hands[slot].active) result.tracked.push_back(operators.in_world(slot, state).current);
  leave_out_contacts_that_are_not_finite();
  reported = true;
}

/// The track of the slot displaced by its mass lag, stored in `lagging`; the track itself without lag.
const HandTrack& Simulation::Impl::lagging_track(std::size_t slot, std::unique_ptr<HandTrack>& lagging) {
  const double ratio = configuration.control_display_ratio;
  MassLag& lag = state.mass_lags[slot];
  const HandTrack& track = operators.in_world(slot, state);
  if (track.appeared || ratio <= 1.0) lag = MassLag();
  if (ratio <= 1.0) return track;
  const MassLag before = lag;
  const Nanoseconds now = state.time;
  MovedMass moved;
  if (before.stamp != 0 && now > before.stamp)
    moved = moved_mass(static_cast<int>(slot), to_seconds(now - before.stamp), scene, gravity, result);
  advance_mass_lag(ratio, moved, now, lag);
  if (before.zero() && lag.zero()) return track;
  if (!lagging) lagging = std::make_unique<HandTrack>();
  lag_behind(before, lag, track, *lagging);
  return *lagging;
}

void Simulation::Impl::render() {
  std::unique_ptr<HandTrack> lagging;  // large: made only when a hand lags
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active) continue;
    const HandTrack& track = lagging_track(slot, lagging);
    result.rendered.emplace_back();
    HandFrameView view{track,           static_cast<int>(slot),
                       state.time,      state.bodies,
                       result.contacts, state.interactions.data() + slot * state.bodies.size()};
    renderer.render(view, state.offsets[slot], result.rendered.back());
  }
  show_hands_that_are_finite();
}

void FrameTransfer::add(const SimulationState& after, double step) {
  seconds += step;
  for (const Grip& grip : after.grips) {
    if (!grip.active) continue;
    const auto same = std::find_if(assists.begin(), assists.end(), [&](const GraspSupport& known) {
      return known.hand == grip.hand && known.body == grip.body;
    });
    if (same == assists.end()) {
      assists.push_back({grip.hand, grip.body, step * grip.force, step * grip.torque});
    } else {
      same->force += step * grip.force, same->torque += step * grip.torque;
    }
  }
  for (auto contact = after.contacts.begin(); contact != after.contacts.end();) {
    const auto end = std::find_if(contact, after.contacts.end(), [&](const Contact& other) {
      return !contact->key.same_phalanx(other.key);
    });
    const auto plus = [](const Vector3& sum, const Contact& one) -> Vector3 { return sum + one.force; };
    const double force = std::accumulate(contact, end, Vector3(Vector3::Zero()), plus).norm();
    for (; contact != end; ++contact) add(*contact, step, force);
  }
}

/// `force`: of all contacts of its phalanx with the body [N].
void FrameTransfer::add(const Contact& contact, double step, double force) {
  if (contact.impulse.isZero(0.0) && contact.force.isZero(0.0)) return;
  auto known = std::lower_bound(contacts.begin(), contacts.end(), contact.key, before);
  if (known == contacts.end() || !(known->key == contact.key)) {
    known = contacts.insert(known, contact);
    known->force *= step, known->torque *= step;
  } else {
    known->impulse += contact.impulse;
    known->force += step * contact.force, known->torque += step * contact.torque;
  }
  known->peak_force = std::max(known->peak_force, force);
}

void Simulation::Impl::end_interactions(std::size_t slot, Nanoseconds now) {
  const std::size_t bodies = state.bodies.size();
  for (std::size_t b = 0; b < bodies; ++b) {
    end_interaction({now, EventKind::hover_end, static_cast<int>(b), state.hands[slot].current.id},
                    state.interactions[slot * bodies + b], result.events);
  }
}

}  // namespace mrhi
