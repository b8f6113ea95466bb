#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "../tracking/joints_input.h"
#include "tracked_points.h"

namespace mrhi {

/// Turns trackers' messages of every kind into hands in world: the same code for the live nodes and for bags.
class TrackerReader {
 public:
  struct Options {
    Side side = Side::right;  ///< of a hand whose side neither topic nor frame names
    std::string order;        ///< of joints, see joint_orders(); empty: recognised by the lengths of bones
    double scale = 1.0;       ///< metres per unit of the tracker's lengths
  };
  /// Throws std::invalid_argument for an unknown order, or a scale that is no positive number.
  explicit TrackerReader(const Options& options);

  static std::set<std::string> types();
  /// Where trackers publish; each topic may carry any of the types.
  static std::vector<std::string> topics();

  struct Message {
    std::string topic;      ///< by the name that tells the side
    std::string publisher;  ///< has a clock of its own
    std::string type, md5;
    std::vector<std::uint8_t> bytes;
    Nanoseconds receipt = 0;
  };
  /// A tracker's place in world by its frame.
  using Place = std::function<Pose(const std::string& frame_id, Nanoseconds stamp)>;

  /// What it throws is what `place` throws. `sequence` gets the header's number if the message can be read.
  SourceFrame read(Message message, const Place& place, std::optional<std::uint32_t>* sequence = nullptr);
  /// What still waits, at the end of a recording.
  std::optional<HandFrame> rest() { return input_.rest(); }

 private:
  TrackerFrame frame_of(const TrackedPoints& tracked, const Message& message, SourceFrame& result);
  TrackerFrame frame_of(TrackedHands tracked, const Message& message, SourceFrame& result);
  Side side_of(const std::string& frame_id, const std::string& topic) const;

  Side side_;
  const JointOrder* order_ = nullptr;
  std::map<std::string, OrderRecognition> orders_;  // by stream
  JointsInput input_;
};

}  // namespace mrhi
