#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <std_msgs/ColorRGBA.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "input_log.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/simulation.h"
#include "network_thread.h"
#include "result_messages.h"

// Memory layout equals the serialised form: roscpp copies a vector of these at once.
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
/// Publishes `haptics`, and `haptics/joints` if there are joints: a message per frame or per step.
class HapticsPublisher {
 public:
  HapticsPublisher(ros::NodeHandle& node, HapticsRate rate)
      : rate_(rate),
        publisher_(node.advertise<mr_hand_interaction::HapticsArray>("haptics", kQueue)),
        joint_publisher_(node.advertise<sensor_msgs::JointState>("haptics/joints", kQueue)) {}

  /// After each step: stores its contacts under the stamp of its end, until the frame is published.
  void note_step(const Simulation& simulation, Nanoseconds stamp) {
    if (rate_ != HapticsRate::step) return;
    std_msgs::Header header;
    header.stamp = to_ros_time(stamp);
    add(simulation, simulation.state().contacts, header);
  }

  /// Publishes the stored steps, or without any the frame itself, under its header.
  void publish(const Simulation& simulation, const FrameResult& result, const std_msgs::Header& header) {
    if (steps_.empty() && joint_steps_.empty()) add(simulation, result.contacts, header);
    publish_all(steps_, header, publisher_);
    publish_all(joint_steps_, header, joint_publisher_);
  }

 private:
  static constexpr int kQueue = 100;  // the steps of a few frames come at once

  template <typename Message>
  static void publish_all(std::vector<Message>& messages, const std_msgs::Header& header,
                          ros::Publisher& publisher) {
    for (const Message& message : messages) {
      message->header.frame_id = header.frame_id;
      publisher.publish(message);
    }
    messages.clear();
  }

  void add(const Simulation& simulation, const std::vector<Contact>& contacts,
           const std_msgs::Header& header) {
    const Scene& scene = simulation.scene();
    const SimulationState& state = simulation.state();
    if (publisher_.getNumSubscribers() > 0)
      steps_.push_back(boost::make_shared<mr_hand_interaction::HapticsArray>(
          haptics_message(scene, state, contacts, header)));
    if (!scene.joints.empty() && joint_publisher_.getNumSubscribers() > 0)
      joint_steps_.push_back(boost::make_shared<sensor_msgs::JointState>(
          joint_states_message({scene, simulation.result(), state}, header)));
  }

  HapticsRate rate_;
  ros::Publisher publisher_, joint_publisher_;
  std::vector<mr_hand_interaction::HapticsArrayPtr> steps_;
  std::vector<sensor_msgs::JointStatePtr> joint_steps_;
};

/// Publishes the results as standard messages, for subscribers without this package:
///    objects/NAME/pose (PoseStamped) and objects/NAME/wrench (WrenchStamped) of each free body. A topic has
///    _ for -, and ends in one more _ for each earlier topic of that name; held_object (String), latched and
///    on change; rendered_hands/left/pose_array and rendered_hands/right/pose_array (PoseArray).
class StandardOutputs {
 public:
  explicit StandardOutputs(const ros::NodeHandle& node)
      : node_(node),
        hands_{node_.advertise<geometry_msgs::PoseArray>("rendered_hands/left/pose_array", kQueue),
               node_.advertise<geometry_msgs::PoseArray>("rendered_hands/right/pose_array", kQueue)},
        held_(node_.advertise<std_msgs::String>("held_object", kQueue, true)) {}

  /// Updates the topics to the bodies of this scene.
  void show(const Scene& scene) {
    for (auto topics = objects_.begin(); topics != objects_.end();) {
      const auto body = find_body(scene, topics->first);
      topics = body && !scene.bodies[*body].fixed ? std::next(topics) : objects_.erase(topics);
    }
    for (const Body& body : scene.bodies)
      if (!body.fixed && objects_.count(body.name) == 0) objects_.emplace(body.name, new_topics(body.name));
  }

