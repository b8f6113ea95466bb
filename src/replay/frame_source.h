#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../record/log.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// One frame of a recording, or why it cannot be used.
struct SourceFrame {
  std::optional<HandFrame> frame;
  std::optional<Nanoseconds> arrival;  ///< when it was received, by the recorder's clock, where that is known
  bool waits = false;                  ///< for the other hand's, with which it comes
  std::string reason;                  ///< kind of refusal, for counting; empty if there is a frame
  std::string detail;                  ///< the particular case
  std::vector<std::string> left_out;   ///< hands of the frame that cannot be used, each with its defect
};

/// Places a tracker's frame in world.
SourceFrame placed(const JointsFrame& joints, const Pose& device_in_world);

/// The frames of a recording in the order in which they were recorded.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Nothing at the end. Throws std::exception with one line if the recording cannot be read any further.
  virtual std::optional<SourceFrame> next() = 0;
  /// Of what is recorded, so far and in all: a frame each, or the hands of a frame in messages of their own.
  virtual std::size_t position() const = 0;
  virtual std::size_t size() const = 0;
};

/// A recording in the CSV schema, seen by a device that is placed in world.
class CsvInput : public FrameSource {
 public:
  /// Throws RecordingError.
  CsvInput(const std::string& file, const Pose& device_in_world);

  std::optional<SourceFrame> next() override;
  std::size_t position() const override { return position_; }
  std::size_t size() const override { return frames_.size(); }

 private:
  std::vector<JointsFrame> frames_;
  Pose device_in_world_;
  std::size_t position_ = 0;
};

/// A recording that is open, and the topic that is read of it.
struct ReplayInput {
  std::unique_ptr<FrameSource> frames;
  std::string topic;
};

/// Throws BagError; where this was built without ROS, UsageError.
ReplayInput open_bag(const ReplayArguments& arguments);

/// The log of a live simulation, if the recording has one; else why not.
struct OpenLog {
  std::unique_ptr<LogSource> source;
  std::string topic, why_not;
};

/// Throws BagError.
OpenLog open_log(const ReplayArguments& arguments);

}  // namespace mrhi
