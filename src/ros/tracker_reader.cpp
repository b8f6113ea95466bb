#include "tracker_reader.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "tracker_messages.h"

namespace mrhi {
namespace {

using Read = TrackerMessage (*)(const std::string& md5, std::vector<std::uint8_t>& bytes);

/// How to read a message, by its MD5, which does not depend on the type's name.
const std::map<std::string, Read>& readers() {
  static const std::map<std::string, Read> all = [] {
    std::map<std::string, Read> found;
    for_each_tracker([&found](auto tracker) {
      for (const std::string& md5 : tracker.md5s()) found[md5] = &decltype(tracker)::read;
    });
    return found;
  }();
  return all;
}

std::string joined(const std::set<std::string>& names) {
  return text::joined({names.begin(), names.end()});
}

[[noreturn]] void refuse_version(const std::string& type, const std::string& md5) {
  std::string allowed = joined(TrackerReader::types());
  for_each_tracker([&](auto tracker) {
    if (type == tracker.kType) allowed = "md5 " + text::joined(tracker.md5s());
  });
  throw DecodeError(DecodeError::Kind::unknown_version, "unknown version of " + text::one_line(type, 100) +
                                                            ": md5 " + md5 + "; allowed: " + allowed);
}

/// A bag may not know who published.
std::string stream_of(const TrackerReader::Message& message) {
  return message.topic + (message.publisher.empty() ? "" : " of " + message.publisher);
}

double checked_scale(double scale) {
  if (std::isfinite(scale) && scale > 0.0) return scale;
  throw std::invalid_argument("scale " + text::number(scale) +
                              " is not allowed; allowed: metres per unit of the tracker, above 0");
}

}  // namespace

TrackerReader::TrackerReader(const Options& options)
    : side_(options.side),
      order_(options.order.empty() ? nullptr : &joint_order(options.order)),
      input_(checked_scale(options.scale)) {}

std::set<std::string> TrackerReader::types() {
  std::set<std::string> types;
  for_each_tracker([&types](auto tracker) { types.insert(tracker.kType); });
  return types;
}

std::vector<std::string> TrackerReader::topics() {
  std::vector<std::string> topics;
  for_each_tracker([&topics](auto tracker) {
    for (const std::string& topic : tracker.topics()) topics.push_back(topic);
  });
  return topics;
}

SourceFrame TrackerReader::read(Message message, const Place& place, std::optional<std::uint32_t>* sequence) {
  SourceFrame result;
  try {
    const auto reader = readers().find(message.md5);
    if (reader == readers().end()) refuse_version(message.type, message.md5);
    TrackerMessage tracked = reader->second(message.md5, message.bytes);
    const std_msgs::Header header = std::visit([](const auto& t) { return t.header; }, tracked);
    if (sequence != nullptr) *sequence = header.seq;
    TrackerFrame frame =
        std::visit([&](auto&& t) { return frame_of(std::move(t), message, result); }, std::move(tracked));
    frame.stream = stream_of(message);
    frame.joints.stamp = from_ros_time(header.stamp);
    frame.receipt = message.receipt;
    const auto device = [&](Nanoseconds stamp) { return place(header.frame_id, stamp); };
    auto recognised = std::move(result.corrected);
    result = input_.take(std::move(frame), device);
    result.corrected.insert(result.corrected.begin(), recognised.begin(), recognised.end());
  } catch (const DecodeError& error) {
    result.reason = error.reason();
    result.detail = error.what();
  }
  result.arrival = message.receipt;
  return result;
}

/// Reports an order that is not the usual one.
TrackerFrame TrackerReader::frame_of(const TrackedPoints& tracked, const Message& message,
                                     SourceFrame& result) {
  const Side side = side_of(tracked.header.frame_id, message.topic);
  const std::string stream = stream_of(message);
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

TrackerFrame TrackerReader::frame_of(TrackedHands tracked, const Message& message, SourceFrame&) {
  TrackerFrame frame;
  frame.joints.hands = std::move(tracked.hands);
  if (tracked.tells_sides) return frame;
  frame.side = side_of(tracked.header.frame_id, message.topic);
  for (HandJoints& hand : frame.joints.hands) hand.side = *frame.side;
  return frame;
}

Side TrackerReader::side_of(const std::string& frame_id, const std::string& topic) const {
  const std::optional<Side> of_topic = side_of_topic(topic);
  return (of_topic ? of_topic : side_of_frame(frame_id)).value_or(side_);
}

}  // namespace mrhi
