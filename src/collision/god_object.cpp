#include "mr_hand_interaction/collision/god_object.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mrhi {
namespace {

/// The surface's normal may turn by this much from one step to the next while a phalanx slides over it; a
/// larger turn means that the nearest way out is no longer the way in, and the entry face is kept (cosine).
constexpr double kSameFace = 0.5;
/// Below this a contact is at rest [m/s].
constexpr double kRestingSpeed = 1e-9;

struct Plane {
  Vector3 point;         // on the surface, world
  Vector3 normal;        // world
  Vector3 local_normal;  // body frame
  bool entry;            // the face that the phalanx entered by, which is not the nearest any more
};

/// The plane of the face that the phalanx pushes on.
Plane contact_plane(const TouchingPair& pair, const ClosestFeatures& features, const Contact* memory) {
  const Vector3 local = pair.moving.rotation.transpose() * features.normal;
  if (memory == nullptr || !pair.refinements.entry_face || memory->entry_normal.dot(local) >= kSameFace)
    return {features.point, features.normal, local, false};
  return {pair.moving.to_world(memory->god_object), pair.moving.rotation * memory->entry_normal,
          memory->entry_normal, true};
}

const Contact* nearest_memory(const Contact* before, int count, double s) {
  const Contact* nearest = nullptr;
  for (int i = 0; i < count; ++i) {
    if (nearest == nullptr ||
        std::abs(before[i].axis_parameter - s) < std::abs(nearest->axis_parameter - s)) {
      nearest = before + i;
    }
  }
  return nearest;
}

const Contact* memory_of_point(const Contact* before, int count, int point) {
  for (int i = 0; i < count; ++i) {
    if (before[i].key.point == point) return before + i;
  }
  return nullptr;
}

/// A contact that goes on from its memory, or begins.
Contact& begin_contact(const TouchingPair& pair, int point, const Contact* memory,
                       std::vector<Contact>& contacts) {
  if (memory != nullptr) {
    contacts.push_back(*memory);
    return contacts.back();
  }
  contacts.emplace_back();
  Contact& contact = contacts.back();
  contact.key = {static_cast<std::uint16_t>(pair.body_index), static_cast<std::uint8_t>(pair.hand.slot),
                 static_cast<std::uint8_t>(pair.capsule), static_cast<std::uint8_t>(pair.shape_index),
                 static_cast<std::uint8_t>(point)};
  contact.ignored = pair.hand.emerged;
  return contact;
}

/// When another point of the phalanx comes to press, the god object moves along by as much: the stretch
/// between the two, which is what friction has stored, stays.
void roll(const TouchingPair& pair, const Capsule& capsule, const Plane& plane, double s, Contact& contact) {
  const Vector3 shift = (s - contact.axis_parameter) * (capsule.end - capsule.start);
  const Vector3 along = shift - plane.normal.dot(shift) * plane.normal;
  contact.point = pair.moving.to_world(contact.god_object) + along;
  contact.point -= plane.normal.dot(contact.point - plane.point) * plane.normal;
}

/// A phalanx pressed deep into an object would turn it over by the arm that it has beyond the surface. So it
/// holds as if it had been pushed back to the surface the way it came, which is remembered in the palm.
void swing_back(const TouchingPair& pair, const Plane& plane, bool remembered, Contact& contact) {
  if (!remembered) contact.touched_from = pair.hand.palm.transpose() * plane.normal;
  const Vector3 way_back = pair.hand.palm * contact.touched_from;
  contact.lever = std::max(contact.depth, 0.0) * (way_back - plane.normal.dot(way_back) * plane.normal);
}

/// How the phalanx moves in this step.
struct PhalanxMotion {
  explicit PhalanxMotion(const TouchingPair& pair) {
    const auto c = static_cast<std::size_t>(pair.capsule);
    const Capsule& capsule = pair.hand.capsules[c];
    axis = capsule.end - capsule.start;
    start = pair.hand.start_velocity[c];
    spread = pair.hand.end_velocity[c] - start;
    const double length_squared = axis.squaredNorm();
    if (length_squared > 0.0) swing = axis.cross(spread) / length_squared;
    spin = length_squared > 0.0 ? Vector3(swing + (axis.dot(pair.hand.palm_spin) / length_squared) * axis)
                                : pair.hand.palm_spin;
  }

