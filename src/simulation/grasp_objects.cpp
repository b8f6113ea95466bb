#include "grasp_objects.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

GraspMode resolved_mode(const Scene& scene, int body, const Configuration& configuration) {
  const bool is_implicit = configuration.contact_model == ContactModelKind::implicit;
  if (!is_implicit || scene.bodies[body].fixed) return GraspMode::free;
  const GraspMode mode = grasp_of(scene, body);
  if (mode != GraspMode::parameter) return mode;
  return configuration.contact.grasp_assist ? GraspMode::assist : GraspMode::free;
}

/// A finger closes if its aperture shrinks faster than this [m/s],
constexpr double kMinClosingSpeed = 0.03;
/// and than this fraction of its own and its base's speed: a hand that slaps or nudges does not close.
constexpr double kMinClosingRatio = 0.25;
/// Largest distance of a body from the line between a finger and its base [m].
constexpr double kMaxLineDistance = 0.01;
/// Largest distance at which a hand's closest faces are searched [m].
constexpr double kSearchDistance = 0.1;

double distance_from_axis(const Vector3& point, const Capsule& capsule) {
  const Vector3 along = capsule.end - capsule.start;
  const double s = (point - capsule.start).dot(along) / std::max(along.squaredNorm(), 1e-30);
  return (point - capsule.axis_point(std::clamp(s, 0.0, 1.0))).norm();
}

bool has_tip(const Hand& hand, int finger) {
  return hand.has(capsule_index(finger, 3));
}

}  // namespace

GraspObjects::GraspObjects(const Scene& scene, const Configuration& configuration) {
  constexpr auto kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> index_by_root(scene.bodies.size(), kNone);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto body = static_cast<int>(b);
    std::size_t& index = index_by_root[floating_root(scene, body).value_or(body)];
    if (index == kNone) {
      index = objects_.size();
      objects_.emplace_back();
      modes_.push_back(resolved_mode(scene, body, configuration));
      any_graspable_ = any_graspable_ || modes_.back() != GraspMode::free;
    }
    objects_[index].push_back(body);
    index_.push_back(index);
    friction_angle_.push_back(std::atan(scene.bodies[b].material.static_friction));
  }
}

bool GraspObjects::only_fingers_of(const Grip& grip, const Contacts& contacts) const {
  return std::none_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.depth > 0.0 && is_in(grip, contact.key.hand, contact.key.body) &&
           !is_base(grip.by_palm, contact.key.capsule) && !is_base(true, contact.key.capsule) &&
           !grip.takes_part(finger_of(contact.key.capsule));
  });
}

TouchingGroups GraspObjects::touching_groups(const Grip& grip, const Contacts& contacts) const {
  TouchingGroups sides;
  for (const Contact& contact : contacts) {
    if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body)) continue;
    (is_base(grip.by_palm, contact.key.capsule) ? sides.base : sides.fingers) = true;
  }
  return sides;
}

bool GraspObjects::slips(const Grip& grip, const Contacts& contacts) const {
  double normal[2] = {}, slipping[2] = {};  // of fingers and of the base [N]
  for (const Contact& contact : contacts) {
    if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body)) continue;
    const bool group = is_base(grip.by_palm, contact.key.capsule);
    const double normal_force = std::max(0.0, -contact.force.dot(contact.normal));
    normal[group] += normal_force;
    if (contact.friction != Friction::sticking) slipping[group] += normal_force;
  }
  return slipping[0] > 0.5 * normal[0] || slipping[1] > 0.5 * normal[1];
}

bool GraspObjects::is_opposed(const Contact& contact, const Contacts& contacts, bool by_any_hand) const {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& other) {
    return (by_any_hand || other.key.hand == contact.key.hand) && !other.ignored &&
           same_object(other.key.body, contact.key.body) &&
           other.normal.dot(contact.normal) < kMaxOpposingCosine;
  });
}

/// Two contacts hold a body if the friction cones of both contain the other (Nguyen 1988): their normals are
/// then at most two friction angles from opposite. Calls see(base, other, n.n') until it returns false.
template <typename See>
void GraspObjects::each_opposed(std::size_t hand, std::size_t body, bool by_palm, const Contacts& contacts,
                                const See& see) const {
  const auto touches = [&](const Contact& contact) {
    return contact.depth > 0.0 && contact.key.hand == hand && same_object(contact.key.body, body);
  };
  for (const Contact& base : contacts) {
    if (!touches(base) || !is_base(by_palm, base.key.capsule)) continue;
    const double angle = friction_angle_[base.key.body];
    for (const Contact& other : contacts) {
      if (!touches(other) || (base.ignored && other.ignored) || is_base(true, other.key.capsule) ||
          is_base(by_palm, other.key.capsule))
        continue;
      const double cosine = base.normal.dot(other.normal);
      if (cosine >= 0.0) continue;  // whatever the friction
      if (cosine > -std::cos(angle + friction_angle_[other.key.body])) continue;
      if (!see(base, other, cosine)) return;
    }
  }
}

