#include "bag_input.h"

#include <mr_hand_interaction/HandFrame.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include "../ros/tracker_messages.h"
#include "../ros/transform_memory.h"
#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/hand_pairs.h"
#include "mr_hand_interaction/tracking/joint_gaps.h"

namespace mrhi {
namespace {

std::set<std::string> known_types() {
  std::set<std::string> types{"leap_motion/Human", "mr_hand_interaction/HandFrame"};
  for_each_tracker([&types](auto tracker) {
    types.insert(ros::message_traits::datatype<typename decltype(tracker)::Message>());
  });
  return types;
}

/// What other trackers' hands are on belongs together.
std::set<std::string> known_point_topics() {
  std::set<std::string> topics;
  for_each_tracker([&topics](auto tracker) {
    for (const std::string& topic : topics_of(tracker)) topics.insert("/" + topic);
  });
  return topics;
}

const std::set<std::string> kTypes = known_types();
const std::set<std::string> kPointTopics = known_point_topics();
const std::string kLeapTopic = "/leap_motion/leap_device";
std::string joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::set<std::string> chosen_topics(const std::string& file, const rosbag::Bag& bag,
                                    const std::optional<std::string>& wanted) {
  std::set<std::string> fitting;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections()) {
    if (kTypes.count(connection->datatype) > 0) fitting.insert(connection->topic);
  }
  if (wanted) {
    for (const std::string& topic : {*wanted, "/" + *wanted}) {
      if (fitting.count(topic) > 0) return {topic};
    }
    throw BagError(file + ": no topic '" + *wanted + "' with hands; allowed: " + joined(fitting));
  }
  if (fitting.count(kLeapTopic) > 0) return {kLeapTopic};
  std::set<std::string> points;
  std::set_intersection(fitting.begin(), fitting.end(), kPointTopics.begin(), kPointTopics.end(),
                        std::inserter(points, points.end()));
  if (!points.empty()) return points;
  if (fitting.size() == 1) return fitting;
  throw BagError(file + (fitting.empty() ? ": no topic has hands; allowed types: " + joined(kTypes)
                                         : ": --topic must choose one of " + joined(fitting)));
}

SourceFrame refused(const std::string& reason, const std::string& detail) {
  SourceFrame frame;
  frame.reason = reason;
  frame.detail = detail;
  return frame;
}

const std::string& readable(const std::string& file) {
  check_readable(file);
  return file;
}

const char* const kWorld = "world";
const char* const kLeapFrame = "leap_hands";

/// A frame that nothing places.
class NoTransform : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where trackers stand in world: everywhere the same, if that was given; else as a bag's /tf_static and /tf
/// say, as far as that had come when the hands came. The Leap's own frame has a default mount.
class DeviceFrames {
 public:
  DeviceFrames(const rosbag::Bag& bag, const std::optional<Pose>& device_in_world)
      : given_(device_in_world),
        moving_(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf", "tf"})),
        next_(moving_.begin()) {
    rosbag::View fixed(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf_static", "tf_static"}));
    for (const rosbag::MessageInstance& message : fixed)
      each_in(message, [&](const auto& transform) { transforms_.set_fixed(transform); });
  }

  /// Of hands that were recorded at `arrival`. Throws NoTransform.
  Pose pose(const std::string& frame_id, Nanoseconds stamp, const ros::Time& arrival) {
    if (given_) return *given_;
    for (; next_ != moving_.end() && next_->getTime() <= arrival; ++next_)
      each_in(*next_,
              [&](const auto& transform) { transforms_.set(transform, from_ros_time(next_->getTime())); });
    if (transforms_.connects(kWorld, frame_id)) return place(frame_id, stamp);
    const std::string frame = frame_id.compare(0, 1, "/") == 0 ? frame_id.substr(1) : frame_id;
    if (frame == kLeapFrame) return default_device_mount();
    throw NoTransform("frame '" + text::one_line(frame_id, 64) +
                      "' has no transform to 'world'; allowed: one that the bag's /tf_static or /tf has, or "
                      "--hand-transform");
  }

 private:
  Pose place(const std::string& frame_id, Nanoseconds stamp) const {
    try {
      return transforms_.pose(kWorld, frame_id, stamp);
    } catch (const tf2::TransformException& error) {
      throw NoTransform(text::one_line(error.what()));
    }
  }

  template <class See>
  static void each_in(const rosbag::MessageInstance& message, const See& see) {
    const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
    if (!transforms) return;
    for (const geometry_msgs::TransformStamped& transform : transforms->transforms) see(transform);
  }

  std::optional<Pose> given_;
  TransformMemory transforms_;
  rosbag::View moving_;
  rosbag::View::iterator next_;
};

}  // namespace

struct BagInput::Impl {
  Impl(const std::string& of_file, const std::optional<std::string>& wanted,
       const std::optional<Pose>& device)
      : file(of_file),
        bag(readable(file), rosbag::bagmode::Read),
        topics(chosen_topics(file, bag, wanted)),
        topic(joined(topics)),
        view(bag, rosbag::TopicQuery(std::vector<std::string>(topics.begin(), topics.end()))),
        devices(bag, device),
        at(view.begin()) {}

