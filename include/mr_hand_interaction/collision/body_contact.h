#pragma once

#include <cstdint>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Key of the touching surfaces of two bodies. Ordered, so that contacts are always processed in the same
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

/// One touch of body a, which has the hand's part, with the free body b. World frame unless said otherwise;
/// n points from b to a; impulse and force act on b, their opposites on a.
struct BodyContact {
  BodyContactKey key{};

  // Memory: lasts while the surfaces touch.
  Vector3 anchor_a = Vector3::Zero();  ///< point of a, body frame, that sticks to
  Vector3 anchor_b = Vector3::Zero();  ///< this point of b, body frame
  Friction friction = Friction::sticking;
  bool struck = false;  ///< the impact of this approach is over
  double still = 0.0;   ///< time for which both bodies have been still [s]

  // This step.
  Vector3 point = Vector3::Zero();    ///< midway between the surfaces, where they touch or will touch
  Vector3 normal = Vector3::UnitZ();  ///< n
  Vector3 arm_a = Vector3::Zero();    ///< from the centre of a to the point
  Vector3 arm_b = Vector3::Zero();    ///< from the centre of b to the point
  /// Offset from the point to where friction acts, along the surface: the friction of a spinning face acts on
  /// all its points, which are nearer to its centre than its corners [m].
  Vector3 friction_offset = Vector3::Zero();
  Vector3 stretch = Vector3::Zero();  ///< anchor a less anchor b, across n [m]
  Material material;                  ///< of the two together
  double depth = 0.0;                 ///< > 0 overlap, < 0 gap [m]
  double share = 1.0;                 ///< of the pair's stiffness; the shares of its points sum to 1
  double first_touch = -1.0;          ///< of a pair still apart: from the step's start [s], >= 0

  // Results of the response in this step.
  Vector3 force = Vector3::Zero();    ///< also the warm start of the next step [N]
  Vector3 impulse = Vector3::Zero();  ///< of an impact [N s]
};

}  // namespace mrhi
