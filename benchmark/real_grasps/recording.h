#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::real_grasps {

/// Values of `object` in NAME.meta.json beside NAME.csv: a recorded hand had no object, saw one, or felt one.
constexpr const char* kObjects[] = {"none", "seen", "felt"};

/// Positions of a hand's joints, in world [m]; NaN if not tracked.
struct Sighting {
  std::uint32_t id = 0;   ///< of the hand
  std::size_t frame = 0;  ///< index in Recording::frames
  double time = 0.0;      ///< [s]
  std::array<std::array<Vector3, 5>, kFingers> joints;
  Vector3 palm;
};

/// One hand while it keeps its id.
using Track = std::vector<Sighting>;

struct Recording {
  std::string name;    ///< file name without folder and extension
  std::string object;  ///< object of the recorded hand: one of kObjects; empty: unknown
  std::vector<JointsFrame> frames;
  std::vector<Track> tracks;                     ///< in order of appearance
  std::vector<std::vector<Sighting>> sightings;  ///< of each frame
};

/// Default pose of the tracker, as in `replay`.
Pose device_mount();

/// Groups frames by hands.
Recording make_recording(std::string name, std::vector<JointsFrame> frames);

/// Throws RecordingError.
Recording load_recording(const std::string& file);

/// Files, and all recordings in folders, sorted by name. Throws std::runtime_error for a path that does not
/// exist.
std::vector<std::string> recording_files(const std::vector<std::string>& paths);

/// Noise and rate of a different tracker.
struct Disturbance {
  double noise = 0.0;          ///< white, on each joint and axis, rms [m]
  std::optional<double> rate;  ///< evenly spaced frames with linear interpolation [1/s]; empty: as recorded
  std::uint64_t seed = 1;
};

/// Frames `first` to `last` of a recording as that tracker would report them. The same seed gives the same
/// bits.
std::vector<JointsFrame> disturbed(const std::vector<JointsFrame>& frames, std::size_t first,
                                   std::size_t last, const Disturbance& disturbance);

}  // namespace mrhi::real_grasps
