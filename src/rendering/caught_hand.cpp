#include <algorithm>
#include <limits>

#include "renderer.h"

namespace mrhi {

/// The clearances contradict each other: the hand as it is goes as a whole to that side of the deepest body
/// which is the nearest. For a side with the normal n and height h the hand's deepest capsule is at
/// min n.a - r - h < 0, and the hand is out by as much along n.
void HandRenderer::Impl::shift_out(const ClearanceFinder::Setting& setting, HandOffset& offset,
                                   Hand& placed) {
  constexpr int kMaxBodies = 4;
  for (int attempt = 0; attempt < kMaxBodies; ++attempt) {
    const auto deepest =
        std::min_element(clearances.begin(), clearances.end(),
                         [](const Clearance& a, const Clearance& b) { return a.gap < b.gap; });
    Vector3 way = Vector3::Zero();
    double least = std::numeric_limits<double>::max();
    for (const Clearance& side : clearances) {
      if (side.key.body != deepest->key.body || side.key.shape != deepest->key.shape) continue;
      double reach = std::numeric_limits<double>::max();
      for (const Capsule& capsule : placed.capsules) {
        if (capsule.radius <= 0.0) continue;
        const double lowest = std::min(side.normal.dot(capsule.start), side.normal.dot(capsule.end));
        reach = std::min(reach, lowest - capsule.radius - side.height);
      }
      if (-reach >= least) continue;
      least = -reach;
      way = -reach * side.normal;
    }
    offset.shift += way;
    chain.place(offset, placed);
    clearances.clear();
    if (finder.find(placed, setting, kAhead, clearances) > -kTolerated) return;
  }
  lead_out(setting, offset, placed);
}

/// Leads the hand as it is out along that of its palm's axes on which it is out the soonest. No step is
/// longer than what is left of the way out. Sphere tracing (Hart 1996): with a gap of -d the hand cannot be
/// out before it has gone d, so that a step of d passes over no way out; near the surface kShortestStep gets
/// it on.
void HandRenderer::Impl::lead_out(const ClearanceFinder::Setting& setting, HandOffset& offset, Hand& placed) {
  constexpr double kFarthestOut = 0.5;      // [m]
  constexpr double kShortestStep = 0.0005;  // [m]
  finder.begin(setting, offset.shift.norm() + kFarthestOut);
  const Matrix3 palm = setting.tracked.palm.orientation.toRotationMatrix();
  double nearest = kFarthestOut;
  const Vector3 from = offset.shift;
  Vector3 out = from;
  for (int direction = 0; direction < 6; ++direction) {
    const Vector3 way = (direction < 3 ? 1.0 : -1.0) * palm.col(direction % 3);
    for (double gone = 0.0; gone < nearest;) {
      offset.shift = from + gone * way;
      chain.place(offset, placed);
      clearances.clear();
      const double least = finder.find(placed, setting, kAhead, clearances);
      if (least > -kTolerated) {
        nearest = gone;
        out = offset.shift;
      }
      gone += std::max(-least, kShortestStep);
    }
  }
  offset.shift = out;
  chain.place(offset, placed);
}

}  // namespace mrhi