  /// Publishes objects; without a result only poses and which are held.
  void publish(const Scene& scene, const FrameResult* result, const SimulationState& state,
               const std_msgs::Header& header) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (scene.bodies[i].fixed) continue;
      const ObjectTopics& topics = objects_.at(scene.bodies[i].name);
      geometry_msgs::PoseStamped pose;
      pose.header = header;
      pose.pose = to_message(state.bodies[i].pose);
      topics.pose.publish(pose);
      if (result == nullptr) continue;
      geometry_msgs::WrenchStamped wrench;
      wrench.header = header;
      wrench.wrench = wrench_message(i, *result, state);
      topics.wrench.publish(wrench);
    }
    std_msgs::String held;
    held.data = held_objects(scene, state);
    if (last_held_ != held.data) held_.publish(held);
    last_held_ = held.data;
  }

  void publish_hands(const FrameResult& result, const std_msgs::Header& header) {
    for (const RenderedHand& rendered : result.rendered)
      hands_[static_cast<std::size_t>(rendered.hand.side)].publish(pose_array_message(rendered.hand, header));
  }

 private:
  static constexpr int kQueue = 10;

  struct ObjectTopics {
    std::string name;  // without /pose and /wrench
    ros::Publisher pose, wrench;
  };
  ObjectTopics new_topics(const std::string& body) {
    std::string name = "objects/" + body;
    std::replace(name.begin(), name.end(), '-', '_');
    const auto is_taken = [&name](const auto& other) { return other.second.name == name; };
    while (std::any_of(objects_.begin(), objects_.end(), is_taken)) name += '_';
    return {name, node_.advertise<geometry_msgs::PoseStamped>(name + "/pose", kQueue),
            node_.advertise<geometry_msgs::WrenchStamped>(name + "/wrench", kQueue)};
  }

  ros::NodeHandle node_;
  std::map<std::string, ObjectTopics> objects_;
  std::array<ros::Publisher, 2> hands_;  // by side
  ros::Publisher held_;
  std::optional<std::string> last_held_;
};

/// Publishes the results of a simulation to subscribers. A new topic needs its .msg, and its add() below.
class ResultPublisher {
 public:
  ResultPublisher(ros::NodeHandle node, const std::string& fixed_frame, HapticsRate haptics,
                  const StampClock& clock)
      : fixed_frame_(fixed_frame),
        clock_(clock),
        haptics_(node, haptics),
        events_(node.advertise<mr_hand_interaction::InteractionEvent>("interaction_events", kEventQueue)),
        scene_publisher_(node.advertise<mr_hand_interaction::SceneDescription>("scene", 1, true)),
        transforms_(node.advertise<tf2_msgs::TFMessage>("/tf", kTransformQueue)),
        picture_(boost::make_shared<visualization_msgs::MarkerArray>()) {
    descriptions_.start();
    marker_publisher_ =
        node.advertise<visualization_msgs::MarkerArray>("markers", kQueue, [this](const auto&) {
          if (markers_) markers_->send_all();
        });
    add<mr_hand_interaction::ContactArray>(node, "contacts", Moment::response, Shows::hands,
                                           contacts_message);
    add<mr_hand_interaction::ObjectStateArray>(node, "objects", Moment::response, Shows::objects,
                                               objects_message);
    add<sensor_msgs::JointState>(node, "joint_states", Moment::response, Shows::joints, joint_states_message);
    add<mr_hand_interaction::RenderedView>(node, "rendered_view", Moment::picture, Shows::view, view_message);
    add<mr_hand_interaction::HandFrame>(node, "rendered_hands", Moment::picture, Shows::hands,
                                        rendered_message);
    add<mr_hand_interaction::HandFrame>(node, "tracked_hands", Moment::picture, Shows::hands,
                                        tracked_message);
  }

  /// Also publishes the messages of StandardOutputs from now on.
  void add_standard_outputs(const ros::NodeHandle& node) { standard_.emplace(node); }

  /// Publishes this simulation from now on. Clears rviz's view first, so that removed bodies disappear.
  void show(const Simulation& simulation) {
    simulation_ = &simulation;
    markers_ = std::make_unique<Markers>(simulation.scene(), simulation.configuration());
    markers_shown_ = ros::SteadyTime();
    scene_changed_ = true;
    if (standard_) standard_->show(simulation.scene());
  }

  /// After each step of a frame.
  void note_step() { haptics_.note_step(*simulation_, clock_.to_stamp(simulation_->time())); }

  /// Publishes what robots and gloves wait for. Does not use the rendered hands of the result.
  void publish_response(const FrameResult& result) {
    const std_msgs::Header when = header(result);
    publish_scene_description();
    haptics_.publish(*simulation_, result, when);
    publish_outputs(Moment::response, result, when);
    if (standard_) standard_->publish(simulation_->scene(), &result, simulation_->state(), when);
  }

  /// Publishes the rendered hands, then transforms, events and, at most at kMarkerRate, markers.
  void publish_picture(const FrameResult& result) {
    const std_msgs::Header when = header(result);
    publish_outputs(Moment::picture, result, when);
    shown_ = ros::SteadyTime::now();
    publish_transforms(when);
    if (standard_) standard_->publish_hands(result, when);
    publish_events(result.events);
    publish_markers(result, when);
  }

  /// Publishes both.
  void publish(const FrameResult& result) {
    publish_response(result);
    publish_picture(result);
  }

