#include "tracker_reader.h"

#include <mr_hand_interaction/LeapControllerHand.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr std::size_t kMaxFrames = 10'000;

std::string named(const geometry_msgs::TransformStamped& transform) {
  return "from '" + text::one_line(transform.header.frame_id, 64) + "' to '" +
         text::one_line(transform.child_frame_id, 64) + "'";
}

geometry_msgs::TransformStamped without_slashes(geometry_msgs::TransformStamped transform) {
  transform.header.frame_id = without_slash(transform.header.frame_id);
  transform.child_frame_id = without_slash(transform.child_frame_id);
  return transform;
}

void add_hand(const TrackedPoints& tracked, std::size_t first, std::size_t joints, Side side,
              const OrderOf& order_of, JointsFrame& frame) {
  const Vector3* const points = tracked.points.data() + first;
  if (std::all_of(points, points + joints, [](const Vector3& point) { return !point.allFinite(); })) return;
  const bool has_radii = tracked.radii.size() == tracked.points.size();
  frame.hands.push_back(hand_in_order(order_of(joints, points), points,
                                      has_radii ? tracked.radii.data() + first : nullptr, side));
  frame.hands.back().confidence = tracked.confidence;
}

/// A message type with which trackers report hands.
struct Tracker {
  std::string type;
  std::vector<std::string> md5s, topics;  ///< its versions, and its standard topics
  /// Its contents: joints in an order, or hands by names of fingers and bones. Consumes the bytes.
  std::function<std::variant<TrackedPoints, LeapFrame>(const std::string& md5,
                                                       std::vector<std::uint8_t>& bytes)>
      read;
  bool has_sides = false;  ///< false: hands by name are one hand, of the side that topic or frame names
};

template <template <class> class Message>
Tracker tracker_of_points(const std::string& type, const std::string& topic) {
  return {type,
          {ros::message_traits::md5sum<Message<std::allocator<void>>>()},
          {"hands/" + topic, "hands/left/" + topic, "hands/right/" + topic},
          [type](const std::string&, std::vector<std::uint8_t>& bytes) {
            return tracked_points(deserialised<Message<Bounded>>(type.c_str(), bytes));
          }};
}

const std::vector<Tracker>& trackers() {
  static const std::vector<Tracker> all{
      {"leap_motion_controller/Hand",
       {ros::message_traits::md5sum<mr_hand_interaction::LeapControllerHand>()},
       {"/leapmotion/hands/left", "/leapmotion/hands/right"},
       [](const std::string&, std::vector<std::uint8_t>& bytes) {
         return read_leap_controller(std::move(bytes));
       }},
      {"leap_motion/Human",
       leap_versions(),
       {"/leap_motion/leap_device"},
       [](const std::string& md5, std::vector<std::uint8_t>& bytes) {
         return read_leap(md5, std::move(bytes));
       },
       true},
      tracker_of_points<sensor_msgs::PointCloud_>("sensor_msgs/PointCloud", "point_cloud"),
      tracker_of_points<geometry_msgs::PoseArray_>("geometry_msgs/PoseArray", "pose_array")};
  return all;
}

/// Finds a type by its MD5, which does not depend on its name. Throws DecodeError.
const Tracker& tracker_of(const TrackerReader::Message& message) {
  for (const Tracker& tracker : trackers())
    if (std::count(tracker.md5s.begin(), tracker.md5s.end(), message.md5) > 0) return tracker;
  std::string allowed = text::joined(TrackerReader::types());
  for (const Tracker& tracker : trackers())
    if (tracker.type == message.type) allowed = "md5 " + text::joined(tracker.md5s);
  throw DecodeError(DecodeError::Kind::unknown_version, "unknown version of " +
                                                            text::one_line(message.type, 100) + ": md5 " +
                                                            message.md5 + "; allowed: " + allowed);
}

/// A bag may lack the publisher.
std::string stream_of(const TrackerReader::Message& message) {
  return message.topic + (message.publisher.empty() ? "" : " of " + message.publisher);
}

double checked_scale(double scale) {
  if (std::isfinite(scale) && scale > 0.0) return scale;
  throw std::invalid_argument("scale " + text::number(scale) +
                              " is not allowed; allowed: metres per unit of the tracker, above 0");
}

}  // namespace

void TransformMemory::set_fixed(const geometry_msgs::TransformStamped& transform) {
  buffer_.setTransform(without_slashes(transform), "fixed", true);
}

