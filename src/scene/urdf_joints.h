#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"
#include "urdf_document.h"

namespace mrhi {

/// The joints that turn or slide of a URDF, in the order of their links, between the scene's bodies, which
/// are known. They begin at 0, or at the limit that is nearest to it. Throws SceneError.
std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene);

}  // namespace mrhi
