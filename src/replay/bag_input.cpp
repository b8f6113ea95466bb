#include "bag_input.h"

#include <geometry_msgs/PoseArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include "../ros/pose_array_hand.h"
#include "bag_check.h"
#include "device_frames.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/tracking/hand_pairs.h"
#include "open_bag.h"

namespace mrhi {
namespace {

const std::set<std::string> kTypes{"leap_motion/Human", "geometry_msgs/PoseArray",
                                   "mr_hand_interaction/HandFrame"};
const std::string kLeapTopic = "/leap_motion/leap_device";
/// What other trackers' hands are on belongs together.
const std::set<std::string> kPoseArrayTopics{"/hands/pose_array", "/hands/left/pose_array",
                                             "/hands/right/pose_array"};

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
  std::set<std::string> pose_arrays;
  std::set_intersection(fitting.begin(), fitting.end(), kPoseArrayTopics.begin(), kPoseArrayTopics.end(),
                        std::inserter(pose_arrays, pose_arrays.end()));
  if (!pose_arrays.empty()) return pose_arrays;
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

}  // namespace

struct BagInput::Impl {
  Impl(const std::string& file, const std::optional<std::string>& wanted, const std::optional<Pose>& device)
      : bag(readable(file), rosbag::bagmode::Read),
        topics(chosen_topics(file, bag, wanted)),
        topic(joined(topics)),
        view(bag, rosbag::TopicQuery(std::vector<std::string>(topics.begin(), topics.end()))),
        devices(bag, device),
        at(view.begin()) {}

  /// Bags are made of many recorders' connections; each has a definition of its own.
  const LeapHumanDecoder& decoder(const std::string& definition) {
    auto& found = decoders[definition];
    if (!found) found = std::make_unique<const LeapHumanDecoder>(definition);
    return *found;
  }

  SourceFrame place(JointsFrame joints, const std::string& frame_id, const ros::Time& receipt) {
    if (joints.stamp == 0) joints.stamp = from_ros_time(receipt);
    return placed(joints, devices.pose(frame_id));
  }

  SourceFrame read_leap(const rosbag::MessageInstance& message) {
    buffer.resize(message.size());
    ros::serialization::OStream stream(buffer.data(), static_cast<std::uint32_t>(buffer.size()));
    message.write(stream);
    LeapHumanDecoder::Frame frame =
        decoder(message.getMessageDefinition()).decode(buffer.data(), buffer.size());
    return place(std::move(frame.joints), frame.frame_id, message.getTime());
  }

  SourceFrame read_pose_array(const rosbag::MessageInstance& message) {
    const auto array = message.instantiate<geometry_msgs::PoseArray>();
    if (!array) return refused("unknown version", "geometry_msgs/PoseArray with md5 " + message.getMD5Sum());
    const std::string& frame_id = array->header.frame_id;
    const std::optional<Side> of_topic = side_by_name(message.getTopic());
    const Side side = (of_topic ? of_topic : side_by_name(frame_id)).value_or(Side::right);
    SourceFrame frame = place(joints_from_pose_array(*array, side), frame_id, message.getTime());
    if (!frame.frame || has_both_hands(*array)) return frame;
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
      if (message.getDataType() == "leap_motion/Human") return read_leap(message);
      if (message.getDataType() == "geometry_msgs/PoseArray") return read_pose_array(message);
      if (message.getDataType() == "mr_hand_interaction/HandFrame") return read_hand_frame(message);
      return refused("unknown version", "type " + message.getDataType() + "; allowed: " + joined(kTypes));
    } catch (const DecodeError& error) {
      return refused(error.reason(), error.what());
    } catch (const ros::serialization::StreamOverrunException& error) {
      return refused("malformed", error.what());
    } catch (const std::invalid_argument& error) {
      return refused("unusable hand", error.what());
    }
  }

  rosbag::Bag bag;
  std::set<std::string> topics;
  std::string topic;
  rosbag::View view;
  HandPairs pairs;
  DeviceFrames devices;
  rosbag::View::iterator at;
  std::size_t position = 0;
  std::map<std::string, std::unique_ptr<const LeapHumanDecoder>> decoders;
  std::vector<std::uint8_t> buffer;
};

BagInput::BagInput(const std::string& file, const std::optional<std::string>& topic,
                   const std::optional<Pose>& device_in_world) try
    : impl_(std::make_unique<Impl>(file, topic, device_in_world)) {
} catch (...) {
  refuse_bag(file);
}

BagInput::~BagInput() = default;

std::optional<SourceFrame> BagInput::next() {
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