/// Transforms out of order are valid: the buffer sorts them. A clock that stands still or jumps is ignored: a
/// frame's stream has the time of its own stamps, plus the time since the last of them.
std::string TransformMemory::set(const geometry_msgs::TransformStamped& transform, Nanoseconds now) {
  if (streams_.size() >= kMaxFrames && streams_.count(transform.child_frame_id) == 0)
    return named(transform) + ": there are " + std::to_string(kMaxFrames) + " frames already";
  const Nanoseconds stamp = from_ros_time(transform.header.stamp);
  Stream& stream = streams_[transform.child_frame_id];
  std::optional<Nanoseconds> expected;
  if (stream.check.started && now > stream.arrival) expected = stream.check.last + (now - stream.arrival);
  const StampVerdict verdict = stream.check.check(stamp, stream.check.last, expected);
  const bool believed = verdict == StampVerdict::follows || verdict == StampVerdict::restart;
  if (verdict == StampVerdict::restart) clear();
  if (believed) stream.arrival = now;
  if (!believed && verdict != StampVerdict::late)
    return named(transform) + ": stamp " + std::to_string(stamp / 1'000'000'000) +
           " s is far from its others'";
  buffer_.setTransform(without_slashes(transform), "moving");
  return "";
}

bool TransformMemory::connects(const std::string& fixed, const std::string& frame) const {
  const std::string source = without_slash(frame);
  return source == fixed || (!source.empty() && buffer_.canTransform(fixed, source, ros::Time(0)));
}

Pose TransformMemory::pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const {
  const std::string source = without_slash(frame);
  try {
    return from_message(buffer_.lookupTransform(fixed, source, to_ros_time(stamp)).transform);
  } catch (const tf2::ExtrapolationException&) {
    return from_message(buffer_.lookupTransform(fixed, source, ros::Time(0)).transform);
  }
}

bool has_both_hands(const TrackedPoints& tracked) {
  const std::size_t joints = tracked.points.size();
  return joints % 2 == 0 && !usual_order(joints) && usual_order(joints / 2);
}

std::optional<Side> side_of_topic(const std::string& name) {
  std::string rest = "/" + name;
  for (int part = 0; part < 2; ++part) {
    if (boost::ends_with(rest, "/left")) return Side::left;
    if (boost::ends_with(rest, "/right")) return Side::right;
    rest.erase(rest.rfind('/') == std::string::npos ? 0 : rest.rfind('/'));
  }
  return std::nullopt;
}

std::optional<Side> side_of_frame(const std::string& name) {
  if (boost::ends_with(name, "left_hand")) return Side::left;
  if (boost::ends_with(name, "right_hand")) return Side::right;
  return std::nullopt;
}

JointsFrame joints_from_points(const TrackedPoints& tracked, Side side, const OrderOf& order_of) {
  JointsFrame frame;
  frame.stamp = from_ros_time(tracked.header.stamp);
  const std::size_t joints = tracked.points.size();
  if (joints == 0) return frame;
  if (usual_order(joints)) {
    add_hand(tracked, 0, joints, side, order_of, frame);
  } else if (has_both_hands(tracked)) {
    add_hand(tracked, 0, joints / 2, Side::left, order_of, frame);
    add_hand(tracked, joints / 2, joints / 2, Side::right, order_of, frame);
  } else {
    throw DecodeError(
        DecodeError::Kind::wrong_count,
        std::to_string(joints) +
            " joints; 21, 24, 25 or 26 of a hand, twice as many of both, or none for a frame with no hand");
  }
  return frame;
}

TrackerReader::TrackerReader(const Options& options)
    : side_(options.side),
      order_(options.order.empty() ? nullptr : &joint_order(options.order)),
      input_(checked_scale(options.scale)) {}

std::set<std::string> TrackerReader::types() {
  std::set<std::string> types;
  for (const Tracker& tracker : trackers()) types.insert(tracker.type);
  return types;
}

std::vector<std::string> TrackerReader::topics() {
  std::vector<std::string> topics;
  for (const Tracker& tracker : trackers())
    topics.insert(topics.end(), tracker.topics.begin(), tracker.topics.end());
  return topics;
}

SourceFrame TrackerReader::read(Message message, const Place& place, std::optional<std::uint32_t>* sequence) {
  SourceFrame result;
  try {
    const Tracker& tracker = tracker_of(message);
    const auto tracked = tracker.read(message.md5, message.bytes);
    const TrackedPoints* const points = std::get_if<TrackedPoints>(&tracked);
    const std::string frame_id = points ? points->header.frame_id : std::get<LeapFrame>(tracked).frame_id;
    if (sequence != nullptr) *sequence = points ? points->header.seq : std::get<LeapFrame>(tracked).sequence;
    const auto side = [&] {
      const std::optional<Side> of_topic = side_of_topic(message.topic);
      return (of_topic ? of_topic : side_of_frame(frame_id)).value_or(side_);
    };
    TrackerFrame frame;
    if (points) {
      frame = frame_of(*points, side(), stream_of(message), result);
    } else {
      frame.joints = std::get<LeapFrame>(tracked).joints;
      if (!tracker.has_sides) {
        frame.side = side();
        for (HandJoints& hand : frame.joints.hands) hand.side = *frame.side;
      }
    }
    frame.stream = stream_of(message);
    frame.receipt = message.receipt;
    auto recognised = std::move(result.corrected);
    result = input_.take(std::move(frame), [&](Nanoseconds stamp) { return place(frame_id, stamp); });
    result.corrected.insert(result.corrected.begin(), recognised.begin(), recognised.end());
  } catch (const DecodeError& error) {
    result.reason = error.reason();
    result.detail = error.what();
  }
  result.arrival = message.receipt;
  return result;
}

/// Reports an order that is not the usual one.
TrackerFrame TrackerReader::frame_of(const TrackedPoints& tracked, Side side, const std::string& stream,
                                     SourceFrame& result) {
  const auto order_of = [&](std::size_t size, const Vector3* points) -> const JointOrder& {
    if (order_ != nullptr && order_->size == size) return *order_;
    if (order_ != nullptr)
      throw DecodeError(
          DecodeError::Kind::wrong_count,
          std::to_string(size) + " joints; order '" + order_->name + "' has " + std::to_string(order_->size));
    try {
      bool changed = false;
      const JointOrder& found = orders_[stream].order_of(size, points, changed);
      if (changed) result.corrected.emplace_back(JointsInput::kOrder, stream + ": " + found.name);
      return found;
    } catch (const std::invalid_argument& error) {
      throw DecodeError(DecodeError::Kind::unknown_order, error.what());
    }
  };
  TrackerFrame frame;
  frame.joints = joints_from_points(tracked, side, order_of);
  if (!has_both_hands(tracked)) frame.side = side;
  return frame;
}

}  // namespace mrhi
