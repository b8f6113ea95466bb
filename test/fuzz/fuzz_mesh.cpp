// A mesh, and a finger that goes through it. First byte 0 to 2: the rest is a file of one of the kinds;
// others: its triangles, three bytes for a vertex and three for the triangle on the vertices so far.
#include "fuzz/target.h"
#include "scene/solid_mesh.h"
#include "support/fixtures.h"

namespace {

using namespace mrhi;

constexpr std::size_t kMostBytes = 600;

TriangleMesh mesh_of(fuzzing::Bytes& bytes) {
  TriangleMesh mesh;
  const int vertices = 4 + bytes.below(28);
  for (int i = 0; i < vertices; ++i) {
    Vector3 vertex;
    for (int axis = 0; axis < 3; ++axis) vertex[axis] = bytes.between(-0.1, 0.1);
    mesh.vertices.push_back(vertex);
  }
  while (bytes.left()) {
    std::array<int, 3> corners;
    for (int& corner : corners) corner = bytes.below(vertices);
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      mesh.triangles.push_back(corners);
  }
  return mesh;
}

TriangleMesh mesh_of_file(int kind, const std::string& text) {
  static const char* const names[] = {"mesh.stl", "mesh.obj", "mesh.dae"};
  MeshBudget budget;
  LoadedMesh loaded =
      load_meshes({{fuzzing::folder().write(names[kind], text), Vector3::Ones()}}, budget).front();
  if (!loaded.problem.empty()) throw std::runtime_error(loaded.problem);
  return loaded.mesh;
}

void touch(const TriangleMesh& mesh) {
  Body body = mrhi::testing::ball_body(0.1, 0.2);
  body.shapes = {{Mesh{std::make_shared<const TriangleMesh>(mesh), "", Vector3::Ones()}, {}}};
  try {
    complete(body);
  } catch (const std::invalid_argument& error) {
    return fuzzing::require_one_line(error.what());  // a size beyond the limits
  }
  Simulation simulation(mrhi::testing::scene_of(body), mrhi::testing::unfiltered(ContactModelKind::implicit));
  for (int i = 0; i < 12; ++i) {
    const Vector3 tip(-0.12 + 0.02 * i, 0.01, 0.02);
    simulation.advance(
        {mrhi::testing::at(0.01 * i), {mrhi::testing::finger(tip, tip + Vector3(0, 0.03, 0), 0.008)}});
    fuzzing::require(simulation.result().not_finite.empty(), "what comes out is finite");
  }
}

}  // namespace

FUZZ_TARGET(mesh) {
  if (size < 2) return;
  try {
    fuzzing::Bytes bytes(data + 1, std::min(size - 1, kMostBytes));
    TriangleMesh mesh = data[0] < 3 ? mesh_of_file(data[0], {data + 1, data + size}) : mesh_of(bytes);
    make_solid(mesh);
    fuzzing::require(signed_volume(mesh) >= 0.0, "what is solid is turned outward");
    touch(mesh);
  } catch (const std::runtime_error& error) {
    fuzzing::require_one_line(error.what());
  }
}
