#include <cmath>
#include <cstdio>
#include <string>

#include "skin_model.h"

namespace {

void write(const std::string& name, const mrhi::TriangleMesh& mesh) {
  std::printf("constexpr Vertex k%sVertices[] = {\n", name.c_str());
  for (const mrhi::Vector3& v : mesh.vertices)
    std::printf("{%ld, %ld, %ld},\n", std::lround(1e6 * v.x()), std::lround(1e6 * v.y()),
                std::lround(1e6 * v.z()));
  std::printf("};\nconstexpr Triangle k%sTriangles[] = {\n", name.c_str());
  for (const auto& t : mesh.triangles) std::printf("{%d, %d, %d},\n", t[0], t[1], t[2]);
  std::printf("};\n");
}

}  // namespace

/// Prints src/rendering/rest_skin.inc.
int main() {
  std::printf("// Made by scripts/make_skin.\n");
  write("Skin", mrhi::modelled_skin(mrhi::kHumanTriangles));
  write("Outline", mrhi::modelled_skin(mrhi::kOutlineTriangles));
  return 0;
}
