#include "mr_hand_interaction/collision/closest_features.h"
#include "segment.h"

namespace mrhi {
namespace {

/// Normals that differ by less than this are the same [rad].
constexpr double kSameNormal = 1e-6;
/// A capsule that crosses a cylinder's lines at this angle touches at a point; along them, in a line [rad].
constexpr double kCrosses = 0.1;

/// Part of the axis over the face or side whose normal the features have.
struct FlatPart {
  const Segment& axis;
  const ClosestFeatures& features;

  AxisSpan at_point() const { return {features.axis_parameter, features.axis_parameter}; }
  AxisSpan at_edge() const { return {features.axis_parameter, features.axis_parameter, true}; }
  AxisSpan over(const Stretch& stretch) const {
    return {std::min(std::max(stretch.s0, 0.0), features.axis_parameter),
            std::max(std::min(stretch.s1, 1.0), features.axis_parameter)};
  }

  AxisSpan operator()(const Sphere&) const { return at_point(); }
  AxisSpan operator()(const Mesh&) const { return at_point(); }
  AxisSpan operator()(const Box& box) const {
    int across = 0;
    Stretch stretch;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(features.normal[i]) > kSameNormal) {
        ++across;
      } else {
        stretch.clip_to_slab(axis.start[i], axis.along[i], box.half_extents[i]);
      }
    }
    if (across != 1) return at_edge();
    return over(stretch);
  }
  AxisSpan operator()(const Cylinder& cylinder) const {
    Stretch stretch;
    if (features.normal.head<2>().norm() <= kSameNormal) {
      stretch.clip_to_disc(axis, cylinder.radius);
      return over(stretch);
    }
    if (std::abs(features.normal.z()) > kSameNormal) return at_edge();
    stretch.clip_to_slab(axis.start.z(), axis.along.z(), cylinder.half_length);
    const AxisSpan beside = over(stretch);
    // The line of touch shrinks to a point while the capsule turns across the side.
    const double across = std::abs(Vector3::UnitZ().cross(features.normal).dot(axis.along));
    const double part = std::max(0.0, 1.0 - across / (kCrosses * axis.along.norm()));
    const double s = features.axis_parameter;
    return {s + part * (beside.s0 - s), s + part * (beside.s1 - s)};
  }
};

}  // namespace

AxisSpan contact_span(const Capsule& capsule, const Shape& shape, const ClosestFeatures& features) {
  const Segment axis(capsule);
  const FlatPart part{axis, features};
  if (axis.along.isZero(0.0)) return part.at_point();
  return std::visit(part, shape);
}

}  // namespace mrhi
