#include "package_folder.h"

#include <ros/package.h>

namespace mrhi {

std::string package_folder(const std::string& name) {
  return ros::package::getPath(name);
}

}  // namespace mrhi
