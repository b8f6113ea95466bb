#include "arguments.h"

#include <algorithm>

namespace mrhi::benchmark {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

const std::string& known(const std::string& option, const std::string& name,
                         const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw UsageError(option + ": '" + name + "' is not known; allowed: " + joined(names));
  return name;
}

}  // namespace

Arguments parse_arguments(const std::vector<std::string>& words, const std::vector<std::string>& scenes,
                          const std::vector<std::string>& engines) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& option = words[i];
    if (option == "--quick") {
      arguments.quick = true;
      continue;
    }
    if (option != "--scene" && option != "--engine" && option != "--output")
      throw UsageError("unknown option '" + option +
                       "'; allowed: --quick, --scene NAME, --engine NAME, --output DIR");
    if (++i == words.size()) throw UsageError(option + " needs a value");
    if (option == "--scene") arguments.scenes.push_back(known(option, words[i], scenes));
    if (option == "--engine") arguments.engines.push_back(known(option, words[i], engines));
    if (option == "--output") arguments.output = words[i];
  }
  if (arguments.output.empty()) throw UsageError("--output DIR is missing");
  return arguments;
}

}  // namespace mrhi::benchmark
