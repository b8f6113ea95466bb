#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// The bodies of a URDF in its order, complete but for their materials, which are the default. Links without
/// any geometry on fixed joints only place others and are left out. Throws SceneError.
std::vector<Body> read_bodies(const std::string& urdf_file, const SceneOptions& options);

}  // namespace mrhi
