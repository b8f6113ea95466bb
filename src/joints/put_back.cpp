#include "put_back.h"

#include <algorithm>

#include "joint_law.h"
#include "linkage.h"

namespace mrhi {

void put_back(std::size_t body, const Scene& scene, SimulationState& state) {
  place(body, start_state(scene.bodies[body]), state);
  if (scene.bodies[body].flies) return;
  for (const Linkage& linkage : linkages_of(scene)) {
    const auto is_it = [body](const LinkageBody& link) { return link.body == static_cast<int>(body); };
    if (std::none_of(linkage.bodies.begin(), linkage.bodies.end(), is_it)) continue;
    for (const LinkageBody& link : linkage.bodies) {
      const auto b = static_cast<std::size_t>(link.body);
      if (b != body) place(b, start_state(scene.bodies[b]), state);
      if (link.joint == LinkageBody::kNone) continue;
      const auto j = static_cast<std::size_t>(link.joint);
      state.joints[j] = start_state(scene.joints[j]);
    }
  }
}

}  // namespace mrhi
