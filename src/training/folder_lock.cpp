#include "folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "../text/file_text.h"
#include "../text/text.h"
#include "mr_hand_interaction/training/session_folder.h"

namespace mrhi {
namespace {

const char* const kFile = "/session.lock";

/// For who finds the folder locked; nothing hangs on it.
void write_holder(int file) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string text = "process " + std::to_string(getpid()) + " on " + host + "\n";
  if (ftruncate(file, 0) != 0 || write(file, text.data(), text.size()) < 0) return;
}

std::string holder(const std::string& file) {
  const std::string text = text::one_line(file_text(file, 300).value_or(""), 300);
  return text.empty() ? "another process" : text;
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) {
  const std::string file = folder + kFile;
  file_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0644);
  struct stat opened {};
  if (file_ >= 0 && (fstat(file_, &opened) != 0 || !S_ISREG(opened.st_mode))) {
    close(file_);
    throw SessionError(file + ": is no file; allowed: a file, or none yet");
  }
  if (file_ < 0)
    throw SessionError(file + ": cannot be written: " + std::strerror(errno) +
                       "; allowed: a folder to write to with space left");
  if (flock(file_, LOCK_EX | LOCK_NB) == 0) {
    write_holder(file_);
    return;
  }
  const std::string has_it = holder(file);
  close(file_);
  throw SessionError(folder + ": is in use by " + has_it + "; allowed: another folder, or end that first");
}

FolderLock::~FolderLock() {
  close(file_);
}

}  // namespace mrhi
