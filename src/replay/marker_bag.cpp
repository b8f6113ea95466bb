#include "inputs.h"

#include <rosbag/bag.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../ros/result_messages.h"
#include "../text/files.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"

namespace mrhi {
namespace {

std_msgs::Header header_of(const Simulation& simulation) {
  std_msgs::Header header;
  header.frame_id = "world";
  // No bag takes a stamp of 0.
  header.stamp = std::max(to_ros_time(simulation.result().stamp), ros::TIME_MIN);
  return header;
}

visualization_msgs::MarkerArray markers_of(const Simulation& simulation) {
  Markers markers(simulation.scene(), simulation.configuration());
  visualization_msgs::MarkerArray all;
  const std_msgs::Header header = header_of(simulation);
  markers.note(simulation.result(), header.stamp);
  markers.update(simulation.result(), simulation.state(), header, all);
  for (visualization_msgs::Marker& marker : all.markers) marker.lifetime = ros::Duration();
  return all;
}

/// rosbag play sends it to each viewer that comes later, too.
template <typename Message>
void write_latched(rosbag::Bag& bag, const std::string& topic, const ros::Time& stamp,
                   const Message& message) {
  auto connection = boost::make_shared<ros::M_string>();
  (*connection)["topic"] = topic;
  (*connection)["latching"] = "1";
  (*connection)["type"] = ros::message_traits::datatype(message);
  (*connection)["md5sum"] = ros::message_traits::md5sum(message);
  (*connection)["message_definition"] = ros::message_traits::definition(message);
  bag.write(topic, stamp, message, connection);
}

}  // namespace

/// What a change of the scene can change of a body: its name and both frictions.
using Look = std::tuple<std::string, double, double>;

struct MarkerBag::Impl {
  void open();
  void write_frame(const Simulation& simulation);
  void write_run(const Simulation& simulation);

  std::string file;
  std::set<std::size_t> frames;
  double rate = 0.0;  ///< [Hz]; 0: the frames alone
  std::size_t frame = 0;
  rosbag::Bag bag;
  std::vector<Look> drawn;  ///< the scene that was last written
  std::unique_ptr<Markers> markers;
  ros::Time shown;
};

MarkerBag::MarkerBag(const std::string& file, const std::set<std::size_t>& frames)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  impl_->frames = frames;
}

MarkerBag::MarkerBag(const std::string& file, double rate) : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  impl_->rate = rate;
}

MarkerBag::~MarkerBag() = default;

void MarkerBag::watch(const Simulation& simulation) try {
  impl_->open();
  impl_->rate > 0.0 ? impl_->write_run(simulation) : impl_->write_frame(simulation);
} catch (const rosbag::BagException& error) {
  throw std::runtime_error("cannot write " + impl_->file + ": " + error.what());
}

void MarkerBag::Impl::open() {
  if (bag.isOpen()) return;
  check_may_be_written(file);
  bag.open(file, rosbag::bagmode::Write);
  bag.setCompression(rosbag::compression::LZ4);
}

void MarkerBag::Impl::write_frame(const Simulation& simulation) {
  std_msgs::UInt32 number;
  number.data = static_cast<std::uint32_t>(frame++);
  if (frames.count(number.data) == 0) return;
  const ros::Time stamp = header_of(simulation).stamp;
  bag.write("/frame", stamp, number);
  bag.write("/markers", stamp, markers_of(simulation));
}

void MarkerBag::Impl::write_run(const Simulation& simulation) {
  const std_msgs::Header header = header_of(simulation);
  const FrameResult& result = simulation.result();
  std::vector<Look> looks;
  for (const Body& body : simulation.scene().bodies)
    looks.emplace_back(body.name, body.material.static_friction, body.material.dynamic_friction);
  if (!markers || looks != drawn) {
    drawn = std::move(looks);
    markers = std::make_unique<Markers>(simulation.scene(), simulation.configuration());
    write_latched(bag, "/scene", header.stamp,
                  scene_message(simulation.scene(), simulation.configuration(), header));
  }
  bag.write("/contacts", header.stamp,
            contacts_message(simulation.scene(), result, simulation.state(), header));
  bag.write("/objects", header.stamp,
            objects_message(simulation.scene(), result, simulation.state(), header));
  bag.write("/rendered_hands", header.stamp, rendered_message(result, header));
  bag.write("/tracked_hands", header.stamp, tracked_message(result, header));
  markers->note(result, header.stamp);
  const double since = seconds_between(shown, header.stamp);
  if (since >= 0.0 && since < (1.0 - 1e-6) / rate) return;
  shown = header.stamp;
  visualization_msgs::MarkerArray array;
  markers->update(result, simulation.state(), header, array);
  bag.write("/markers", header.stamp, array);
}

}  // namespace mrhi
