#include "file_text.h"

#include <algorithm>
#include <filesystem>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "text.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::vector<std::string> known_names(const std::string& extension,
                                     const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
      if (entry.path().extension() == extension && is_file(entry.path()))
        names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace

std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories) {
  const bool is_path = name.find('/') != std::string::npos || fs::path(name).extension() == extension;
  const std::string allowed =
      "; allowed: " + std::string(extension == ".urdf" ? "a URDF" : "a YAML") + " file, or one of ";
  if (is_path) {
    if (is_file(name)) return name;
    throw SceneError(kind + " file '" + name + "' does not exist" + allowed +
                     text::joined(known_names(extension, directories)));
  }
  for (const std::string& directory : directories) {
    const fs::path file = fs::path(directory) / (name + extension);
    if (is_file(file)) return file.string();
  }
  throw SceneError("unknown " + kind + " '" + name + "'" + allowed +
                   text::joined(known_names(extension, directories)));
}

}  // namespace mrhi
