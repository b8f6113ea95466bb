#include "remove_body.h"

namespace mrhi {

void remove_body(std::size_t body, Scene& scene) {
  scene.bodies.erase(scene.bodies.begin() + static_cast<std::ptrdiff_t>(body));
  for (Joint& joint : scene.joints) {
    if (joint.parent > static_cast<int>(body)) --joint.parent;
    if (joint.child > static_cast<int>(body)) --joint.child;
  }
}

}  // namespace mrhi
