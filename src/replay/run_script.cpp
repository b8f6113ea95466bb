#include "run_script.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

/// Beside this program where it is installed, else in the package's scripts.
std::string script_file(const std::string& name) {
  std::error_code error;
  std::vector<fs::path> files{fs::read_symlink("/proc/self/exe", error).parent_path() / name};
  for (const std::string& share : share_folders()) files.push_back(fs::path(share) / "scripts" / name);
  for (const fs::path& file : files)
    if (access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file, error)) return file.string();
  throw std::runtime_error("the script '" + name + "' is not found; allowed: a built or installed package");
}

}  // namespace

int run_script(const std::string& name, const std::vector<std::string>& arguments) {
  const std::string file = script_file(name);
  std::vector<char*> words{const_cast<char*>(file.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_t child = 0;
  const int why = posix_spawn(&child, file.c_str(), nullptr, nullptr, words.data(), environ);
  if (why != 0) throw std::runtime_error("cannot start " + file + ": " + std::strerror(why));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error("cannot wait for " + file + ": " + std::strerror(errno));
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace mrhi
