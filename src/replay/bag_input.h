#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "frame_source.h"

namespace mrhi {

/// A bag that cannot be replayed. what() is one line.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Hands from topics of a bag: a tracker's message (ros/tracker_messages.h; of a right hand where neither
/// topic nor frame names a side), or HandFrame in world. Reads a few messages ahead.
class BagInput : public FrameSource {
 public:
  /// Without a topic: /leap_motion/leap_device, else those of joints, hands/[left/|right/]..., together, else
  /// the only one of a fitting type.
  /// Without a device pose: the bag's /tf_static and /tf at the frames' stamps, as live; the Leap's own frame
  /// has a default mount, hands in any other that nothing places are refused. Throws BagError.
  BagInput(const std::string& file, const std::optional<std::string>& topic,
           const std::optional<Pose>& device_in_world, const HandOptions& hands = {});
  ~BagInput() override;

  std::optional<SourceFrame> next() override;
  std::size_t position() const override;
  std::size_t size() const override;
  const std::string& topic() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the whole bag in a child process first: the bag library takes every length in it on trust, and a
/// corrupt one may end the process. Throws BagError.
void check_readable(const std::string& file);

/// Within a handler: what the bag library has thrown, as a BagError in one line that names the file. Other
/// exceptions go on as they are.
[[noreturn]] void refuse_bag(const std::string& file);

}  // namespace mrhi
