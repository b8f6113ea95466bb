#pragma once

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/PointCloud.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../tracking/joints_input.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Largest list or text of a tracker's message [bytes]; real ones have less than 4 KB.
constexpr std::size_t kMaxListBytes = 64 * 1024;

/// Rejects lists longer than kMaxListBytes. roscpp allocates a list of the length in the message before it
/// reads the elements, so four bytes could claim all memory.
template <class T>
struct BoundedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = BoundedAllocator<U>;
  };

  BoundedAllocator() = default;
  template <class U>
  BoundedAllocator(const BoundedAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    if (count > kMaxListBytes / sizeof(T)) throw std::bad_alloc();
    return std::allocator<T>::allocate(count);
  }
};
using Bounded = BoundedAllocator<char>;

/// Deserialises a message with this allocator; `type` is its name in errors. Throws DecodeError. The thread's
/// next message of this type replaces it, in the same memory: most lists are as long as the last time.
template <class Message>
const Message& deserialised(const char* type, std::vector<std::uint8_t>& bytes) {
  const auto refuse = [&](const std::string& what) {
    throw DecodeError(DecodeError::Kind::malformed,
                      type + (" of " + std::to_string(bytes.size())) + " bytes " + what);
  };
  thread_local Message message;
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  try {
    if (bytes.empty()) ros::serialization::throwStreamOverrun();  // roscpp would add to a null pointer
    ros::serialization::deserialize(stream, message);
  } catch (const ros::serialization::StreamOverrunException&) {
    refuse("ends before all of its fields");
  } catch (const std::bad_alloc&) {
    refuse("has a list or text of more than " + std::to_string(kMaxListBytes) + " bytes");
  }
  if (stream.getLength() != 0)
    refuse("has " + std::to_string(stream.getLength()) + " after all of its fields");
  return message;
}

/// Poses of trackers, by the transforms of /tf and /tf_static in their order of arrival, live and from a bag.
/// In tf2's own listener, a stamp beyond a duration's range would end the node, and one far ahead would make
/// all later transforms too old.
class TransformMemory {
 public:
  /// Sets a static transform.
  void set_fixed(const geometry_msgs::TransformStamped& transform);
  /// Sets a dynamic transform that arrived at `now`. Returns the reason for rejecting it; empty: accepted.
  std::string set(const geometry_msgs::TransformStamped& transform, Nanoseconds now);

  /// True if a chain of transforms connects both frames.
  bool connects(const std::string& fixed, const std::string& frame) const;
  /// Pose of a frame in another, at the stamp or else the latest. Throws tf2::TransformException.
  Pose pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const;
  /// Removes dynamic transforms; new ones would be rejected as older than these.
  void clear() { buffer_.clear(); }

 private:
  /// Arrival times of a frame's transforms, and the last one accepted.
  struct Stream {
    StampCheck check;
    Nanoseconds arrival = 0;
  };
  std::map<std::string, Stream> streams_;  // by child frame
  tf2::BufferCore buffer_;
};

/// Joints of one hand or both, in one of joint_orders(), in the frame of the header.
struct TrackedPoints {
  std_msgs::Header header;
  std::vector<Vector3> points;
  std::vector<float> radii;  ///< distances from the points to the skin; empty: unknown
  float confidence = 1.0f;   ///< 0 to 1
};

/// Copies a header from a message with another allocator.
template <class Header>
std_msgs::Header header_of(const Header& other) {
  std_msgs::Header header;
  header.seq = other.seq;
  header.stamp = other.stamp;
  header.frame_id.assign(other.frame_id.begin(), other.frame_id.end());
  return header;
}

/// Reads joints from a message of any allocator. Orientations are not used.
template <class Allocator>
TrackedPoints tracked_points(const geometry_msgs::PoseArray_<Allocator>& message) {
  TrackedPoints tracked{header_of(message.header), {}, {}};
  for (const auto& pose : message.poses)
    tracked.points.emplace_back(pose.position.x, pose.position.y, pose.position.z);
  return tracked;
}
/// Channels: "radius" [m], from a joint to the skin; "confidence", 0 to 1, whose mean is the hand's.
template <class Allocator>
TrackedPoints tracked_points(const sensor_msgs::PointCloud_<Allocator>& message) {
  TrackedPoints tracked{header_of(message.header), {}, {}};
  for (const auto& point : message.points)
    tracked.points.push_back(Eigen::Vector3f(point.x, point.y, point.z).template cast<double>());
  for (const auto& channel : message.channels) {
    if (channel.values.size() != message.points.size() || channel.values.empty()) continue;
    if (channel.name == "radius") tracked.radii.assign(channel.values.begin(), channel.values.end());
    if (channel.name != "confidence") continue;
    float sum = 0.0f;
    for (const float value : channel.values) sum += value;
    tracked.confidence = sum / static_cast<float>(channel.values.size());
  }
  return tracked;
}

/// Returns the order of `size` joints.
using OrderOf = std::function<const JointOrder&(std::size_t size, const Vector3* points)>;

/// Makes hands from joint positions; a joint with a NaN coordinate is missing. Twice an order's number of
/// joints means a left hand, then a right one; otherwise the hand is of the given side. A hand without any
/// joint is absent; no points make a frame without hands. Such trackers have no ids, so these are 1 for left,
/// 2 for right. Throws DecodeError for any other number of joints.
JointsFrame joints_from_points(const TrackedPoints& tracked, Side side, const OrderOf& order_of);

/// True if it has both hands.
bool has_both_hands(const TrackedPoints& tracked);
/// Side in a topic's last part or the one before, as in hands/left/pose_array.
std::optional<Side> side_of_topic(const std::string& name);
/// Side in a frame's name, which ends in left_hand or right_hand.
std::optional<Side> side_of_frame(const std::string& name);

/// Converts trackers' messages of all types to hands in world, for live nodes and bags alike.
class TrackerReader {
 public:
  struct Options {
    Side side = Side::right;  ///< of a hand whose side neither topic nor frame names
    std::string order;        ///< of joints, see joint_orders(); empty: detected by the lengths of bones
    double scale = 1.0;       ///< metres per unit of length of the tracker
  };
  /// Throws std::invalid_argument for an unknown order, or a scale that is not a positive number.
  explicit TrackerReader(const Options& options);

  static std::set<std::string> types();
  /// Topics of trackers; each may carry any of the types.
  static std::vector<std::string> topics();

  struct Message {
    std::string topic;      ///< name that determines the side
    std::string publisher;  ///< each has its own clock
    std::string type, md5;
    std::vector<std::uint8_t> bytes;
    Nanoseconds receipt = 0;
  };
  /// Pose of a tracker in world, by its frame.
  using Place = std::function<Pose(const std::string& frame_id, Nanoseconds stamp)>;

  /// Throws what `place` throws. `sequence` receives the header's number if the message is readable.
  SourceFrame read(Message message, const Place& place, std::optional<std::uint32_t>* sequence = nullptr);
  /// Returns the waiting frame, at the end of a recording.
  std::optional<HandFrame> rest() { return input_.rest(); }

 private:
  TrackerFrame frame_of(const TrackedPoints& tracked, Side side, const std::string& stream,
                        SourceFrame& result);

  Side side_;
  const JointOrder* order_ = nullptr;
  std::map<std::string, OrderRecognition> orders_;  // by stream
  JointsInput input_;
};

}  // namespace mrhi
