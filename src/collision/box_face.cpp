#include "box_face.h"

namespace mrhi {

BoxFace::BoxFace(const OrientedBox& box, const Vector3& outward) {
  const Vector3 local = box.axes.transpose() * outward;
  int face;
  local.cwiseAbs().maxCoeff(&face);
  const int first = (face + 1) % 3, second = (face + 2) % 3;
  const bool positive = local[face] >= 0.0;
  normal = (positive ? 1.0 : -1.0) * box.axes.col(face);
  centre = box.centre + box.half[face] * normal;
  along = {{box.axes.col(first), box.axes.col(second)}};
  half = {{box.half[first], box.half[second]}};
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] =
        (int(positive) << face) | (int(kCorner[i][0] > 0) << first) | (int(kCorner[i][1] > 0) << second);
    edges[i] = edge_name(i % 2 == 0 ? first : second, corners[i]);
  }
}

}  // namespace mrhi
