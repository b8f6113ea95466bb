#include "settings.h"

#include <algorithm>

#include "mr_hand_interaction/parameters.h"
#include "tracking/hand_filter.h"

namespace mrhi::filter_benchmark {
namespace {

/// One line of the chart: one parameter varies, others are constant.
struct Series {
  std::string filter;
  std::vector<std::pair<std::string, std::string>> fixed;
  std::string runs;
  std::vector<std::string> values;
};

const std::vector<Series>& all_series() {
  static const std::vector<Series> series{
      {"none", {}, "", {""}},
      {"window", {}, "window", {"2", "3", "4", "5", "6", "8"}},
      {"one_euro", {{"beta", "10"}}, "min_cutoff", {"0.5", "1", "2", "4", "8"}},
      {"one_euro", {{"beta", "100"}}, "min_cutoff", {"0.5", "1", "2", "4", "8"}},
      {"constant_velocity", {{"agility", "0"}}, "acceleration", {"0.1", "0.2", "0.5", "1", "2", "5"}},
      {"constant_velocity", {{"agility", "4"}}, "acceleration", {"0.01", "0.03", "0.1", "0.3", "1", "3"}},
      {"constant_velocity", {{"agility", "12"}}, "acceleration", {"0.01", "0.03", "0.1", "0.3", "1", "3"}},
  };
  return series;
}

bool same(const FilterConfiguration& a, const FilterConfiguration& b) {
  return a.type == b.type &&
         std::all_of(filter_settings().begin(), filter_settings().end(), [&](const FilterSetting& setting) {
           return std::visit([&](auto value) { return a.*value == b.*value; }, setting.value);
         });
}

Setting setting_of(const Series& series, const std::string& value) {
  Configuration configuration;
  Setting setting{series.filter, series.filter, "", false, {}};
  const auto set = [&](const std::string& name, const std::string& to) {
    set_parameter(configuration, "filter/" + name, to);
    setting.setting += (setting.setting.empty() ? "" : " ") + name + "=" + to;
  };
  set_parameter(configuration, "filter/type", series.filter);
  for (const auto& [name, to] : series.fixed) {
    set(name, to);
    setting.series += " " + name + "=" + to;
  }
  if (!series.runs.empty()) set(series.runs, value);
  setting.configuration = configuration.filter;
  setting.is_default = same(configuration.filter, FilterConfiguration());
  return setting;
}

}  // namespace

std::vector<Setting> settings() {
  std::vector<Setting> settings;
  for (const Series& series : all_series()) {
    for (const std::string& value : series.values) settings.push_back(setting_of(series, value));
  }
  return settings;
}

}  // namespace mrhi::filter_benchmark
