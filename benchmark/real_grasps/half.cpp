#include "half.h"

#include <algorithm>
#include <cstdint>
#include <vector>

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
