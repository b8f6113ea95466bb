#pragma once

#include <urdf_model/link.h>

#include <map>
#include <memory>
#include <string>

#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

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

}  // namespace mrhi
