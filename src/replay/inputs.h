#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "../record/record.h"
#include "../tracking/joints_input.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {
/// The frames of a recording.
using FrameSource = Source<SourceFrame>;

/// A recording in the CSV schema, seen by a device that is placed in world.
class CsvInput : public FrameSource {
 public:
  /// Throws RecordingError.
  CsvInput(const std::string& file, const Pose& device_in_world, double scale);

  std::optional<SourceFrame> next() override;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::vector<std::string> warnings_;
  std::vector<JointsFrame> frames_;
  Pose device_in_world_;
  JointsInput input_;
};

/// An open recording, and the topic that is read from it.
struct ReplayInput {
  std::unique_ptr<FrameSource> frames;
  std::string topic;
  std::vector<std::string> warnings = {};  ///< what is assumed about it
};

/// Opens a bag to read hands: messages of trackers (ros/tracker_reader.h; a right hand if neither topic nor
/// frame names a side), or HandFrame in world. Default topic: /leap_motion/leap_device, else all topics of
/// joints (hands/[left/|right/]...), else the only topic of a suitable type. Default device pose: from the
/// bag's /tf_static and /tf at the frames' stamps, as live. The Leap's frame has a default mount; hands in
/// any other unknown frame are rejected. Throws BagError, or UsageError in a build without ROS.
ReplayInput open_bag(const std::string& file, const std::optional<std::string>& topic,
                     const std::optional<Pose>& device_in_world, const HandOptions& hands = {});

/// The log of a live simulation, if the recording has one; else the reason why not.
struct OpenLog {
  std::unique_ptr<LogSource> source;
  std::string topic, why_not;
};

/// Opens the log of a recording. Throws BagError.
OpenLog open_log(const ReplayArguments& arguments);

/// Error of a bag that cannot be replayed. what() is one line.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes the rendered view of a frame. The first call creates the file. Throws std::runtime_error that names
/// the file if it cannot be written.
using ViewWriter = std::function<void(const Simulation& simulation)>;

/// A ViewWriter to a bag. Either of chosen frames, by their numbers from 0: for each its number on /frame
/// (std_msgs/UInt32), then its markers on /markers (visualization_msgs/MarkerArray), with all that is there.
/// Or with a rate [Hz] of a whole run: /markers at that rate, as a live node sends them, and for every frame
/// /scene (when it changes), /rendered_view, /rendered_hands, /tracked_hands, /objects and /contacts. Throws
/// UsageError where this was built without ROS.
ViewWriter marker_bag(const std::string& file, const std::optional<double>& rate,
                      const std::set<std::size_t>& frames);

}  // namespace mrhi
