#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace mrhi::benchmark {

/// Bad usage. what() is one line: the option, and what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Arguments {
  bool quick = false;
  std::vector<std::string> scenes;   ///< names, or names of groups; empty: all
  std::vector<std::string> engines;  ///< empty: all
  std::string output;                ///< folder, made if it is not there
};

/// Throws UsageError. `scenes` and `engines` are the names that are known.
Arguments parse_arguments(const std::vector<std::string>& words, const std::vector<std::string>& scenes,
                          const std::vector<std::string>& engines);

}  // namespace mrhi::benchmark
