#pragma once

#include <string>

namespace mrhi {

/// Where a package is on the ROS path; empty if there is none, or where this was built without ROS.
std::string package_folder(const std::string& name);

}  // namespace mrhi