  Vector3 axis, start, spread;
  Vector3 swing = Vector3::Zero();  // angular velocity across the axis, as the ends tell
  Vector3 spin;                     // the same with what the palm tells about the axis
};

void place(const TouchingPair& pair, const PhalanxMotion& motion, const Plane& plane, double s,
           bool remembered, Contact& contact) {
  const Capsule& capsule = pair.hand.capsules[static_cast<std::size_t>(pair.capsule)];
  const Vector3 offset = -capsule.radius * plane.normal;
  contact.hand_point = capsule.axis_point(s) + offset;
  contact.depth = plane.normal.dot(plane.point - contact.hand_point);
  // A god object that has not been pressed yet follows the finger: the stretch begins at the touch.
  const bool pressed = remembered && contact.depth > 0.0;
  if (pressed && pair.refinements.anchors) {
    roll(pair, capsule, plane, s, contact);
  } else {
    contact.point = contact.hand_point + contact.depth * plane.normal;
    contact.friction = Friction::sticking;
    contact.twist = 0.0;
  }
  if (pair.refinements.swing_back && pair.refinements.anchors)
    swing_back(pair, plane, pressed && contact.friction == Friction::sticking, contact);
  contact.god_object = pair.moving.to_local(contact.point);
  contact.entry_normal = plane.local_normal;
  contact.axis_parameter = s;
  contact.normal = plane.normal;
  contact.hand_velocity = motion.start + s * motion.spread + motion.swing.cross(offset);
  contact.hand_spin = plane.normal.dot(motion.spin);
  contact.axis = motion.axis;
  contact.radius = capsule.radius;
  contact.patch = std::sqrt(capsule.radius * std::clamp(contact.depth, 0.0, capsule.radius));
  const Twist& twist = pair.moving.twist;
  const Vector3 point_velocity =
      twist.linear + twist.angular.cross(contact.point - pair.moving.pose.position);
  contact.approach = classify(contact.normal.dot(contact.hand_velocity - point_velocity));
}

bool reaches_surface(const TouchingPair& pair, const Plane& plane, double s) {
  const Capsule& capsule = pair.hand.capsules[static_cast<std::size_t>(pair.capsule)];
  return plane.normal.dot(capsule.axis_point(s) - plane.point) - capsule.radius < kSeparation;
}

double deepest_end(const TouchingPair& pair, const Plane& plane) {
  const Capsule& capsule = pair.hand.capsules[static_cast<std::size_t>(pair.capsule)];
  return plane.normal.dot(capsule.end - capsule.start) < 0.0 ? 1.0 : 0.0;
}

/// Load is shared by the lever rule in the depths, so that the whole is stiffness times depth both for a
/// phalanx that lies flat and for one that stands on its tip.
void share_load(Contact& a, Contact& b) {
  const double da = std::max(a.depth, 0.0), db = std::max(b.depth, 0.0);
  a.share = da + db > 0.0 ? da / (da + db) : 0.5;
  b.share = 1.0 - a.share;
}

}  // namespace

void update_god_objects(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                        const Contact* before, int count, std::vector<Contact>& contacts) {
  const Contact* nearest = nearest_memory(before, count, features.axis_parameter);
  const Plane plane = contact_plane(pair, features, nearest);
  const bool lies_flat = pair.refinements.two_points && span.s1 > span.s0 &&
                         reaches_surface(pair, plane, span.s0) && reaches_surface(pair, plane, span.s1);
  const PhalanxMotion motion(pair);
  if (!lies_flat) {
    const int point = nearest != nullptr ? nearest->key.point : (features.axis_parameter > 0.5 ? 1 : 0);
    Contact& contact = begin_contact(pair, point, nearest, contacts);
    const double s = plane.entry ? deepest_end(pair, plane) : features.axis_parameter;
    place(pair, motion, plane, s, nearest != nullptr && nearest->depth > 0.0, contact);
    contact.share = 1.0;
    return;
  }
  const std::array<double, 2> ends{{span.s0, span.s1}};
  for (int point = 0; point < 2; ++point) {
    const Contact* memory = memory_of_point(before, count, point);
    Contact& contact = begin_contact(pair, point, memory, contacts);
    if (memory == nullptr && nearest != nullptr) {
      contact.struck = nearest->struck;
      contact.ignored = nearest->ignored;
    }
    place(pair, motion, plane, ends[static_cast<std::size_t>(point)],
          memory != nullptr && memory->depth > 0.0, contact);
  }
  share_load(contacts[contacts.size() - 2], contacts.back());
}

Approach classify(double normal_velocity) {
  if (normal_velocity < -kRestingSpeed) return Approach::colliding;
  return normal_velocity > kRestingSpeed ? Approach::separating : Approach::resting;
}

Vector3 object_velocity(const Twist& twist, const Vector3& centre, const Vector3& point) {
  return twist.linear + twist.angular.cross(point - centre);
}

}  // namespace mrhi
