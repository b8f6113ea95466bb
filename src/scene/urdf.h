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

/// What a loader assumed: one line for each kind of assumption, with the things that it concerns.
class Warnings {
 public:
  /// `what` is the line's beginning, `item` a thing and its value.
  void add(const std::string& what, const std::string& item) {
    auto line = std::find_if(lines_.begin(), lines_.end(), [&](const auto& l) { return l.first == what; });
    if (line == lines_.end()) line = lines_.insert(line, {what, {}});
    if (std::find(line->second.begin(), line->second.end(), item) == line->second.end())
      line->second.push_back(item);
  }

  std::vector<std::string> lines() const {
    constexpr std::size_t kNamed = 4;
    std::vector<std::string> all;
    for (const auto& [what, items] : lines_) {
      std::vector<std::string> named(items.begin(), items.begin() + long(std::min(kNamed, items.size())));
      if (items.size() > kNamed) named.push_back("and " + std::to_string(items.size() - kNamed) + " more");
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

/// Rewrites a URDF as people write it: names that topics and frames can have, complete limits and inertias, a
/// world above a root that has a shape, no tags of other programs. What is changed in meaning is a warning.
/// Throws std::runtime_error, whose text goes on from the file's name.
NormalUrdf normal_urdf(const std::string& xml, Warnings& warnings);

/// A URDF as urdfdom reads it once it is normal_urdf(). A root link with a shape hangs on one without.
struct UrdfDocument {
  urdf::ModelInterfaceSharedPtr model;
  std::vector<urdf::LinkConstSharedPtr> links;  ///< in the order of the file (urdfdom sorts by name)
  std::map<std::string, double> friction;       ///< Coulomb's coefficient, of links that have one
  Warnings warnings;
};

/// `source` names the XML in messages. Throws SceneError with urdfdom's complaints on one line; urdfdom
/// itself prints nothing.
UrdfDocument parse_urdf(const std::string& source, const std::string& xml);

Pose to_pose(const urdf::Pose& pose);

/// Throws SceneError that begins with `element` for parts of a colour that are not from 0 to 1.
void check_color(const std::string& element, const std::array<float, 4>& rgba);

/// Whether it turns or slides.
bool moves(const urdf::Joint& joint);

/// A link that is a part of a body, and its place in the frame of the body's first link.
struct LinkPart {
  urdf::LinkConstSharedPtr link;
  Pose pose;
};

/// A body: a link below the root and those that fixed joints hold to it.
struct PlacedLink {
  urdf::LinkConstSharedPtr link;
  bool fixed;                    ///< on fixed joints all the way, or of mass 0; else it moves
  Pose in_world;                 ///< the link's frame, all joints at 0; the root is the world
  std::vector<LinkPart> merged;  ///< not of a fixture, whose links are fixtures themselves
};

bool has_shape(const PlacedLink& placed);

/// All bodies, in the order of their first links in the URDF. Throws SceneError for joints that make no
/// scene.
std::vector<PlacedLink> place_links(const std::string& urdf_file, UrdfDocument& document);

/// The joints that turn or slide of a URDF, in the order of their links, between the scene's bodies, which
/// are known. They begin at 0, or at the limit that is nearest to it. Throws SceneError.
std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene);

/// Turns a URDF's geometry into shapes; each mesh file is read once.
class ShapeReader {
 public:
  /// Paths of meshes start at `folder`.
  ShapeReader(std::string source, std::string folder, const SceneOptions& options, Warnings& warnings)
      : source_(std::move(source)), folder_(std::move(folder)), options_(options), warnings_(warnings) {}

  /// Reads the mesh files of all these links together, which takes less time than one by one.
  void prepare(const std::vector<urdf::LinkConstSharedPtr>& links);

  /// `element` names the place in messages. Throws SceneError. A solid's mesh is closed or its hull; nothing
  /// is returned for one that is a flat sheet.
  std::optional<Shape> read(const urdf::Geometry& geometry, const std::string& element, bool solid);

  const std::vector<SceneFile>& files() const { return files_; }

 private:
  /// A mesh as URDFs name it: which file, how large, and its hull or itself.
  struct Named;
  Named named(const urdf::Mesh& mesh) const;
  std::string find_file(const std::string& uri) const;
  std::string find_path(const std::string& uri) const;
  std::optional<Shape> read_mesh(const urdf::Mesh& mesh, const std::string& element, bool solid);
  std::shared_ptr<const TriangleMesh> solid_of(const Named& mesh, const std::string& element);
  const TriangleMesh& triangles_of(const Named& mesh);
  std::optional<Shape> make(const std::string& kind, const std::vector<double>& size,
                            const std::string& element);
  [[noreturn]] void fail(const std::string& element, const std::string& what) const;

  const std::string source_, folder_;
  const SceneOptions& options_;
  Warnings& warnings_;
  std::map<std::string, LoadedMesh> loaded_;                           // by file and scale
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;  // the same, as they are used
  std::vector<SceneFile> files_;
};

/// The bodies of a URDF in its order, complete but for their materials, which are the default, its joints,
/// and what was assumed. Links without any geometry on fixed joints only place others and are left out.
/// Throws SceneError. `source` names the text in messages; paths of meshes start at `folder`.
void read_urdf(const std::string& source, const std::string& folder, const std::string& xml,
               const SceneOptions& options, Scene& scene);

/// Adds one of them.
void read_body(const std::string& source, const std::string& folder, UrdfDocument& document,
               const PlacedLink& placed, const SceneOptions& options, Scene& scene);

/// The one body with a shape of a URDF, where that has it. Throws SceneError for none and several.
PlacedLink only_body(const std::string& source, UrdfDocument& document);

/// arrange_joints(), which throws SceneError here.
void join_bodies(const std::string& source, Scene& scene);
/// Throws SceneError for bodies that begin inside each other.
void check_overlaps(const std::string& source, Scene& scene);

/// Sets gravity, bounds, materials, twists and joints of a scene whose bodies and joints are known, from its
/// YAML file. A material keeps what the file does not name. Throws SceneError.
void apply_scene_yaml(const std::string& yaml_file, Scene& scene);

/// Sets joints from the text of such a file's entry, likewise.
void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene);

/// Sets a body's material from the text of such a file's entry; `source` names it in messages. Throws
/// SceneError.
void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body);

/// Sets gravity, bounds, materials, twists and joints of a scene whose bodies and joints are known, from its
/// YAML file. A material keeps what the file does not name. Throws SceneError.
void apply_scene_yaml(const std::string& yaml_file, Scene& scene);

/// Sets joints from the text of such a file's entry, likewise.
void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene);

/// Sets a body's material from the text of such a file's entry; `source` names it in messages. Throws
/// SceneError.
void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body);

}  // namespace mrhi
