#pragma once

#include <cstdint>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Identifies the touching surfaces of two bodies. Ordered, so that contacts are always processed in the same
/// order.
struct BodyContactKey {
  std::uint16_t a;       ///< index in Scene::bodies: a fixture, or a free body listed before b
  std::uint16_t b;       ///< a free body
  std::uint8_t shape_a;  ///< of a
  std::uint8_t shape_b;  ///< of b
  std::uint8_t feature;  ///< ManifoldPoint::feature
  std::uint64_t order() const {
    return (std::uint64_t(a) << 40) | (std::uint64_t(b) << 24) | (std::uint64_t(shape_a) << 16) |
           (std::uint64_t(shape_b) << 8) | std::uint64_t(feature);
  }
  friend bool operator<(const BodyContactKey& x, const BodyContactKey& y) { return x.order() < y.order(); }
  friend bool operator==(const BodyContactKey& x, const BodyContactKey& y) { return x.order() == y.order(); }
};

/// Part of a contact between bodies that persists while the surfaces touch.
struct BodyContactMemory {
  BodyContactKey key{};
  Friction friction = Friction::sticking;
  bool struck = false;                 ///< the impulse of this approach has been applied
  double still = 0.0;                  ///< time for which both bodies have been nearly at rest [s]
  double depth = 0.0;                  ///< > 0 overlap, < 0 gap [m]
  Vector3 anchor_a = Vector3::Zero();  ///< anchor of friction on a, body frame
  Vector3 anchor_b = Vector3::Zero();  ///< anchor of friction on b, body frame
  Vector3 force = Vector3::Zero();     ///< of the last step [N]
};

/// A contact of body a, in the hand's role, with the free body b: what persists, the geometry in this step,
/// and the response. World frame unless noted; n points from b to a; impulse and force act on b, their
/// opposites on a.
struct BodyContact : BodyContactMemory {
  Vector3 point = Vector3::Zero();    ///< midway between the surfaces at first touch
  Vector3 normal = Vector3::UnitZ();  ///< n
  Vector3 arm_a = Vector3::Zero();    ///< from the centre of a to the point
  Vector3 arm_b = Vector3::Zero();    ///< from the centre of b to the point
  /// From the point to the point of action of friction, along the surface [m]. Friction of a spinning face
  /// acts over all its area, nearer to the centre than the corners.
  Vector3 friction_offset = Vector3::Zero();
  Vector3 stretch = Vector3::Zero();  ///< anchor a minus anchor b, perpendicular to n [m]
  Material material;                  ///< combined from both bodies
  double share = 1.0;                 ///< of the pair's stiffness; the shares of a pair's points sum to 1
  /// Of a separated pair, from the start of the step [s]; point, arms and depth are those then. < 0: none.
  double first_touch = -1.0;
  Vector3 impulse = Vector3::Zero();  ///< of an impact [N s]
};

}  // namespace mrhi
