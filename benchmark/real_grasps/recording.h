#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::real_grasps {

/// Whether a recorded hand had no object, saw one, or felt one: `object` in NAME.meta.json beside NAME.csv.
constexpr const char* kObjects[] = {"none", "seen", "felt"};

/// Where a hand's joints are, in world [m]; NaN where the tracker gave none.
struct Sighting {
  std::uint32_t id = 0;   ///< of the hand
  std::size_t frame = 0;  ///< index in Recording::frames
  double time = 0.0;      ///< [s]
  std::array<std::array<Vector3, 5>, kFingers> joints;
  Vector3 palm;
};

/// One hand, for as long as it keeps its id.
using Track = std::vector<Sighting>;

struct Recording {
  std::string name;    ///< file without folder and ending
  std::string object;  ///< what the hand had before it: one of kObjects, or empty if that is not known
  std::vector<JointsFrame> frames;
  std::vector<Track> tracks;                     ///< in the order in which hands come up
  std::vector<std::vector<Sighting>> sightings;  ///< of each frame
};

/// Where the tracker stands: as `replay` has it where nothing else is said.
Pose device_mount();

/// Sorts frames by hands.
Recording make_recording(std::string name, std::vector<JointsFrame> frames);

/// Throws RecordingError.
Recording load_recording(const std::string& file);

/// Files and, of folders, all recordings in them, sorted by name. Throws std::runtime_error for a path at
/// which there is nothing.
std::vector<std::string> recording_files(const std::vector<std::string>& paths);

/// Another tracker than the one that recorded.
struct Disturbance {
  double noise = 0.0;  ///< white, on each joint and axis, rms [m]
  std::optional<double>
      rate;  ///< frames evenly spaced, joints in between by straight lines [1/s]; else as recorded
  std::uint64_t seed = 1;
};

/// The frames of a recording from `first` to `last` as the tracker has them. The same seed gives the same
/// bits.
std::vector<JointsFrame> disturbed(const std::vector<JointsFrame>& frames, std::size_t first,
                                   std::size_t last, const Disturbance& disturbance);

}  // namespace mrhi::real_grasps
