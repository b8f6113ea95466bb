#include "../ros/package_folder.h"

namespace mrhi {

std::string package_folder(const std::string&) {
  return "";
}

}  // namespace mrhi
