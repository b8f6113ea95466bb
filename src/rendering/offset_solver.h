#pragma once

#include <vector>

#include "finger_chain.h"
#include "mr_hand_interaction/collision/contact.h"

namespace mrhi {

/// A point of a capsule's axis that must keep off a plane by the capsule's radius. gap = normal.a(s) - height
/// - radius, with normal.x = height the plane: linear in the axis's point a(s).
struct Clearance {
  ContactKey key{};                   ///< the capsule, the shape, and which end of a stretch that lies flat
  double s = 0.0;                     ///< axis parameter of the point
  Vector3 normal = Vector3::UnitZ();  ///< of the plane, out of the shape
  double height = 0.0;                ///< of the plane along its normal [m]
  double gap = 0.0;                   ///< as the hand is placed; < 0 is too deep [m]

  // How the gap changes with the offset, and what keeps it from closing.
  Eigen::Array4d by_shift = Eigen::Array4d::Zero();  ///< 3 and 0
  FingerOffset by_finger = FingerOffset::Zero();
  double rest = 0.0;      ///< gap at offset 0, linearised [m]
  double pressure = 0.0;  ///< Lagrange multiplier, >= 0
};

/// How far joints may go from where they were in the frame before: a fingertip no farther than `swing` [m].
struct OffsetBounds {
  const HandOffset& before;
  double swing;
};

/// The offset nearest to `reference`, measured by how readily things give way, that keeps all gaps at 0 or
/// more and all joints in their limits:
///   minimise 1/2 (q - q0)' W (q - q0)  subject to  gap + J (q - qk) >= 0,  lower <= q <= upper,
/// linearised where the hand is placed now (qk, in `offset`). Dual coordinate ascent (Hildreth 1957), with
/// the limits by clamping. Pressures are where it starts and are left as found. A joint goes at most a
/// quarter of a radian from where it is. Returns the least gap then, linearised [m].
double solve_offset(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                    std::vector<Clearance>& clearances, HandOffset& offset);

}  // namespace mrhi
