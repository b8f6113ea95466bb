#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// A scene with everything where it is now, and as fast: what is loaded from its files begins there.
/// `bodies`, `joints`: one for each of the scene's. A joint beyond a limit is put at it.
Scene scene_as_it_is(const Scene& scene, const std::vector<BodyState>& bodies,
                     const std::vector<JointState>& joints);

/// Writes FILE.urdf, FILE.yaml beside it, and a FILE_N.obj for every mesh that collides: what load_scene()
/// makes of them is the scene, to rounding. Numbers that the parameters give, of materials, are not in them.
/// Throws std::invalid_argument for a file that does not end in .urdf or is there already, and
/// std::runtime_error for one that cannot be written; each with one line.
void save_scene(const Scene& scene, const std::string& urdf_file);

}  // namespace mrhi
