#pragma once

#include <string>

namespace mrhi {

/// Keeps a folder to one program at a time, as long as it lives; however a program ends, its lock ends with
/// it.
class FolderLock {
 public:
  /// Throws SessionError that names the process and machine that has it, or says that it cannot be written.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace mrhi
