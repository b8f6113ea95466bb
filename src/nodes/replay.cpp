#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "../text/command_line.h"
#include "../text/text.h"
#include "exit_status.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

/// Next to this program if installed, else in the package's scripts.
std::string script_file(const std::string& name) {
  std::error_code error;
  std::vector<fs::path> files{fs::read_symlink("/proc/self/exe", error).parent_path() / name};
  for (const std::string& share : share_folders()) files.push_back(fs::path(share) / "scripts" / name);
  for (const fs::path& file : files)
    if (access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file, error)) return file.string();
  throw std::runtime_error("the script '" + name + "' is not found; allowed: a built or installed package");
}

/// Runs a script of this package without a shell, and waits for it. Returns its exit status.
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

/// Runs the scripts that use the tables. Returns the first exit status that is not 0.
int report(const ReplayArguments& arguments) {
  int status = 0;
  if (arguments.export_rate) {
    const std::string rate = text::number(*arguments.export_rate);
    status = run_script("export", {arguments.output, "--rate", rate});
  }
  if (status == 0 && !arguments.film.empty())
    status = run_script("film.py", {"--bag", arguments.output + "/markers.bag", "--output", arguments.film});
  if (status == 0 && arguments.explain) status = run_script("explain", {arguments.output, "--no-pictures"});
  return status;
}

/// Becomes web.launch, which ends by Ctrl-C.
[[noreturn]] void serve(const std::string& bag) {
  const std::string argument = "bag:=" + fs::absolute(bag).string();
  execlp("roslaunch", "roslaunch", "mr_hand_interaction", "web.launch", "hands:=bag", argument.c_str(),
         nullptr);
  throw std::runtime_error(std::string("cannot start roslaunch: ") + std::strerror(errno) +
                           "; allowed: a terminal in which ROS is set up");
}

}  // namespace
}  // namespace mrhi

int main(int argc, char** argv) {
  return mrhi::exit_status("replay", [&] {
    const mrhi::ReplayArguments arguments = mrhi::parse_replay_arguments({argv + 1, argv + argc});
    if (arguments.help) {
      std::cout << mrhi::replay_help();
      return 0;
    }
    if (!arguments.compare.empty()) return mrhi::run_script("compare", arguments.compare);
    mrhi::replay(arguments);
    const int status = mrhi::report(arguments);
    if (status == 0 && arguments.serve) mrhi::serve(arguments.output + "/markers.bag");
    return status;
  });
}
