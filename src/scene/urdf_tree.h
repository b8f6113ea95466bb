#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "urdf_document.h"

namespace mrhi {

Pose to_pose(const urdf::Pose& pose);

/// Whether it turns or slides.
bool moves(const urdf::Joint& joint);

/// A link below the root and where it is.
struct PlacedLink {
  urdf::LinkConstSharedPtr link;
  bool fixed;     ///< on fixed joints all the way, else it is a body that moves
  Pose in_world;  ///< the link's frame, all joints at 0; the root is the world
};

/// All links but the root, in the URDF's order. Throws SceneError for joints that make no scene.
std::vector<PlacedLink> place_links(const std::string& urdf_file, const UrdfDocument& document);

}  // namespace mrhi
