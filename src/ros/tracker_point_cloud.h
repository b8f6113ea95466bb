#pragma once

#include <sensor_msgs/PointCloud.h>

#include "bounded_message.h"
#include "tracked_points.h"

namespace mrhi {

/// Channel "radius": from each joint to the skin [m]. Channel "confidence": 0 to 1 for each joint; their mean
/// is the hand's.
struct PointCloudTracker {
  static constexpr const char* kType = "sensor_msgs/PointCloud";
  static std::vector<std::string> topics() { return hands_topics("point_cloud"); }
  static std::vector<std::string> md5s() { return {ros::message_traits::md5sum<sensor_msgs::PointCloud>()}; }

  template <class Message>
  static TrackedPoints read(const Message& message) {
    TrackedPoints tracked{header_of(message.header), {}, {}};
    for (const auto& point : message.points)
      tracked.points.push_back(Eigen::Vector3f(point.x, point.y, point.z).cast<double>());
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
  static TrackerMessage read(const std::string& /*md5*/, std::vector<std::uint8_t>& bytes) {
    return read(deserialised<sensor_msgs::PointCloud_<Bounded>>(kType, bytes));
  }
};

}  // namespace mrhi
