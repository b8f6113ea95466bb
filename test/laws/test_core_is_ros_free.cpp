#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace {

namespace fs = std::filesystem;

const char* const kRosFolders[] = {"record", "ros", "nodes", "replay", "without_ros"};

std::vector<std::string> lines_of(const std::string& command) {
  std::vector<std::string> lines;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return lines;
  std::string line;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    lines.push_back(line);
    line.clear();
  }
  pclose(pipe);
  return lines;
}

/// Where this process has the core library loaded from.
std::string core_library() {
  const mrhi::SimulationState used;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const auto path = line.find('/');
    if (path != std::string::npos && line.find("libmr_hand_interaction_core.") != std::string::npos)
      return line.substr(path);
  }
  return {};
}

bool in_ros_folder(const fs::path& file, const fs::path& root) {
  const std::string first = fs::relative(file, root).begin()->string();
  for (const char* folder : kRosFolders) {
    if (first == folder) return true;
  }
  return false;
}

/// Sources of the core: everything outside the folders that are ROS's.
std::vector<fs::path> core_sources() {
  std::vector<fs::path> files;
  for (const char* root : {"include/mr_hand_interaction", "src"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (entry.is_regular_file() && !in_ros_folder(entry.path(), root)) files.push_back(entry.path());
    }
  }
  return files;
}

TEST(CoreIsRosFree, LinksNoRosLibraryDirectlyOrIndirectly) {
  const std::string library = core_library();
  ASSERT_FALSE(library.empty()) << "the core is not loaded as a shared library";
  const auto linked = lines_of("ldd '" + library + "'");
  ASSERT_GT(linked.size(), 3u) << "ldd told nothing of " << library;
  const std::regex ros(
      "lib(ros|tf2|xmlrpcpp|cpp_common|topic_tools|message_filters|diagnostic|class_loader).*");
  for (const std::string& line : linked) {
    const std::string name = std::regex_replace(line, std::regex(R"(^\s*(\S+).*)"), "$1");
    EXPECT_FALSE(std::regex_match(name, ros)) << line;
  }
}

TEST(CoreIsRosFree, IncludesNoRosHeaderNorAHeaderOfTheRosPart) {
  const auto sources = core_sources();
  ASSERT_GT(sources.size(), 20u) << "run from the repository's root";
  const std::regex ros(
      R"(\s*#\s*include\s*[<"](ros|tf2\w*|topic_tools|rosbag|XmlRpc\w*|diagnostic_\w+|\w+_(msgs|srvs))\b.*)");
  const std::regex ours(R"(\s*#\s*include\s*[<"]mr_hand_interaction/((ros|replay)/|[A-Z]).*)");
  for (const fs::path& file : sources) {
    std::ifstream text(file);
    for (std::string line; std::getline(text, line);) {
      EXPECT_FALSE(std::regex_match(line, ros) || std::regex_match(line, ours)) << file << ": " << line;
    }
  }
}

TEST(CoreIsRosFree, ReadsNoClockAndWritesNoLog) {
  const std::regex clock(
      R"(.*(\b(steady|system|high_resolution)_clock\b|\bclock_gettime\b|\bROS_(INFO|WARN|ERROR|DEBUG|FATAL)|\bstd::c(out|err|log)\b|\bprintf\s*\().*)");
  for (const fs::path& file : core_sources()) {
    std::ifstream text(file);
    for (std::string line; std::getline(text, line);) {
      EXPECT_FALSE(std::regex_match(line, clock)) << file << ": " << line;
    }
  }
}

}  // namespace
