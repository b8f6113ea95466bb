#pragma once

#include <urdf_model/link.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// A URDF as urdfdom reads it.
struct UrdfDocument {
  urdf::ModelInterfaceSharedPtr model;
  std::vector<urdf::LinkConstSharedPtr> links;  ///< in the order of the file (urdfdom sorts by name)
};

/// Throws SceneError with urdfdom's complaints on one line; urdfdom itself prints nothing.
UrdfDocument parse_urdf_file(const std::string& file);

/// The same from the XML itself; `source` names it in messages.
UrdfDocument parse_urdf(const std::string& source, const std::string& xml);

Pose to_pose(const urdf::Pose& pose);

/// Throws SceneError that begins with `element` for parts of a colour that are not from 0 to 1.
void check_color(const std::string& element, const std::array<float, 4>& rgba);

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

/// The joints that turn or slide of a URDF, in the order of their links, between the scene's bodies, which
/// are known. They begin at 0, or at the limit that is nearest to it. Throws SceneError.
std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene);

/// Turns a URDF's geometry into shapes; each mesh file is read once.
class ShapeReader {
 public:
  ShapeReader(std::string urdf_file, const SceneOptions& options)
      : urdf_file_(std::move(urdf_file)), options_(options) {}

  /// `element` names the place in messages. A solid's mesh must be closed. Throws SceneError.
  Shape read(const urdf::Geometry& geometry, const std::string& element, bool solid);

 private:
  Mesh read_mesh(const urdf::Mesh& mesh, const std::string& element, bool solid);
  std::string mesh_file(const std::string& uri, const std::string& element) const;
  Shape make(const std::string& kind, const std::vector<double>& size, const std::string& element) const;
  [[noreturn]] void fail(const std::string& element, const std::string& what) const;

  std::string urdf_file_;
  const SceneOptions& options_;
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;
};

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
