#include "mr_hand_interaction/scene/scene.h"

#include <stdexcept>

namespace mrhi {

std::optional<int> find_body(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  return {};
}

std::vector<std::string> graspable_bodies(const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto body = static_cast<int>(b);
    if (!scene.bodies[b].fixed && floating_root(scene, body).value_or(body) == body)
      names.push_back(scene.bodies[b].name);
  }
  return names;
}

GraspMode grasp_of(const Scene& scene, int body) {
  return scene.bodies[static_cast<std::size_t>(floating_root(scene, body).value_or(body))].grasp;
}

Body& free_body(Scene& scene, const std::string& name) {
  std::string names;
  for (Body& body : scene.bodies) {
    if (body.fixed) continue;
    if (body.name == name) return body;
    names += (names.empty() ? "" : ", ") + body.name;
  }
  throw std::invalid_argument("scene '" + scene.name + "' has no free object '" + name +
                              "'; allowed: " + (names.empty() ? "none" : names));
}

}  // namespace mrhi
