#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

std::optional<int> find_body(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  return {};
}

}  // namespace mrhi
