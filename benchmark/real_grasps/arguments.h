#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "closing.h"
#include "mr_hand_interaction/configuration.h"
#include "take.h"

namespace mrhi::real_grasps {

/// A command line that cannot be followed. what() is one line.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Arguments {
  bool help = false;
  Configuration configuration;
  std::vector<Row> rows = all_rows();
  bool list = false;
  std::string output;  ///< folder, or empty
  unsigned jobs = 1;
  Disturbance disturbance;
  unsigned seeds = 1;                ///< each closing is played so many times, with other noise
  bool compare = false;              ///< our models in several settings
  std::vector<std::string> engines;  ///< modules of physics engines
  std::string arctic;                ///< folder of windows, or empty
  double lead = 1.0;                 ///< for which an object is led before its window [s]
  std::vector<std::string> paths;    ///< recordings, or folders of them
};

/// Without the program's name. Throws UsageError.
Arguments parse_arguments(const std::vector<std::string>& words);

/// What --help says.
const char* help_text();

}  // namespace mrhi::real_grasps
