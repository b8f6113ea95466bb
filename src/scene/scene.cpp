#include "mr_hand_interaction/scene/scene.h"

#include <stdexcept>

namespace mrhi {

std::optional<int> find_body(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  return {};
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
