#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// An object that somebody wants in a scene.
struct ObjectRequest {
  std::string name;  ///< empty: that of the URDF's link
  /// XML with one link that has a shape, or the path or package:// of a file of it; empty: `shape` instead.
  std::string urdf;
  std::string folder;        ///< where paths of meshes in the XML start
  std::string shape;         ///< box, sphere, or cylinder (about z)
  std::vector<double> size;  ///< box: x, y, z; sphere: radius; cylinder: radius, length [m]
  double mass = 0.0;         ///< of `shape`, which is solid [kg]; 0: a fixture
  Pose pose;                 ///< of the link in world
  Twist twist;               ///< of the centre of mass, world axes
  std::string material;      ///< YAML, as in a scene's materials; empty: the parameters'
  std::optional<std::array<float, 4>> rgba;
  /// All links of the URDF, with their joints; `name` and '_' come before the names of links and joints then,
  /// and of the rest only `urdf` and `pose`, of the URDF's root, count.
  bool whole = false;
  std::string joints;  ///< of `whole`: YAML, as in a scene's joints; empty: as the URDF has them
};

/// The request with the text of the file that its `urdf` names, and that file's folder; the request itself if
/// that is no path. Throws SceneError.
ObjectRequest with_file_read(ObjectRequest request, const SceneOptions& options);

/// Throws SceneError with one line that says what is wrong and what is allowed. A link of the URDF on a fixed
/// joint is a fixture.
Body requested_body(const ObjectRequest& request, const SceneOptions& options);

/// What is to be added to a scene: that body, or all of a URDF that is wanted whole. Throws likewise.
Scene requested_scene(const ObjectRequest& request, const SceneOptions& options);

}  // namespace mrhi