  /// Repeats what may be shown at any time: the last hands and contacts, markers, objects, transforms.
  void publish_scene(const FrameResult& result, const ros::Time& stamp) {
    publish_scene_description();
    for (const Output& output : outputs_) {
      const bool of_hands = output.shows == Shows::hands, has_hands = !result.rendered.empty();
      const bool as_it_was = of_hands || (output.shows == Shows::view && has_hands);
      if (!of_hands || has_hands) output.publish(result, as_it_was ? header(result) : header(stamp));
    }
    publish_transforms(header(stamp));
    if (standard_) standard_->publish(simulation_->scene(), nullptr, simulation_->state(), header(stamp));
    publish_markers(result, header(stamp));
    shown_ = ros::SteadyTime::now();
  }

  void publish_events(const std::vector<Event>& events) {
    for (const Event& event : events) {
      const std_msgs::Header when = header(to_ros_time(clock_.to_stamp(event.stamp)));
      publish_shared(events_,
                     [&] { return event_message(simulation_->scene(), simulation_->result(), event, when); });
    }
  }

  /// Time of the last rendered view, by a steady clock.
  ros::SteadyTime shown() const { return shown_; }
  static constexpr double kMarkerRate = 60.0;  ///< [Hz]

 private:
  static constexpr int kQueue = 10, kEventQueue = 100, kTransformQueue = 100;

  /// Order of topics: for robots and gloves first, then for the view.
  enum class Moment { response, picture };
  /// Contents of a topic: hands, and a view with hands, are repeated unchanged; joints are published only if
  /// the scene has any.
  enum class Shows { hands, objects, joints, view };
  struct Output {
    Moment moment;
    Shows shows;
    std::function<void(const FrameResult& result, const std_msgs::Header& header)> publish;
  };

  template <class Message>
  void add(ros::NodeHandle& node, const char* topic, Moment moment, Shows shows,
           Message (*make)(const Outcome&, const std_msgs::Header&)) {
    const ros::Publisher publisher = node.advertise<Message>(topic, kQueue);
    outputs_.push_back({moment, shows, [=](const FrameResult& result, const std_msgs::Header& header) {
                          const Scene& scene = simulation_->scene();
                          if (publisher.getNumSubscribers() == 0) return;
                          if (shows == Shows::joints && scene.joints.empty()) return;
                          const Outcome outcome{scene, result, simulation_->state()};
                          publish_shared(publisher, [&] { return make(outcome, header); });
                        }});
  }
  void publish_outputs(Moment moment, const FrameResult& result, const std_msgs::Header& header) const {
    for (const Output& output : outputs_)
      if (output.moment == moment) output.publish(result, header);
  }

  /// Makes a shared message, so that a subscriber in the same process gets it without a copy.
  template <class Make>
  static void publish_shared(const ros::Publisher& publisher, const Make& make) {
    publisher.publish(boost::make_shared<decltype(make())>(make()));
  }

  std_msgs::Header header(const ros::Time& stamp) const {
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = fixed_frame_;
    return header;
  }

  std_msgs::Header header(const FrameResult& result) const {
    return header(to_ros_time(clock_.to_stamp(result.stamp)));
  }

  /// In the background: the message has all triangles.
  void publish_scene_description() {
    if (!std::exchange(scene_changed_, false)) return;
    descriptions_.run([publisher = scene_publisher_, scene = simulation_->scene(),
                       configuration = simulation_->configuration(),
                       when = header(to_ros_time(clock_.to_stamp(simulation_->time())))] {
      publish_large(publisher, scene_message(scene, configuration, when));
    });
  }

  void publish_markers(const FrameResult& result, const std_msgs::Header& header) {
    if (marker_publisher_.getNumSubscribers() == 0) return;
    markers_->note(result, header.stamp);
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (ros::WallDuration(now - markers_shown_).toSec() < 1.0 / kMarkerRate) return;
    markers_shown_ = now;
    // No subscriber in this process holds the last one: reuse its memory.
    if (!picture_.unique()) picture_ = boost::make_shared<visualization_msgs::MarkerArray>();
    markers_->update(result, simulation_->state(), header, *picture_);
    marker_publisher_.publish(picture_);
  }

  void publish_transforms(const std_msgs::Header& header) {
    if (header.stamp == transforms_stamp_) return;  // tf2 warns of a repeated stamp
    publish_shared(transforms_, [&] {
      tf2_msgs::TFMessage message;
      message.transforms = object_transforms(simulation_->scene(), simulation_->state(), header);
      return message;
    });
    transforms_stamp_ = header.stamp;
  }

  std::string fixed_frame_;
  const StampClock& clock_;
  const Simulation* simulation_ = nullptr;
  std::unique_ptr<Markers> markers_;
  HapticsPublisher haptics_;
  std::optional<StandardOutputs> standard_;
  std::vector<Output> outputs_;
  ros::Publisher events_, scene_publisher_, transforms_, marker_publisher_;
  bool scene_changed_ = false;
  visualization_msgs::MarkerArray::Ptr picture_;  // the last one
  ros::Time transforms_stamp_;
  ros::SteadyTime shown_, markers_shown_;
  BackgroundQueue descriptions_;
};

}  // namespace mrhi
