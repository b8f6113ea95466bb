#pragma once

#include <stdlib.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace mrhi {

/// A temporary folder that is removed with its contents at the end.
class ScratchFolder {
 public:
  /// `name`: of the program, for who finds the folder. Throws std::runtime_error if it cannot be made.
  explicit ScratchFolder(const std::string& name)
      : path_((std::filesystem::temp_directory_path() / (name + "_XXXXXX")).string()) {
    if (mkdtemp(&path_[0]) == nullptr) throw std::runtime_error("cannot make a folder " + path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace mrhi
