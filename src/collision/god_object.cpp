#include "contact_finder.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Smallest cosine between the normals of successive steps of a phalanx that slides over a surface. A larger
/// turn means that the nearest surface is no longer the one entered by, and the entry face is kept.
constexpr double kMinSameFaceCosine = 0.5;

/// The plane of the face that the phalanx pushes on, in the body's frame.
struct ContactPlane {
  const Vector3& point;
  const Vector3& normal;
  bool entry;  // the face that the phalanx entered by, which is not the nearest any more
};

/// On the entry face the god object is the plane's point: the nearest features are those of another face.
ContactPlane contact_plane(const TouchingPair& pair, const ClosestFeatures& features,
                           const ContactMemory* memory) {
  if (memory == nullptr || !pair.refinements.entry_face ||
      memory->entry_normal.dot(features.normal) >= kMinSameFaceCosine)
    return {features.point, features.normal, false};
  return {memory->god_object, memory->entry_normal, true};
}

/// The contacts of a pair in the last step: at most two, named 0 and 1.
struct PairMemory {
  PairMemory(const Contact* before, int count, double s) {
    for (int i = 0; i < count; ++i) of_point[before[i].key.point] = before + i;
    nearest = of_point[0] != nullptr ? of_point[0] : of_point[1];
    if (count > 1 && distance(of_point[1], s) < distance(of_point[0], s)) nearest = of_point[1];
  }
  static double distance(const Contact* contact, double s) { return std::abs(contact->axis_parameter - s); }

  const Contact* of_point[2] = {nullptr, nullptr};
  const Contact* nearest;  // to s; null if there is none
};

/// A phalanx on a plane, with what all its points share.
///
/// The depth of axis point a(s) below the plane through q with the outward normal n:
///     depth(s) = n.(q - a(s)) + r = n.(c - p),   c the god object, p = a(s) - r n,
/// linear in s. It is measured in the body's frame, where the plane stands still, but velocities are those in
/// world.
struct Indentation {
  Indentation(const TouchingPair& of, const ContactPlane& on)
      : pair(of),
        plane(on),
        along(of.in_body.end - of.in_body.start),
        start_depth(on.normal.dot(on.point - of.in_body.start) + of.in_body.radius),
        fall(on.normal.dot(along)),
        normal(of.moving.rotation * on.normal),
        motion(of.hand.motion(of.capsule, of.in_world)),
        start_velocity(motion.of_surface(0.0, -of.in_world.radius * normal)),
        spin(normal.dot(motion.spin)) {}

  double depth(double s) const { return start_depth - s * fall; }
  bool reaches_surface(double s) const { return depth(s) > -kSeparation; }
  double deepest_end() const { return fall < 0.0 ? 1.0 : 0.0; }

  const TouchingPair& pair;
  const ContactPlane& plane;
  // Body's frame.
  Vector3 along;
  double start_depth, fall;  // towards the surface: of the start, from the start to the end [m]
  // World.
  Vector3 normal;
  PhalanxMotion motion;
  Vector3 start_velocity;  // of the surface
  double spin;
};

/// The god object in the body's frame. Before the contact it follows the finger, so that the spring starts
/// without stretch. If another point of the phalanx takes the load, the god object moves with it: the
/// stretch, in which friction is stored, stays the same.
///
/// Zilles & Salisbury 1995: the point of the active plane nearest to the finger's point, which is its
/// projection x + n n.(q - x). A single plane is active, that of the entry face; where faces meet, the
/// nearest features choose.
Vector3 god_object(const Indentation& indentation, double s, const ContactMemory* memory) {
  const Vector3 point = memory != nullptr
                            ? Vector3(memory->god_object + (s - memory->axis_parameter) * indentation.along)
                            : Vector3(indentation.pair.in_body.start + s * indentation.along);
  return point + indentation.plane.normal.dot(indentation.plane.point - point) * indentation.plane.normal;
}

/// A phalanx deep in an object would turn it over by its lever beyond the surface. So its force acts as if it
/// had been moved back to the surface along its path, which is kept in the palm's frame. Over an edge the
/// nearest point stays while the skin rolls past it: there the axis has moved about the edge, along its path.
///
/// With w the direction back (palm * touched_from) and d the depth: p + d w, held against p + d n, is off by
/// d (w - (n.w) n) along the surface. At an edge the axis's point is r - d off it, along n now, along w as it
/// came: it has gone (r - d)(n - w), of which across n is left (d - r)(w - (n.w) n).
Vector3 lever(const Matrix3& palm, bool at_edge, const Contact& contact) {
  const Vector3 towards_entry = palm * contact.touched_from;
  const double length = at_edge ? contact.depth - contact.radius : contact.depth;
  return length * (towards_entry - contact.normal.dot(towards_entry) * contact.normal);
}

