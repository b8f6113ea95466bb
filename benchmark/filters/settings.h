#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi::filter_benchmark {

struct Setting {
  std::string filter;   ///< filter/type
  std::string series;   ///< what the settings of a line on the chart have in common
  std::string setting;  ///< what is set, as on a command line
  bool is_default = false;
  FilterConfiguration configuration;
};

/// What the chart shows, in the order of its lines.
std::vector<Setting> settings();

}  // namespace mrhi::filter_benchmark
