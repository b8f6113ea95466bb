#include "grasp_objects.h"

#include <algorithm>
#include <cmath>

#include "closing_hand.h"

namespace mrhi {
namespace {

GraspMode resolved_mode(const Scene& scene, int body, const Configuration& configuration) {
  const bool is_implicit = configuration.contact_model == ContactModelKind::implicit;
  if (!is_implicit || scene.bodies[body].fixed) return GraspMode::free;
  const GraspMode mode = grasp_of(scene, body);
  if (mode != GraspMode::parameter) return mode;
  return configuration.contact.grasp_assist ? GraspMode::assist : GraspMode::free;
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

TouchingSides GraspObjects::touching_sides(const Grip& grip, const Contacts& contacts) const {
  TouchingSides sides;
  for (const Contact& contact : contacts) {
    if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body)) continue;
    (is_base(grip.by_palm, contact.key.capsule) ? sides.base : sides.fingers) = true;
  }
  return sides;
}

bool GraspObjects::slips(const Grip& grip, const Contacts& contacts) const {
  double push[2] = {}, slipping[2] = {};  // of fingers and of the base [N]
  for (const Contact& contact : contacts) {
    if (!contact.touching() || !is_in(grip, contact.key.hand, contact.key.body)) continue;
    const bool side = is_base(grip.by_palm, contact.key.capsule);
    const double normal_force = std::max(0.0, -contact.force.dot(contact.normal));
    push[side] += normal_force;
    if (contact.friction != Friction::sticking) slipping[side] += normal_force;
  }
  return slipping[0] > 0.5 * push[0] || slipping[1] > 0.5 * push[1];
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

}  // namespace mrhi
