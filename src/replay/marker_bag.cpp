#include "marker_bag.h"

#include <rosbag/bag.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <stdexcept>

#include "../text/file_text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"

namespace mrhi {
namespace {

visualization_msgs::MarkerArray markers_of(const Simulation& simulation) {
  std_msgs::Header header;
  header.frame_id = "world";
  header.stamp = to_ros_time(simulation.result().stamp);
  Markers markers(simulation.scene(), simulation.configuration());
  visualization_msgs::MarkerArray all, rest;
  markers.update(simulation.result(), simulation.state(), header, all);
  markers.update_rest(simulation.result(), simulation.state(), header, rest);
  all.markers.insert(all.markers.end(), rest.markers.begin(), rest.markers.end());
  for (visualization_msgs::Marker& marker : all.markers) marker.lifetime = ros::Duration();
  return all;
}

}  // namespace

struct MarkerBag::Impl {
  std::string file;
  std::set<std::size_t> frames;
  std::size_t frame = 0;
  rosbag::Bag bag;
};

MarkerBag::MarkerBag(const std::string& file, const std::set<std::size_t>& frames)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  impl_->frames = frames;
}

MarkerBag::~MarkerBag() = default;

void MarkerBag::watch(const Simulation& simulation) try {
  if (!impl_->bag.isOpen()) {
    check_may_be_written(impl_->file);
    impl_->bag.open(impl_->file, rosbag::bagmode::Write);
    impl_->bag.setCompression(rosbag::compression::LZ4);
  }
  const std::size_t frame = impl_->frame++;
  if (impl_->frames.count(frame) == 0) return;
  const ros::Time stamp =
      std::max(to_ros_time(simulation.result().stamp), ros::TIME_MIN);  // no bag takes a stamp of 0
  std_msgs::UInt32 number;
  number.data = static_cast<std::uint32_t>(frame);
  impl_->bag.write("/frame", stamp, number);
  impl_->bag.write("/markers", stamp, markers_of(simulation));
} catch (const rosbag::BagException& error) {
  throw std::runtime_error("cannot write " + impl_->file + ": " + error.what());
}

}  // namespace mrhi
