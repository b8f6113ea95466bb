#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "../math/duration_histogram.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// How a replay stands to the live run that it does again.
struct LiveRun {
  std::string version;                  ///< of the package that ran
  std::uint64_t entries = 0;            ///< of the log that have been done again
  std::uint64_t missing = 0;            ///< entries that the recording has lost
  std::uint64_t compared = 0;           ///< entries after which the state was compared with the live one's
  std::uint64_t same = 0;               ///< of these, with the same hash
  std::optional<double> parts_at;       ///< where it was first another one [s]
  std::uint64_t lost_by_queue = 0;      ///< frames that did not reach the live simulation
  std::vector<std::string> changes;     ///< that were made while it ran, with their time
  std::vector<std::string> overridden;  ///< by hand, so that this is another run
};

/// What summary.json says of a replay.
struct ReplaySummary {
  std::string scene, input, topic, contact_model, version;
  std::vector<std::string> arguments;             ///< that make the same run again
  Vector3 gravity = Vector3::Zero();              ///< [m/s^2]
  std::map<std::string, std::string> parameters;  ///< that are not the default, as YAML
  std::map<std::string, Material> materials;      ///< of the objects, by name
  std::uint64_t frames = 0;                       ///< taken
  double simulated_seconds = 0.0;
  std::uint64_t steps = 0;
  DurationHistogram step_time;
  double deepest_rendered = 0.0;                   ///< [m]
  std::uint64_t restarts = 0;                      ///< times that the recording's stamps began anew
  std::map<std::string, std::uint64_t> rejected;   ///< frames, by reason
  std::map<std::string, std::uint64_t> corrected;  ///< faults of the input that were put right, by kind
  std::uint64_t hands_left_out = 0;                ///< unusable hands in frames that were taken
  std::map<std::string, std::uint64_t> events;
  std::vector<std::string> held_at_end;
  std::uint64_t state_hash = 0;
  std::optional<LiveRun> live;         ///< where the recording tells
  std::vector<std::string> not_known;  ///< what the outcome hangs on that the recording does not tell
  std::string error;                   ///< why it ended early; empty if it did not
};

/// As JSON. All but step_time_us is the same for the same input.
std::string to_json(const ReplaySummary& summary);

}  // namespace mrhi
