#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../record/log.h"
#include "../tracking/joints_input.h"
#include "mr_hand_interaction/replay/replay.h"

namespace mrhi {

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
  CsvInput(const std::string& file, const Pose& device_in_world, double scale);

  std::optional<SourceFrame> next() override;
  std::size_t position() const override { return position_; }
  std::size_t size() const override { return frames_.size(); }

 private:
  std::vector<JointsFrame> frames_;
  Pose device_in_world_;
  JointsInput input_;
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