  SourceFrame place(JointsFrame joints, const std::string& frame_id, const ros::Time& receipt) {
    if (joints.stamp == 0) joints.stamp = from_ros_time(receipt);
    const bool empty = joints.hands.empty();
    return placed(joints, empty ? Pose{} : devices.pose(frame_id, joints.stamp, receipt));
  }

  template <class Tracker>
  SourceFrame read_points(const rosbag::MessageInstance& message) {
    const auto found = message.instantiate<typename Tracker::Message>();
    if (!found) return refused("unknown version", message.getDataType() + " with md5 " + message.getMD5Sum());
    const TrackedPoints tracked = Tracker::read(*found);
    const std::string& frame_id = tracked.header.frame_id;
    const std::optional<Side> of_topic = side_of_topic(message.getTopic());
    const Side side = (of_topic ? of_topic : side_of_frame(frame_id)).value_or(Side::right);
    JointsFrame joints = joints_from_points(tracked, side);
    if (joints.stamp == 0) joints.stamp = from_ros_time(message.getTime());
    gaps.fill(joints);
    SourceFrame frame = place(std::move(joints), frame_id, message.getTime());
    if (!frame.frame || has_both_hands(tracked)) return frame;
    frame.frame = pairs.take(side, *frame.frame);
    frame.waits = !frame.frame;
    return frame;
  }

  SourceFrame read_hand_frame(const rosbag::MessageInstance& message) {
    const auto hands = message.instantiate<mr_hand_interaction::HandFrame>();
    if (!hands) return refused("unknown version", "HandFrame with md5 " + message.getMD5Sum());
    const std::string& frame_id = hands->header.frame_id;
    if (frame_id != "world" && frame_id != "/world") {
      return refused("wrong frame", "frame_id '" + frame_id + "'; allowed: world");
    }
    SourceFrame frame;
    frame.frame = from_message(*hands);
    return frame;
  }

  SourceFrame read(const rosbag::MessageInstance& message) {
    SourceFrame frame = read_hands(message);
    frame.arrival = from_ros_time(message.getTime());
    return frame;
  }

  SourceFrame read_hands(const rosbag::MessageInstance& message) {
    try {
      if (message.getDataType() == "leap_motion/Human") {
        LeapFrame frame = read_leap(message);
        return place(std::move(frame.joints), frame.frame_id, message.getTime());
      }
      if (message.getDataType() == "mr_hand_interaction/HandFrame") return read_hand_frame(message);
      SourceFrame frame =
          refused("unknown version", "type " + message.getDataType() + "; allowed: " + joined(kTypes));
      for_each_tracker([&](auto tracker) {
        using Tracker = decltype(tracker);
        if (message.getDataType() == ros::message_traits::datatype<typename Tracker::Message>())
          frame = read_points<Tracker>(message);
      });
      return frame;
    } catch (const DecodeError& error) {
      return refused(error.reason(), error.what());
    } catch (const ros::serialization::StreamOverrunException& error) {
      return refused("malformed", error.what());
    } catch (const NoTransform& error) {
      return refused("no transform", error.what());
    } catch (const std::invalid_argument& error) {
      return refused("unusable hand", error.what());
    }
  }

  std::string file;
  rosbag::Bag bag;
  std::set<std::string> topics;
  std::string topic;
  rosbag::View view;
  JointGaps gaps;
  HandPairs pairs;
  DeviceFrames devices;
  rosbag::View::iterator at;
  std::size_t position = 0;
};

BagInput::BagInput(const std::string& file, const std::optional<std::string>& topic,
                   const std::optional<Pose>& device_in_world) try
    : impl_(std::make_unique<Impl>(file, topic, device_in_world)) {
} catch (...) {
  refuse_bag(file);
}

BagInput::~BagInput() = default;

std::optional<SourceFrame> BagInput::next() try {
  while (impl_->at != impl_->view.end()) {
    SourceFrame frame = impl_->read(*impl_->at);
    ++impl_->at;
    ++impl_->position;
    if (!frame.waits) return frame;
  }
  SourceFrame last;
  last.frame = impl_->pairs.rest();
  if (!last.frame) return std::nullopt;
  return last;
} catch (...) {
  refuse_bag(impl_->file);
}

std::size_t BagInput::position() const {
  return impl_->position;
}
std::size_t BagInput::size() const {
  return impl_->view.size();
}
const std::string& BagInput::topic() const {
  return impl_->topic;
}

ReplayInput open_bag(const ReplayArguments& arguments) {
  auto bag = std::make_unique<BagInput>(arguments.input, arguments.topic, arguments.hand_transform);
  const std::string topic = bag->topic();
  return {std::move(bag), topic};
}

}  // namespace mrhi
