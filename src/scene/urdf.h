#pragma once

#include <urdf_model/link.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../text/text.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "solid_mesh.h"

namespace mrhi {

/// Assumptions of a loader: one line for each kind, with the items that it concerns.
class Warnings {
 public:
  /// `what`: the beginning of the line; `item`: a name and its value.
  void add(const std::string& what, const std::string& item) {
    auto line = std::find_if(lines_.begin(), lines_.end(), [&](const auto& l) { return l.first == what; });
    if (line == lines_.end()) line = lines_.insert(line, {what, {}});
    if (std::find(line->second.begin(), line->second.end(), item) == line->second.end())
      line->second.push_back(item);
  }

  std::vector<std::string> lines() const {
    constexpr std::size_t kMaxNamedItems = 4;
    std::vector<std::string> all;
    for (const auto& [what, items] : lines_) {
      std::vector<std::string> named(items.begin(),
                                     items.begin() + long(std::min(kMaxNamedItems, items.size())));
      if (items.size() > kMaxNamedItems)
        named.push_back("and " + std::to_string(items.size() - kMaxNamedItems) + " more");
      all.push_back(text::one_line(what + ": " + text::joined(named), 600));
    }
    return all;
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> lines_;
};

/// A URDF in the form that urdfdom reads.
struct NormalUrdf {
  std::string xml;
  std::vector<std::string> links;          ///< names, in the order of the file
  std::map<std::string, double> friction;  ///< Coulomb's coefficient, by link: <lateral_friction>, <mu1>
};

/// Rewrites a URDF in the form that urdfdom reads: valid names, complete limits and inertias, a world above a
/// root that has a shape, no tags of other programs. A change of meaning causes a warning. Throws
/// std::runtime_error, whose text continues a message after the file's name.
NormalUrdf normal_urdf(const std::string& xml, Warnings& warnings);

/// A parsed URDF. Its root link has no shape.
struct UrdfDocument {
  urdf::ModelInterfaceSharedPtr model;
  std::vector<urdf::LinkConstSharedPtr> links;  ///< in the order of the file (urdfdom sorts by name)
  std::map<std::string, double> friction;       ///< Coulomb's coefficient, of links that have one
  Warnings warnings;
};

/// Parses a URDF. `source` names it in messages. Throws SceneError with urdfdom's messages on one line;
/// urdfdom itself prints nothing.
UrdfDocument parse_urdf(const std::string& source, const std::string& xml);

Pose to_pose(const urdf::Pose& pose);

/// Throws SceneError that begins with `element` for a component of a colour outside 0 to 1.
void check_color(const std::string& element, const std::array<float, 4>& rgba);

/// True if the link is on a joint that is revolute, continuous or prismatic. A requested link has no joint.
bool moves(const urdf::Link& link);

/// A link that is a part of a body, and its pose in the frame of the body's first link.
struct LinkPart {
  urdf::LinkConstSharedPtr link;
  Pose pose;
};

/// A body: a link below the root, and those that fixed joints connect to it. Each link of a fixture is a
/// body.
struct LinkedBody {
  std::vector<LinkPart> parts;  ///< at least one
  bool fixed;                   ///< connected to the root by fixed joints only, or of mass 0
  Pose in_world;  ///< pose of the first link's frame with all joints at 0; the root is the world

  const urdf::Link& link() const { return *parts.front().link; }
  bool has_shape() const;
};

/// All bodies, in the order of their first links in the URDF. Throws SceneError for joints of a kind that a
/// scene cannot have.
std::vector<LinkedBody> linked_bodies(const std::string& urdf_file, UrdfDocument& document);

/// The moving joints of a URDF between the bodies of the scene, in the order of their links. They start at 0,
/// or at the limit nearest to it. Throws SceneError.
std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene);

/// Converts a URDF's geometry to shapes; reads each mesh file once.
class ShapeReader {
 public:
  /// `folder`: base of relative mesh paths.
  ShapeReader(std::string source, std::string folder, const SceneOptions& options, Warnings& warnings)
      : source_(std::move(source)), folder_(std::move(folder)), options_(options), warnings_(warnings) {}

  /// Reads the mesh files of all these bodies together, which is faster than one by one.
  void prepare(const std::vector<LinkedBody>& bodies);

  /// `element` names the place in messages. With `solid`, the mesh is closed or becomes its hull. Returns
  /// nothing for a flat sheet. Throws SceneError.
  std::optional<Shape> read(const urdf::Geometry& geometry, const std::string& element, bool solid);

  const std::vector<SceneFile>& files() const { return files_; }

 private:
  /// A mesh as a URDF names it: file, scale, and whether its hull is used.
  struct Named;
  Named named(const urdf::Mesh& mesh) const;
  std::string find_file(const std::string& uri) const;
  std::string find_path(const std::string& uri) const;
  std::optional<Shape> read_mesh(const urdf::Mesh& mesh, const std::string& element, bool solid);
  std::vector<LoadedMesh> load(const std::vector<MeshFile>& files);
  std::shared_ptr<const TriangleMesh> triangles_of(const Named& mesh, bool solid, const std::string& element);
  std::optional<Shape> make(const std::string& kind, const std::vector<double>& size,
                            const std::string& element);
  [[noreturn]] void fail(const std::string& element, const std::string& what) const;

  const std::string source_, folder_;
  const SceneOptions& options_;
  Warnings& warnings_;
  MeshBudget budget_;
  std::map<std::string, LoadedMesh> loaded_;                           // by file, scale and use
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;  // the same, as shapes use them
  std::vector<SceneFile> files_;
};

/// Reads the bodies of a URDF in its order, its joints, and the assumptions made. Materials are the default.
/// Links without geometry on fixed joints only place other links, and are left out. `source` names the text
/// in messages; `folder`: base of relative mesh paths. Throws SceneError.
void read_urdf(const std::string& source, const std::string& folder, const std::string& xml,
               const SceneOptions& options, Scene& scene);

/// Adds one body of a URDF to the scene, likewise.
void read_body(const std::string& source, const std::string& folder, UrdfDocument& document,
               const LinkedBody& linked, const SceneOptions& options, Scene& scene);

/// The only body of a URDF that has a shape. Throws SceneError if there are none or several.
LinkedBody only_body(const std::string& source, UrdfDocument& document);

/// Calls arrange_joints(), but throws SceneError.
void join_bodies(const std::string& source, Scene& scene);
/// Throws SceneError for bodies that overlap at the start by more than is allowed; parts the others.
void check_overlaps(const std::string& source, Scene& scene);

/// Sets gravity, bounds, materials, twists, joints and operators of a scene from its YAML file. Properties
/// that the file does not name stay as they are. Throws SceneError.
void apply_scene_yaml(const std::string& yaml_file, Scene& scene);

/// Sets joints from the text of the entry `joints` of such a file. Throws SceneError.
void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene);

/// Sets a body's material from the text of an entry of `materials`; `source` names it in messages. Throws
/// SceneError.
void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body);

}  // namespace mrhi
