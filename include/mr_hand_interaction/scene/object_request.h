#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// A request to add an object to a scene.
struct ObjectRequest {
  std::string name;  ///< empty: that of the URDF's link
  /// XML of one link with a shape, or the path or package:// of such a file; empty: `shape` instead.
  std::string urdf;
  std::string folder;        ///< base of relative mesh paths in the XML
  std::string shape;         ///< box, sphere, or cylinder (about z)
  std::vector<double> size;  ///< box: x, y, z; sphere: radius; cylinder: radius, length [m]
  double mass = 0.0;         ///< of `shape`, which is solid [kg]; 0: a fixture
  Pose pose;                 ///< of the link in world
  Twist twist;               ///< of the centre of mass, world axes
  std::string material;      ///< YAML, as in a scene's materials; empty: the parameters'
  std::optional<std::array<float, 4>> rgba;
  /// Adds all links of the URDF, with their joints. `name` and '_' are then prefixed to the names of links
  /// and joints. Otherwise only `urdf` and `pose`, of the URDF's root, are used.
  bool whole = false;
  std::string joints;  ///< for `whole`: YAML, as in a scene's joints; empty: as in the URDF
};

/// The request with the text of the file that `urdf` names, and its folder; the request itself if `urdf` is
/// no path. Throws SceneError.
ObjectRequest with_file_read(ObjectRequest request, const SceneOptions& options);

/// The requested body. Throws SceneError with one line that states what is wrong and what is allowed. A link
/// of the URDF on a fixed joint is a fixture.
Body requested_body(const ObjectRequest& request, const SceneOptions& options);

/// The requested body, or the whole URDF, as a scene to be appended. Throws SceneError likewise.
Scene requested_scene(const ObjectRequest& request, const SceneOptions& options);

}  // namespace mrhi
