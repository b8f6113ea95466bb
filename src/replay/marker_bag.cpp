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
  // Bags have no stamp of 0.
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

/// Latched: rosbag play sends it to late subscribers, too.
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

/// Properties of a body that a change may alter: name and both frictions.
using Appearance = std::tuple<std::string, double, double>;

class MarkerBag {
 public:
  MarkerBag(const std::string& of_file, const std::optional<double>& at_rate,
            const std::set<std::size_t>& of_frames)
      : file_(of_file), frames_(of_frames), rate_(at_rate) {}

  void write(const Simulation& simulation) try {
    if (!bag_.isOpen()) {
      check_may_be_written(file_);
      bag_.open(file_, rosbag::bagmode::Write);
      bag_.setCompression(rosbag::compression::LZ4);
    }
    rate_ ? write_run(simulation) : write_frame(simulation);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error("cannot write " + file_ + ": " + error.what());
  }

 private:
  void write_frame(const Simulation& simulation) {
    std_msgs::UInt32 number;
    number.data = static_cast<std::uint32_t>(frame_++);
    if (frames_.count(number.data) == 0) return;
    const ros::Time stamp = header_of(simulation).stamp;
    bag_.write("/frame", stamp, number);
    bag_.write("/markers", stamp, markers_of(simulation));
  }

  void write_run(const Simulation& simulation) {
    const std_msgs::Header header = header_of(simulation);
    const FrameResult& result = simulation.result();
    std::vector<Appearance> bodies;
    for (const Body& body : simulation.scene().bodies)
      bodies.emplace_back(body.name, body.material.static_friction, body.material.dynamic_friction);
    if (!markers_ || bodies != drawn_) {
      drawn_ = std::move(bodies);
      markers_ = std::make_unique<Markers>(simulation.scene(), simulation.configuration());
      write_latched(bag_, "/scene", header.stamp,
                    scene_message(simulation.scene(), simulation.configuration(), header));
    }
    const Outcome outcome{simulation.scene(), result, simulation.state()};
    bag_.write("/contacts", header.stamp, contacts_message(outcome, header));
    bag_.write("/objects", header.stamp, objects_message(outcome, header));
    bag_.write("/rendered_hands", header.stamp, rendered_message(outcome, header));
    bag_.write("/tracked_hands", header.stamp, tracked_message(outcome, header));
    bag_.write("/rendered_view", header.stamp, view_message(outcome, header));
    markers_->note(result, header.stamp);
    const double since = seconds_between(shown_, header.stamp);
    if (since >= 0.0 && since < (1.0 - 1e-6) / *rate_) return;
    shown_ = header.stamp;
    visualization_msgs::MarkerArray array;
    markers_->update(result, simulation.state(), header, array);
    bag_.write("/markers", header.stamp, array);
  }

  std::string file_;
  std::set<std::size_t> frames_;
  std::optional<double> rate_;  ///< [Hz]; none: the frames alone
  std::size_t frame_ = 0;
  rosbag::Bag bag_;
  std::vector<Appearance> drawn_;  ///< the scene that was last written
  std::unique_ptr<Markers> markers_;
  ros::Time shown_;
};

}  // namespace

ViewWriter marker_bag(const std::string& file, const std::optional<double>& rate,
                      const std::set<std::size_t>& frames) {
  const auto bag = std::make_shared<MarkerBag>(file, rate, frames);
  return [bag](const Simulation& simulation) { bag->write(simulation); };
}

}  // namespace mrhi