/// The lever is zero at the first contact, w = n, and grows as palm and body turn relative to each other. It
/// is reset by slip.
void swing_back(const TouchingPair& pair, const ContactMemory* held, Contact& contact) {
  const Matrix3& palm = pair.hand.palm;
  contact.lever.setZero();
  if (held != nullptr) {
    contact.lever = lever(palm, held->at_edge, contact);
    if (held->at_edge == contact.at_edge) return;
    // The stretch stored on a face continues at the edge, and vice versa.
    contact.point -= contact.lever;
    contact.god_object = pair.moving.to_local(contact.point);
    contact.lever.setZero();
  }
  contact.touched_from = palm.transpose() * contact.normal;
}

/// Places the contact's point at s. `memory` is the contact that it continues, or null.
///
/// The patch is Hertz's, a^2 = r d for a ball of radius r pressed in by d (Johnson 1985), whose depth counts
/// up to r.
void place(const Indentation& indentation, double s, const ContactMemory* memory, Contact& contact) {
  const ContactConfiguration& refinements = indentation.pair.refinements;
  contact.depth = indentation.depth(s);
  const bool persists =
      refinements.anchors && memory != nullptr && memory->depth > 0.0 && contact.depth > 0.0;
  contact.god_object = god_object(indentation, s, persists ? memory : nullptr);
  contact.entry_normal = indentation.plane.normal;
  contact.axis_parameter = s;
  if (!persists) {
    contact.friction = Friction::sticking;
    contact.twist = contact.engaged = 0.0;
  }
  const Capsule& capsule = indentation.pair.in_world;
  contact.point = indentation.pair.moving.to_world(contact.god_object);
  contact.normal = indentation.normal;
  contact.hand_point = capsule.start + s * indentation.motion.axis - capsule.radius * indentation.normal;
  contact.hand_velocity = indentation.start_velocity + s * indentation.motion.spread;
  contact.hand_spin = indentation.spin;
  contact.axis = indentation.motion.axis;
  contact.radius = capsule.radius;
  contact.patch = std::sqrt(capsule.radius * std::clamp(contact.depth, 0.0, capsule.radius));
  contact.share = contact.grip = 1.0;
  contact.impulse.setZero();
  contact.time_of_impact = contact.torque = 0.0;
  const bool held = persists && refinements.swing_back && contact.friction == Friction::sticking;
  swing_back(indentation.pair, held ? memory : nullptr, contact);
}

/// Contact `point` of the pair at s, continued from its memory or new. A second point of an old pair
/// continues the nearest one: it causes no new impact, applies no force where that complies or is ignored,
/// and takes over a share of its friction along with its load. A hand or a body that is spawned beside the
/// other, without overlap, touches it from then on.
void continue_contact(const Indentation& indentation, int point, double s, bool at_edge,
                      const ContactMemory* memory, Contact& contact) {
  const TouchingPair& pair = indentation.pair;
  static_cast<ContactMemory&>(contact) = memory != nullptr ? *memory : ContactMemory();
  contact.key = pair.key(point);
  contact.at_edge = at_edge;
  place(indentation, s, memory, contact);
  if (memory == nullptr) contact.ignored = contact.depth > 0.0 && (pair.hand.spawned || pair.moving.appeared);
}

/// Load is shared by the lever rule in the depths, so that the whole is stiffness times depth both for a
/// phalanx that lies flat and for one that stands on its tip. With d_a, d_b > 0 shares are d_a / (d_a + d_b)
/// and the rest, so that the push is gamma (d_a^2 + d_b^2) / (d_a + d_b): gamma d for d_a = d_b = d,
/// gamma d_a for d_b = 0, and continuous as the phalanx tips up.
void share_load(Contact& a, Contact& b) {
  const double da = std::max(a.depth, 0.0), db = std::max(b.depth, 0.0);
  a.share = da + db > 0.0 ? da / (da + db) : 0.5;
  b.share = 1.0 - a.share;
}

}  // namespace

/// A phalanx lies flat if both ends of the span are within kSeparation of the surface. Points 0 and 1 are
/// named by the ends of the span, so that each keeps its memory; a single point continues the nearer of the
/// two by s. On the entry face it is the deepest end, as the nearest features' s is that of another face.
int update_god_objects(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                       const Contact* before, int count, Contact* now) {
  const PairMemory memory(before, count, features.axis_parameter);
  const Contact* nearest = memory.nearest;
  const ContactPlane plane = contact_plane(pair, features, nearest);
  const Indentation indentation(pair, plane);
  const bool lies_flat = pair.refinements.two_points && span.s1 > span.s0 &&
                         indentation.reaches_surface(span.s0) && indentation.reaches_surface(span.s1);
  if (!lies_flat) {
    const int point = nearest != nullptr ? nearest->key.point : (features.axis_parameter > 0.5 ? 1 : 0);
    const bool at_edge = plane.entry ? nearest->at_edge : span.at_edge && pair.refinements.edge_grip;
    const double s = plane.entry ? indentation.deepest_end() : features.axis_parameter;
    continue_contact(indentation, point, s, at_edge, nearest, now[0]);
    return 1;
  }
  for (const int point : {0, 1}) {
    const Contact* from = memory.of_point[point] != nullptr ? memory.of_point[point] : nearest;
    continue_contact(indentation, point, point == 0 ? span.s0 : span.s1, false, from, now[point]);
  }
  share_load(now[0], now[1]);
  return 2;
}

}  // namespace mrhi
