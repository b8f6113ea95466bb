#include "mr_hand_interaction/collision/body_box.h"

#include <limits>

namespace mrhi {
namespace {

struct Extent {
  Vector3 min = Vector3::Constant(std::numeric_limits<double>::max());
  Vector3 max = -min;

  void add(const Vector3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
};

struct AddShape {
  Extent& extent;
  const Pose& pose;

  void operator()(const Sphere& sphere) const { add_half(Vector3::Constant(sphere.radius)); }
  void operator()(const Box& box) const { add_turned(box.half_extents); }
  void operator()(const Cylinder& cylinder) const {
    add_turned(Vector3(cylinder.radius, cylinder.radius, cylinder.half_length));
  }
  void operator()(const Mesh& mesh) const {
    for (const Vector3& vertex : mesh.triangles->vertices) extent.add(pose * vertex);
  }

 private:
  void add_turned(const Vector3& half) const {
    add_half(pose.orientation.toRotationMatrix().cwiseAbs() * half);
  }
  void add_half(const Vector3& half) const {
    extent.add(pose.position - half);
    extent.add(pose.position + half);
  }
};

}  // namespace

BodyBox box_around(const Body& body) {
  if (body.shapes.empty()) return {};
  Extent extent;
  for (const PlacedShape& placed : body.shapes) std::visit(AddShape{extent, placed.pose}, placed.shape);
  return {0.5 * (extent.min + extent.max), 0.5 * (extent.max - extent.min)};
}

}  // namespace mrhi
