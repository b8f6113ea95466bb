#include "scene_geometry.h"

namespace mrhi {

SceneGeometry::SceneGeometry(const Scene& scene)
    : meshes(scene.bodies.size()), shapes(scene.bodies.size()), colliders(scene.bodies.size()) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (const PlacedShape& placed : scene.bodies[b].shapes) {
      const Mesh* mesh = std::get_if<Mesh>(&placed.shape);
      meshes[b].push_back(mesh != nullptr ? shared_collider(mesh->triangles) : nullptr);
      shapes[b].emplace_back(placed.shape, meshes[b].back().get());
      colliders[b].emplace_back(placed, meshes[b].back().get());
    }
  }
}

}  // namespace mrhi
