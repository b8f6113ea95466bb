#include "moment_markers.h"

#include <rosbag/bag.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../text/file_text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"

namespace mrhi {
namespace {

constexpr double kRecent = 0.25;    // [s]
constexpr double kBefore = 0.15;    // a loss [s]
constexpr double kBreak = 0.06;     // touches that are apart by less are one [s]
constexpr std::size_t kMost = 400;  // frames that are kept

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

}  // namespace

struct MomentMarkers::Kept {
  explicit Kept(const Simulation& simulation, double at)
      : time(at),
        scene(simulation.scene()),
        configuration(simulation.configuration()),
        result(simulation.result()),
        state(simulation.state()) {}

  MarkerArray markers() const {
    std_msgs::Header header;
    header.frame_id = "world";
    header.stamp = to_ros_time(result.stamp);
    Markers all(scene, configuration);
    MarkerArray array, rest;
    all.update(result, state, header, array);
    all.update_rest(result, state, header, rest);
    array.markers.insert(array.markers.end(), rest.markers.begin(), rest.markers.end());
    for (Marker& marker : array.markers) marker.lifetime = ros::Duration();
    return array;
  }

  double time;
  Scene scene;
  Configuration configuration;
  FrameResult result;
  SimulationState state;
};

MomentMarkers::MomentMarkers() = default;
MomentMarkers::~MomentMarkers() = default;

void MomentMarkers::watch(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  if (!first_) first_ = result.stamp;
  const double time = to_seconds(result.stamp - *first_);
  std::map<std::string, bool> touched;
  for (const Contact& contact : result.contacts)
    if (contact.touching() || !contact.impulse.isZero(0.0))
      touched[simulation.scene().bodies[contact.key.body].name] = true;
  if (!touched.empty()) recent_.push_back(std::make_shared<const Kept>(simulation, time));
  while (!recent_.empty() && time - recent_.front()->time > kRecent) recent_.pop_front();
  for (const Event& event : result.events)
    if (event.kind == EventKind::grasp_begin && !touched.empty() && kept_.size() < kMost)
      kept_[time] = recent_.back();
  for (const auto& [name, is] : touched) {
    Touched& object = objects_[name];
    object.touched = is;
    object.last = time;
    object.at_last = recent_.back();
    for (const auto& kept : recent_)
      if (!object.before || kept->time <= time - kBefore) object.before = kept;
    if (object.before->time < time - kRecent) object.before = recent_.front();
  }
  for (auto& [name, object] : objects_) {
    if (!object.touched || time - object.last <= kBreak) continue;
    keep(object);
    object = {};
  }
}

void MomentMarkers::keep(const Touched& touched) {
  if (kept_.size() >= kMost) return;
  kept_[touched.before->time] = touched.before;
  kept_[touched.at_last->time] = touched.at_last;
}

void MomentMarkers::write(const std::vector<PictureMoment>& moments, const std::string& file) const try {
  check_may_be_written(file);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(rosbag::compression::LZ4);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const auto after = kept_.lower_bound(moments[i].time - 0.02);
    if (after == kept_.end() || after->first > moments[i].time + 0.02) continue;
    auto nearest = after;
    for (auto other = after; other != kept_.end() && other->first <= moments[i].time + 0.02; ++other)
      if (std::abs(other->first - moments[i].time) < std::abs(nearest->first - moments[i].time))
        nearest = other;
    const ros::Time stamp = std::max(to_ros_time(nearest->second->result.stamp), ros::TIME_MIN);
    std_msgs::UInt32 number;
    number.data = static_cast<std::uint32_t>(i);
    bag.write("/moment", stamp, number);
    bag.write("/markers", stamp, nearest->second->markers());
  }
} catch (const rosbag::BagException& error) {
  throw std::runtime_error("cannot write " + file + ": " + error.what());
}

}  // namespace mrhi
