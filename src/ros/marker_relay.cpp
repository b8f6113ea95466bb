#include "marker_relay.h"

#include <algorithm>
#include <stdexcept>

#include "../text/text.h"
#include "node.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kAfresh = 1.0;  // what was lost on the way is made up for after this long [s]

std::set<std::string> left_out_from(const ros::NodeHandle& parameters) {
  refuse_unknown(parameters, {"leave_out", "rate"});
  std::string names;
  read_parameter(parameters, "leave_out", "a string", names);
  const std::vector<std::string> left_out = text::split(names);
  return {left_out.begin(), left_out.end()};
}

double rate_from(const ros::NodeHandle& parameters) {
  double rate = 30.0;
  read_parameter(parameters, "rate", "a number", rate);
  if (rate >= 1.0 && rate <= 1000.0) return rate;
  throw std::invalid_argument("rate is " + std::to_string(rate) + ": use 1 to 1000");
}

Marker deletion(const std_msgs::Header& header, int action) {
  Marker marker;
  marker.header = header;
  marker.action = action;
  marker.pose.orientation.w = 1.0;
  return marker;
}

}  // namespace

void MarkerThinner::take(const MarkerArray::ConstPtr& array) {
  for (const Marker& marker : array->markers) {
    header_ = marker.header;
    came_ = true;
    if (marker.action == Marker::DELETEALL) {
      shown_.clear();
      changed_.clear();
      start_afresh();
      continue;
    }
    if (left_out_.count(marker.ns) > 0) continue;
    const Key key{marker.ns, marker.id};
    if (marker.action == Marker::DELETE) shown_.erase(key);
    if (marker.action == Marker::ADD) shown_[key] = marker;
    changed_.insert(key);
  }
}

MarkerArray MarkerThinner::next() {
  MarkerArray array;
  if (!came_) return array;
  if (afresh_) {
    array.markers.push_back(deletion(header_, Marker::DELETEALL));
    for (const auto& [key, marker] : shown_) array.markers.push_back(marker);
  } else {
    for (const Key& key : changed_) add_change(key, array);
  }
  changed_.clear();
  came_ = afresh_ = false;
  return array;
}

void MarkerThinner::add_change(const Key& key, MarkerArray& array) const {
  const auto shown = shown_.find(key);
  if (shown != shown_.end()) {
    array.markers.push_back(shown->second);
    return;
  }
  array.markers.push_back(deletion(header_, Marker::DELETE));
  array.markers.back().ns = key.first;
  array.markers.back().id = key.second;
}

MarkerRelay::MarkerRelay(ros::NodeHandle node, const ros::NodeHandle& parameters)
    : node_(node), thinner_(left_out_from(parameters)) {
  const double rate = rate_from(parameters);
  afresh_after_ = std::max(1, static_cast<int>(kAfresh * rate));
  const auto changed = [this](const ros::SingleSubscriberPublisher&) { viewers_changed(); };
  publisher_ = node_.advertise<MarkerArray>("view/markers", 1, changed, changed);
  timer_ =
      node_.createWallTimer(ros::WallDuration(1.0 / rate), [this](const ros::WallTimerEvent&) { send(); });
}

void MarkerRelay::viewers_changed() {
  thinner_.start_afresh();
  const bool wanted = publisher_.getNumSubscribers() > 0;
  if (!wanted) subscriber_.shutdown();
  if (wanted && !subscriber_)
    subscriber_ =
        node_.subscribe("markers", 10, &MarkerThinner::take, &thinner_, ros::TransportHints().tcpNoDelay());
}

void MarkerRelay::send() {
  const MarkerArray array = thinner_.next();
  if (array.markers.empty()) return;
  publisher_.publish(array);
  if (++sent_ % afresh_after_ == 0) thinner_.start_afresh();
}

}  // namespace mrhi
