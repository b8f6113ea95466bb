#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <mr_hand_interaction/HandFrame.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <topic_tools/shape_shifter.h>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/ros/input_statistics.h"
#include "mr_hand_interaction/ros/leap_reader.h"
#include "mr_hand_interaction/ros/sequence_watch.h"
#include "mr_hand_interaction/stamp_judge.h"
#include "mr_hand_interaction/tracking/hand_pairs.h"
#include "mr_hand_interaction/tracking/joint_gaps.h"

namespace mrhi {

struct TrackedPoints;

/// Turns what hand trackers publish into hand_frame, placed in the fixed frame by tf2. A hand of joints alone
/// (PoseArray, PointCloud) is of the side that its topic names, else its frame, else of ~side. Parameters:
/// ~fixed_frame (world), ~side of hands/pose_array and hands/point_cloud (right). Throws
/// std::invalid_argument for a bad one.
class HandTracking {
 public:
  HandTracking(const ros::NodeHandle& node, const ros::NodeHandle& parameters);

  /// Who is in the same process gets each frame at once, before it is published, with when its message
  /// arrived.
  using Sink = std::function<void(const mr_hand_interaction::HandFrame&, const ros::Time& arrival)>;
  void pass_to(Sink sink) { sink_ = std::move(sink); }
  /// Frames of trackers that were sent and have not arrived, so far.
  std::uint64_t lost() const { return statistics_.lost(); }

 private:
  using LeapEvent = ros::MessageEvent<const topic_tools::ShapeShifter>;

  void subscribe_leap();
  /// roscpp keeps a topic to the version that it met first, so a driver of another version needs a new
  /// subscription.
  void accept_other_versions();
  void take_leap(const LeapEvent& event);
  template <class Tracker>
  void subscribe_points(const std::string& topic);
  void take_points(const TrackedPoints& tracked, const std::optional<Side>& of_topic,
                   const ros::Time& receipt);
  /// Nothing if it cannot be used.
  std::optional<HandFrame> place(JointsFrame frame, const std::string& frame_id, const ros::Time& receipt);
  void take(const std::optional<HandFrame>& frame, const ros::Time& receipt);

  bool accept_stamp(Nanoseconds stamp);
  /// Pose of a tracker's frame in the fixed frame: at the stamp, else the latest. Throws
  /// tf2::TransformException.
  Pose device_pose(const std::string& frame_id, Nanoseconds stamp) const;

  Sink sink_;
  std::string fixed_frame_;
  Side side_ = Side::right;
  StampJudge stamps_;
  JointGaps gaps_;
  HandPairs pairs_;
  bool leap_seen_ = false;  ///< a driver, by the present subscription
  LeapReader leap_reader_;
  InputStatistics statistics_;
  SequenceWatch sequences_;

  ros::NodeHandle node_;
  tf2_ros::Buffer transforms_;
  tf2_ros::TransformListener transform_listener_;
  ros::Publisher publisher_;
  ros::Subscriber leap_subscriber_;
  std::vector<ros::Subscriber> point_subscribers_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
