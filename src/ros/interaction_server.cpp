#include "mr_hand_interaction/ros/interaction_server.h"

#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <visualization_msgs/MarkerArray.h>

#include <chrono>
#include <stdexcept>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/ros/result_conversion.h"

namespace mrhi {
namespace {

constexpr int kQueue = 10;
constexpr Nanoseconds kSlack = 100'000'000;  // a frame may be that late after all
const ros::WallDuration kIdlePeriod(1.0 / 30);
const ros::WallDuration kMarkerPeriod(1.0 / 75);  // a display does not show more

Scene scene_of(const ServerParameters& parameters) {
  Scene scene =
      load_scene(find_scene_file(parameters.scene, scene_folders()), scene_options(parameters.configuration));
  for (const auto& [name, twist] : parameters.object_twists) free_body(scene, name).start_twist = twist;
  return scene;
}

std::string without_slash(const std::string& frame_id) {
  return frame_id.compare(0, 1, "/") == 0 ? frame_id.substr(1) : frame_id;
}

}  // namespace

InteractionServer::InteractionServer(ros::NodeHandle node, ros::NodeHandle private_node,
                                     const ServerParameters& parameters)
    : fixed_frame_(parameters.fixed_frame),
      simulation_(scene_of(parameters), parameters.configuration),
      markers_(simulation_.scene(), simulation_.configuration()),
      diagnostics_(node, private_node, simulation_.scene().name),
      haptics_(node, parameters.haptics_rate) {
  rendered_hands_ = node.advertise<mr_hand_interaction::HandFrame>("rendered_hands", kQueue);
  objects_ = node.advertise<mr_hand_interaction::ObjectStateArray>("objects", kQueue);
  contacts_ = node.advertise<mr_hand_interaction::ContactArray>("contacts", kQueue);
  events_ = node.advertise<mr_hand_interaction::InteractionEvent>("interaction_events", 100);
  marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>("markers", kQueue);
  using Reset = std_srvs::Trigger;
  using Pause = std_srvs::SetBool;
  reset_ = private_node.advertiseService<Reset::Request, Reset::Response>(
      "reset", [this](Reset::Request&, Reset::Response& response) { return reset(response); });
  pause_ = private_node.advertiseService<Pause::Request, Pause::Response>(
      "pause",
      [this](Pause::Request& request, Pause::Response& response) { return pause(request.data, response); });
  idle_timer_ = node.createWallTimer(kIdlePeriod, [this](const ros::WallTimerEvent&) { idle(); });
  hands_ = node.subscribe("hand_frame", kQueue, &InteractionServer::take, this,
                          ros::TransportHints().tcpNoDelay());
}

void InteractionServer::take(const mr_hand_interaction::HandFrame& message) {
  if (clock_.paused()) {
    clock_.take(from_ros_time(message.header.stamp), ros::Time::now());
    diagnostics_.dropped_while_paused();
    return;
  }
  if (!begin(message)) return;
  while (timed_step()) haptics_.note_step(simulation_, clock_.to_stamp(simulation_.time()));
  const FrameResult& result = simulation_.end();
  publish(result);
  const ros::Time now = ros::Time::now();
  diagnostics_.taken((now - message.header.stamp).toSec());
  clock_.take(from_ros_time(message.header.stamp), now);
}

bool InteractionServer::begin(const mr_hand_interaction::HandFrame& message) {
  if (without_slash(message.header.frame_id) != without_slash(fixed_frame_)) {
    diagnostics_.rejected("wrong frame", "'" + message.header.frame_id + "'; allowed: " + fixed_frame_);
    return false;
  }
  try {
    HandFrame frame = from_message(message);
    frame.stamp = clock_.to_simulation(frame.stamp);
    const Rejection rejection = simulation_.begin(frame);
    if (rejection == Rejection::none) return true;
    diagnostics_.rejected(to_string(rejection), std::to_string(message.header.stamp.toSec()) + " s");
  } catch (const std::invalid_argument& error) {
    diagnostics_.rejected("unusable hand", error.what());
  }
  return false;
}

bool InteractionServer::timed_step() {
  const auto begin = std::chrono::steady_clock::now();
  if (!simulation_.step()) return false;
  const auto time = std::chrono::steady_clock::now() - begin;
  diagnostics_.step(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
  return true;
}

void InteractionServer::idle() {
  const ros::Time now = ros::Time::now();
  const Nanoseconds stamp = clock_.stamp(now);
  if (!clock_.paused() && simulation_.state().started &&
      simulation_.advance_without_hands(clock_.to_simulation(stamp) - kSlack)) {
    publish(simulation_.result());
  } else if (ros::WallTime::now() - published_ > kIdlePeriod * 0.5) {
    publish_scene(simulation_.result(), to_ros_time(stamp));
  }
}

bool InteractionServer::reset(std_srvs::Trigger::Response& response) {
  simulation_.reset();
  markers_.clear();
  FrameResult start;
  start.stamp = clock_.to_simulation(clock_.stamp(ros::Time::now()));
  markers_published_ = {};
  publish(start);
  response.success = true;
  response.message = "scene " + simulation_.scene().name + " is at its start";
  return true;
}

bool InteractionServer::pause(bool paused, std_srvs::SetBool::Response& response) {
  paused ? clock_.pause(ros::Time::now()) : clock_.resume(ros::Time::now());
  response.success = true;
  response.message = paused ? "paused" : "running";
  return true;
}

void InteractionServer::publish(const FrameResult& result) {
  std_msgs::Header header;
  header.stamp = to_ros_time(clock_.to_stamp(result.stamp));
  header.frame_id = fixed_frame_;
  rendered_hands_.publish(rendered_message(result, header));
  contacts_.publish(contacts_message(simulation_.scene(), result, simulation_.state(), header));
  for (const Event& event : result.events) {
    std_msgs::Header when = header;
    when.stamp = to_ros_time(clock_.to_stamp(event.stamp));
    events_.publish(event_message(simulation_.scene(), event, when));
  }
  haptics_.publish(simulation_, result, header);
  publish_scene(result, header.stamp);
}

void InteractionServer::publish_scene(const FrameResult& result, const ros::Time& stamp) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = fixed_frame_;
  objects_.publish(objects_message(simulation_.scene(), simulation_.state(), header));
  if (stamp != transforms_stamp_) {  // tf2 warns of a stamp that it has
    transforms_.sendTransform(object_transforms(simulation_.scene(), simulation_.state(), header));
    transforms_stamp_ = stamp;
  }
  publish_markers(result, header);
  published_ = ros::WallTime::now();
}

void InteractionServer::publish_markers(const FrameResult& result, const std_msgs::Header& header) {
  const ros::WallTime now = ros::WallTime::now();
  if (marker_publisher_.getNumSubscribers() == 0 || now - markers_published_ < kMarkerPeriod) return;
  marker_publisher_.publish(markers_.update(result, simulation_.state(), header));
  markers_published_ = now;
}

}  // namespace mrhi
