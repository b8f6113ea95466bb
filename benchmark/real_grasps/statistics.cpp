#include "statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mrhi::real_grasps {
namespace {

// Of the recordings in which hands close, by device and by number of closings, and of ARCTIC's captures.
const std::vector<std::string> kTuned{"ul_desktop_a",
                                      "ul_vr_d",
                                      "ljp_brian",
                                      "ljp_pinch_115",
                                      "lm_confidence_two_hands",
                                      "lm_pinch",
                                      "tsl_help_11",
                                      "tsl_not_ok_1",
                                      "tsl_screen_ten_6",
                                      "ljp_flapping",
                                      "s01_ketchup_use_01",
                                      "s01_laptop_use_01",
                                      "s01_notebook_use_01"};
const std::vector<std::string> kHeldOut{"ul_vr_a",         "cd_hello_draw",         "ljp_paddle",
                                        "lm_grab_release", "lm_hmd_pinch",          "lm_pinch_and_move",
                                        "pg_gyro_room",    "tsl_hello_24",          "tsl_hundred_0",
                                        "tsl_not_ok_14",   "s01_waffleiron_use_01", "s02_notebook_use_02"};

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (place - std::floor(place)) * (above - values[below]);
}

Interval wilson(std::size_t successes, std::size_t trials) {
  if (trials == 0) return {};
  constexpr double z = 1.959964;  // 97.5 % of a normal distribution lie below
  const double n = static_cast<double>(trials), p = static_cast<double>(successes) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {successes > 0 ? middle - half : 0.0, successes < trials ? middle + half : 1.0};
}

Half half_of(const std::string& name) {
  if (is_in(kTuned, name)) return Half::tuned;
  if (is_in(kHeldOut, name)) return Half::held_out;
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return (hash >> 32) % 2 == 0 ? Half::tuned : Half::held_out;
}

std::string capture_of(const std::string& window) {
  return window.substr(0, window.rfind('_'));
}

}  // namespace mrhi::real_grasps
