#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <dirent.h>

namespace mrhi::testing {

/// Folder of the real hand recordings, which are not part of the package: $MR_HAND_RECORDINGS, else the
/// folder shared/recordings beside the repository. May not exist.
inline std::string recordings_folder() {
  const char* set = std::getenv("MR_HAND_RECORDINGS");
  return set != nullptr && *set != '\0' ? set : "../shared/recordings";
}

/// Paths of all recordings, sorted; empty if there are none here.
inline std::vector<std::string> recordings() {
  std::vector<std::string> files;
  const std::string folder = recordings_folder();
  DIR* directory = opendir(folder.c_str());
  if (directory == nullptr) return files;
  while (const dirent* entry = readdir(directory)) {
    const std::string name = entry->d_name;
    const bool is_csv = name.size() > 4 && name.compare(name.size() - 4, 4, ".csv") == 0;
    if (is_csv && name != "MANIFEST.csv") files.push_back(folder + "/" + name);
  }
  closedir(directory);
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace mrhi::testing

#define MRHI_NEED_RECORDINGS(files)                                                \
  if ((files).empty()) {                                                           \
    GTEST_SKIP() << "no hand recordings in " << mrhi::testing::recordings_folder() \
                 << ": set MR_HAND_RECORDINGS to their folder";                    \
  }
