#include "engine_module.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "configured.h"

namespace mrhi::benchmark {

std::vector<EngineModule> engine_modules() {
  return {SPEED_ACCURACY_ENGINES};
}

std::vector<std::string> settings_of(const EngineModule& module) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to an engine's module");
  const pid_t child = fork();
  if (child == 0) {
    try {
      std::string names;
      for (const std::string& name : load(module.file).settings()) names += name + "\n";
      if (write(ends[1], names.data(), names.size()) != static_cast<ssize_t>(names.size())) _exit(1);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      _exit(1);
    }
    _exit(0);
  }
  close(ends[1]);
  std::string text;
  char buffer[1024];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof(buffer))) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  waitpid(child, nullptr, 0);
  std::vector<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) names.push_back(line);
  return names;
}

}  // namespace mrhi::benchmark
