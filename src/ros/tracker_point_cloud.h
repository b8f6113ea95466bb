#pragma once

#include <sensor_msgs/PointCloud.h>

#include "tracked_points.h"

namespace mrhi {

/// Channels are not used.
struct PointCloudTracker {
  using Message = sensor_msgs::PointCloud;
  static constexpr const char* kTopic = "point_cloud";

  static TrackedPoints read(const Message& message) {
    TrackedPoints tracked{message.header, {}};
    for (const geometry_msgs::Point32& point : message.points)
      tracked.points.push_back(Eigen::Vector3f(point.x, point.y, point.z).cast<double>());
    return tracked;
  }
};

}  // namespace mrhi
