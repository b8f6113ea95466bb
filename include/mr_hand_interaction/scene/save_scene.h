#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

struct BodyState;
struct JointState;

/// The scene with the present poses and velocities as start values. `bodies`, `joints`: one for each of the
/// scene's. A joint beyond a limit is set to the limit.
Scene scene_as_it_is(const Scene& scene, const std::vector<BodyState>& bodies,
                     const std::vector<JointState>& joints);

/// Writes FILE.urdf, FILE.yaml beside it, and a FILE_N.obj for every collision mesh. load_scene() restores
/// the scene from them, up to rounding. Material values that come from the parameters are not written. Throws
/// std::invalid_argument if the file does not end in .urdf or exists, and std::runtime_error if it cannot be
/// written; each with one line.
void save_scene(const Scene& scene, const std::string& urdf_file);

}  // namespace mrhi