bool GraspObjects::is_opposed(std::size_t hand, std::size_t body, bool by_palm,
                              const Contacts& contacts) const {
  bool found = false;
  each_opposed(hand, body, by_palm, contacts,
               [&](const Contact&, const Contact&, double) { return !(found = true); });
  return found;
}

std::optional<OpposingContacts> GraspObjects::opposing_contacts(std::size_t hand, std::size_t body,
                                                                bool by_palm,
                                                                const Contacts& contacts) const {
  OpposingContacts result;
  result.by_palm = by_palm;
  double smallest_cosine = 1.0;
  each_opposed(hand, body, by_palm, contacts, [&](const Contact& base, const Contact& other, double cosine) {
    const int bit = 1 << finger_of(other.key.capsule);
    result.fingers_mask = static_cast<std::uint8_t>(result.fingers_mask | bit);
    result.depth = std::max({result.depth, base.depth, other.depth});
    if (cosine >= smallest_cosine) return true;
    smallest_cosine = cosine;
    result.squeeze = base.depth + other.depth;
    result.base = base.point, result.fingers = other.point;
    result.body = base.key.body;
    return true;
  });
  return result.fingers_mask != 0 ? std::optional<OpposingContacts>(result) : std::nullopt;
}

bool ClosingHand::closes(const HandTrack& track, bool by_palm, int finger) {
  const Vector3 across = tip_of(track.current, finger) - base_of(track.current, by_palm);
  const auto& points = track.mean_velocity.points;
  const Vector3 &tip = points[tip_point(finger)], &base = points[by_palm ? 0 : tip_point(0)];
  const double least = std::max(kMinClosingSpeed, kMinClosingRatio * std::max(tip.norm(), base.norm()));
  return -across.dot(tip - base) > least * across.norm();
}

std::optional<ClosingHand::Nearest> ClosingHand::nearest(const Capsule& capsule, const Object& object,
                                                         const Poses& poses, double margin) const {
  std::optional<Nearest> result;
  for (std::size_t i = 0; i < object.size(); ++i) {
    const int body = object[i];
    const auto shapes = static_cast<int>(scene_.bodies[body].shapes.size());
    for (int shape = 0; shape < shapes; ++shape) {
      const auto features = finder_.closest(capsule, body, shape, poses[i], margin);
      if (features && (!result || features->distance < result->features.distance))
        result = Nearest{*features, body};
    }
  }
  return result;
}

double ClosingHand::gap(const Hand& hand, bool by_palm, bool of_base, const Object& object,
                        const Poses& poses) const {
  double limit = kSearchDistance;
  for (int c = 0; c < kCapsules; ++c) {
    if (!hand.has(c) || is_base(by_palm, c) != of_base) continue;
    const auto found = nearest(hand.capsules[c], object, poses, limit);
    if (found) limit = std::min(limit, found->features.distance);
  }
  return limit;
}

bool ClosingHand::on_opposite_faces(const Hand& hand, int finger, const Object& object,
                                    const Poses& poses) const {
  const auto under = [&](int capsule) {
    return nearest(hand.capsules[capsule], object, poses, kSearchDistance);
  };
  const auto tip = under(capsule_index(finger, 3)), base = under(capsule_index(0, 3));
  return tip && base && tip->features.normal.dot(base->features.normal) < kMaxOpposingCosine;
}

bool ClosingHand::closes_on(const HandTrack& track, int finger, const Object& object,
                            const Poses& poses) const {
  if (!closes(track, false, finger)) return false;
  const Hand& hand = track.current;
  const Capsule line{base_of(hand, false), tip_of(hand, finger), 0.0};
  bool is_far = true;
  for (std::size_t i = 0; i < object.size(); ++i) {
    const Body& body = scene_.bodies[object[i]];
    is_far = is_far && distance_from_axis(poses[i].position, line) > body.bounding_radius + kMaxLineDistance;
  }
  return !is_far && nearest(line, object, poses, kMaxLineDistance) &&
         on_opposite_faces(hand, finger, object, poses);
}

bool ClosingHand::closes_on(const HandTrack& track, const Object& object, const Poses& poses) const {
  if (!has_tip(track.current, 0)) return false;
  for (int finger = 1; finger < kFingers; ++finger)
    if (has_tip(track.current, finger) && closes_on(track, finger, object, poses)) return true;
  return false;
}

}  // namespace mrhi
