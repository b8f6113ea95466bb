#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "urdf_tree.h"

namespace mrhi {

/// The bodies of a URDF in its order, complete but for their materials, which are the default, and its
/// joints. Links without any geometry on fixed joints only place others and are left out. Throws SceneError.
void read_urdf(const std::string& urdf_file, const SceneOptions& options, Scene& scene);

/// The same of a URDF's text, which `source` names in messages.
void read_urdf_text(const std::string& source, const std::string& xml, const SceneOptions& options,
                    Scene& scene);

/// One of them; `source` names it in messages.
Body read_body(const std::string& source, const PlacedLink& placed, const SceneOptions& options);

/// The one link with a shape of a URDF's text, where that has it. Throws SceneError for none and several.
PlacedLink only_link(const std::string& source, const std::string& xml);

}  // namespace mrhi
