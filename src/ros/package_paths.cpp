#include "mr_hand_interaction/ros/package_paths.h"

#ifndef MR_HAND_INTERACTION_WITHOUT_ROS
#include <ros/package.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const char* const kPackage = "mr_hand_interaction";
const std::string kScheme = "package://";

/// Folder of a package on the ROS path; empty if there is none, or in a build without ROS. For an unknown
/// package, roslib would search the path again (24 ms) and print its own messages.
std::string package_folder([[maybe_unused]] const std::string& name) {
#ifdef MR_HAND_INTERACTION_WITHOUT_ROS
  return {};
#else
  std::vector<std::string> known;
  ros::package::getAll(known);
  return std::find(known.begin(), known.end(), name) == known.end() ? "" : ros::package::getPath(name);
#endif
}

std::vector<std::string> folders_of(const char* kind) {
  std::vector<std::string> folders;
  for (const std::string& share : share_folders()) folders.push_back(share + "/config/" + kind);
  return folders;
}

std::string installed_share() {
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);  // PREFIX/lib/PACKAGE/NODE
  if (error) return "";
  return (executable.parent_path().parent_path().parent_path() / "share" / kPackage).string();
}

}  // namespace

std::vector<std::string> share_folders() {
  std::vector<std::string> folders;
  const auto add = [&](const std::string& folder) {
    std::error_code ignored;
    if (!folder.empty() && fs::is_directory(fs::path(folder) / "config", ignored)) folders.push_back(folder);
  };
  add(installed_share());
#ifdef MR_HAND_INTERACTION_SOURCE_DIR
  add(MR_HAND_INTERACTION_SOURCE_DIR);
#endif
  if (folders.empty() && std::getenv("ROS_PACKAGE_PATH") != nullptr) add(package_folder(kPackage));
  return folders;
}

std::vector<std::string> scene_folders() {
  return folders_of("scenes");
}

std::vector<std::string> task_folders() {
  return folders_of("tasks");
}

std::string resolve_package_uri(const std::string& uri) {
  if (uri.compare(0, kScheme.size(), kScheme) != 0) return "";
  const std::size_t slash = uri.find('/', kScheme.size());
  if (slash == std::string::npos) return "";
  const std::string package = uri.substr(kScheme.size(), slash - kScheme.size());
  if (package == kPackage) {
    const std::vector<std::string> folders = share_folders();
    return folders.empty() ? "" : folders.front() + uri.substr(slash);
  }
  const std::string folder = package_folder(package);
  return folder.empty() ? "" : folder + uri.substr(slash);
}

SceneOptions scene_options(const Configuration& configuration) {
  return {default_material(configuration), configuration.gravity, resolve_package_uri, configuration.density};
}

}  // namespace mrhi
