#include "rest_skin.h"

#include <cstdint>

namespace mrhi {
namespace {

constexpr double kUnit = 1e-6;  // of the vertices below [m]

struct Vertex {
  std::int32_t x, y, z;
};

struct Triangle {
  std::uint16_t a, b, c;
};

#include "rest_skin.inc"

template <std::size_t Vertices, std::size_t Triangles>
TriangleMesh mesh(const Vertex (&vertices)[Vertices], const Triangle (&triangles)[Triangles]) {
  TriangleMesh result;
  for (const Vertex& v : vertices) result.vertices.push_back(kUnit * Vector3(v.x, v.y, v.z));
  for (const Triangle& t : triangles) result.triangles.push_back({t.a, t.b, t.c});
  return result;
}

}  // namespace

TriangleMesh rest_skin() {
  return mesh(kSkinVertices, kSkinTriangles);
}

TriangleMesh rest_outline() {
  return mesh(kOutlineVertices, kOutlineTriangles);
}

}  // namespace mrhi
