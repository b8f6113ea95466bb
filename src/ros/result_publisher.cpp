#include "result_publisher.h"

#include <geometry_msgs/Point.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <ros/message_traits.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include <boost/make_shared.hpp>
#include <utility>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "result_conversion.h"
#include "scene_view.h"

// In memory these are what goes over the wire: roscpp copies a vector of them in one go.
static_assert(sizeof(geometry_msgs::Point) == 3 * sizeof(double), "a point has padding");
static_assert(sizeof(std_msgs::ColorRGBA) == 4 * sizeof(float), "a colour has padding");
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "messages are little-endian");

namespace ros {
namespace message_traits {
template <>
struct IsSimple<geometry_msgs::Point> : TrueType {};
template <>
struct IsSimple<std_msgs::ColorRGBA> : TrueType {};
}  // namespace message_traits
}  // namespace ros

namespace mrhi {
namespace {

constexpr int kQueue = 10;
constexpr int kEventQueue = 100;

/// Shared, so that a subscriber in the same process gets it without a copy.
template <class Message>
void publish_shared(const ros::Publisher& publisher, Message&& message) {
  publisher.publish(boost::make_shared<std::decay_t<Message>>(std::forward<Message>(message)));
}

}  // namespace

ResultPublisher::ResultPublisher(ros::NodeHandle node, const std::string& fixed_frame, HapticsRate haptics,
                                 const StampClock& clock)
    : fixed_frame_(fixed_frame),
      clock_(clock),
      haptics_(node, haptics),
      rendered_hands_(node.advertise<mr_hand_interaction::HandFrame>("rendered_hands", kQueue)),
      tracked_hands_(node.advertise<mr_hand_interaction::HandFrame>("tracked_hands", kQueue)),
      objects_(node.advertise<mr_hand_interaction::ObjectStateArray>("objects", kQueue)),
      joint_states_(node.advertise<sensor_msgs::JointState>("joint_states", kQueue)),
      contacts_(node.advertise<mr_hand_interaction::ContactArray>("contacts", kQueue)),
      events_(node.advertise<mr_hand_interaction::InteractionEvent>("interaction_events", kEventQueue)),
      marker_publisher_(
          node.advertise<visualization_msgs::MarkerArray>("markers", kQueue,
                                                          [this](const ros::SingleSubscriberPublisher&) {
                                                            if (markers_) markers_->send_all();
                                                          })),
      scene_publisher_(node.advertise<mr_hand_interaction::SceneDescription>("scene", 1, true)),
      picture_(boost::make_shared<visualization_msgs::MarkerArray>()) {}

void ResultPublisher::add_standard_outputs(const ros::NodeHandle& node) {
  standard_.emplace(node);
}

void ResultPublisher::show(const Simulation& simulation) {
  simulation_ = &simulation;
  markers_ = std::make_unique<Markers>(simulation.scene(), simulation.configuration());
  markers_shown_ = ros::WallTime();
  scene_changed_ = true;
}

void ResultPublisher::note_step() {
  haptics_.note_step(*simulation_, clock_.to_stamp(simulation_->time()));
}

void ResultPublisher::publish(const FrameResult& result) {
  publish_response(result);
  publish_picture(result);
}

void ResultPublisher::publish_response(const FrameResult& result) {
  const std_msgs::Header when = header(result);
  publish_scene_description();
  haptics_.publish(*simulation_, result, when);
  publish_contacts(result, when);
  publish_objects(when);
  if (standard_) standard_->publish(simulation_->scene(), result, simulation_->state(), when);
}

void ResultPublisher::publish_picture(const FrameResult& result) {
  const std_msgs::Header when = header(result);
  publish_hands(result, when);
  publish_transforms(when);
  if (standard_) standard_->publish_hands(result, when);
  publish_events(result.events);
  publish_markers(result, when);
}

void ResultPublisher::publish_scene(const FrameResult& result, const ros::Time& stamp) {
  publish_scene_description();
  if (!result.rendered.empty()) {
    publish_contacts(result, header(result));
    publish_hands(result, header(result));
  }
  publish_objects(header(stamp));
  publish_transforms(header(stamp));
  if (standard_) standard_->publish_objects(simulation_->scene(), simulation_->state(), header(stamp));
  publish_markers(result, header(stamp));
  shown_ = ros::WallTime::now();
}

/// Before all that is of the scene.
void ResultPublisher::publish_scene_description() {
  if (!std::exchange(scene_changed_, false)) return;
  publish_shared(scene_publisher_, scene_message(simulation_->scene(), simulation_->configuration(),
                                                 header(to_ros_time(clock_.to_stamp(simulation_->time())))));
}

void ResultPublisher::publish_hands(const FrameResult& result, const std_msgs::Header& header) {
  if (rendered_hands_.getNumSubscribers() > 0)
    publish_shared(rendered_hands_, rendered_message(result, header));
  if (tracked_hands_.getNumSubscribers() > 0) publish_shared(tracked_hands_, tracked_message(result, header));
  shown_ = ros::WallTime::now();
}

void ResultPublisher::publish_contacts(const FrameResult& result, const std_msgs::Header& header) {
  if (contacts_.getNumSubscribers() == 0) return;
  publish_shared(contacts_, contacts_message(simulation_->scene(), result, simulation_->state(), header));
}

void ResultPublisher::publish_events(const std::vector<Event>& events) {
  for (const Event& event : events) {
    const std_msgs::Header when = header(to_ros_time(clock_.to_stamp(event.stamp)));
    publish_shared(events_, event_message(simulation_->scene(), simulation_->result(), event, when));
  }
}

std_msgs::Header ResultPublisher::header(const ros::Time& stamp) const {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = fixed_frame_;
  return header;
}

std_msgs::Header ResultPublisher::header(const FrameResult& result) const {
  return header(to_ros_time(clock_.to_stamp(result.stamp)));
}

void ResultPublisher::publish_markers(const FrameResult& result, const std_msgs::Header& header) {
  if (marker_publisher_.getNumSubscribers() == 0) return;
  markers_->note(result, header.stamp);
  const ros::WallTime now = ros::WallTime::now();
  if (ros::WallDuration(now - markers_shown_).toSec() < 1.0 / kMarkerRate) return;
  markers_shown_ = now;
  // Nobody in this process still has the one before: its memory serves again.
  if (!picture_.unique()) picture_ = boost::make_shared<visualization_msgs::MarkerArray>();
  markers_->update(result, simulation_->state(), header, *picture_);
  marker_publisher_.publish(picture_);
}

void ResultPublisher::publish_objects(const std_msgs::Header& header) {
  if (objects_.getNumSubscribers() > 0)
    publish_shared(
        objects_, objects_message(simulation_->scene(), simulation_->result(), simulation_->state(), header));
  if (!simulation_->scene().joints.empty() && joint_states_.getNumSubscribers() > 0)
    publish_shared(joint_states_, joint_states_message(simulation_->scene(), simulation_->state(), header));
}

void ResultPublisher::publish_transforms(const std_msgs::Header& header) {
  if (header.stamp == transforms_stamp_) return;  // tf2 warns of a stamp that it has
  transforms_.sendTransform(object_transforms(simulation_->scene(), simulation_->state(), header));
  transforms_stamp_ = header.stamp;
}

}  // namespace mrhi
