#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "support/temporary_folder.h"

namespace mrhi::test {

inline std::string text_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines_of(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The first run of a scripted motion as a device at the default mount sees it.
inline std::vector<JointsFrame> motion_frames(const std::string& motion_name, double rate,
                                              Nanoseconds start) {
  const ScriptedMotion motion = make_motion(motion_name);
  std::vector<JointsFrame> frames;
  for (int i = 0; i / rate < motion.run_time(); ++i) {
    const auto time = static_cast<Nanoseconds>(1e9 * i / rate);
    frames.push_back(sample(motion, Side::right, time, default_device_mount()));
    frames.back().stamp += start;
  }
  return frames;
}

inline std::string write_recording(const std::string& file, const std::vector<JointsFrame>& frames) {
  std::ofstream out(file);
  write_recording_csv(out, frames);
  return file;
}

}  // namespace mrhi::test
