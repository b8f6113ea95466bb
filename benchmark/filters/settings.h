#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi::filter_benchmark {

struct Setting {
  std::string filter;   ///< filter/type
  std::string series;   ///< common name of the settings of a line on the chart
  std::string setting;  ///< as on a command line
  bool is_default = false;
  FilterConfiguration configuration;
};

/// Settings on the chart, in the order of its lines.
std::vector<Setting> settings();

}  // namespace mrhi::filter_benchmark
