#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>
#include <vector>

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

}  // namespace mrhi
