#include "standard_outputs.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <limits>

#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr int kQueue = 10;

std::string topic_of(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return "objects/" + name;
}

geometry_msgs::Pose joint_message(const Vector3& position, const Vector3& along) {
  return to_message(Pose{position, Quaternion::FromTwoVectors(Vector3::UnitX(), along)});
}

geometry_msgs::Pose missing_joint() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return to_message(Pose{Vector3::Constant(nan), Quaternion::Identity()});
}

void add_finger(const Hand& hand, int finger, geometry_msgs::PoseArray& message) {
  for (int joint = 0; joint < kBonesPerFinger; ++joint) {
    const int bone = capsule_index(finger, std::max(joint, 1));
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(bone)];
    message.poses.push_back(
        hand.has(bone) ? joint_message(joint == 0 ? capsule.start : capsule.end, capsule.end - capsule.start)
                       : missing_joint());
  }
}

}  // namespace

geometry_msgs::PoseArray pose_array_message(const Hand& hand, const std_msgs::Header& header) {
  geometry_msgs::PoseArray message;
  message.header = header;
  message.poses.push_back(joint_message(hand.wrist, hand.palm.position - hand.wrist));
  for (int finger = 0; finger < kFingers; ++finger) add_finger(hand, finger, message);
  return message;
}

geometry_msgs::Wrench wrench_message(std::size_t body, const FrameResult& result,
                                     const SimulationState& state) {
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  for (const Contact& contact : result.contacts) {
    if (contact.key.body != body) continue;
    force += contact.force;
    torque += (contact.point - state.bodies[body].pose.position).cross(contact.force);
  }
  geometry_msgs::Wrench message;
  message.force = vector_message(force);
  message.torque = vector_message(torque);
  return message;
}

std::string held_objects(const Scene& scene, const SimulationState& state) {
  std::string names;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!scene.bodies[i].fixed && is_held(i, state))
      names += (names.empty() ? "" : ",") + scene.bodies[i].name;
  return names;
}

StandardOutputs::StandardOutputs(const ros::NodeHandle& node)
    : node_(node),
      hands_{node_.advertise<geometry_msgs::PoseArray>("rendered_hands/left/pose_array", kQueue),
             node_.advertise<geometry_msgs::PoseArray>("rendered_hands/right/pose_array", kQueue)},
      held_(node_.advertise<std_msgs::String>("held_object", kQueue, true)) {}

/// Topics of the bodies that there are.
void StandardOutputs::follow(const Scene& scene) {
  std::map<std::string, ObjectTopics> objects;
  const auto each_free = [&scene](auto&& use) {
    for (const Body& body : scene.bodies)
      if (!body.fixed) use(body.name);
  };
  each_free([&](const std::string& name) {
    if (const auto known = objects_.find(name); known != objects_.end()) objects.insert(*known);
  });
  each_free([&](const std::string& name) {
    if (objects.count(name) == 0) objects.emplace(name, new_topics(name, objects));
  });
  objects_ = std::move(objects);
}

StandardOutputs::ObjectTopics StandardOutputs::new_topics(const std::string& body,
                                                          const std::map<std::string, ObjectTopics>& there) {
  std::string name = topic_of(body);
  const auto is_taken = [&name](const auto& other) { return other.second.name == name; };
  while (std::any_of(there.begin(), there.end(), is_taken)) name += '_';
  return {name, node_.advertise<geometry_msgs::PoseStamped>(name + "/pose", kQueue),
          node_.advertise<geometry_msgs::WrenchStamped>(name + "/wrench", kQueue)};
}

void StandardOutputs::publish(const Scene& scene, const FrameResult& result, const SimulationState& state,
                              const std_msgs::Header& header) {
  publish_objects(scene, state, header);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].fixed) continue;
    geometry_msgs::WrenchStamped wrench;
    wrench.header = header;
    wrench.wrench = wrench_message(i, result, state);
    objects_.at(scene.bodies[i].name).wrench.publish(wrench);
  }
}

void StandardOutputs::publish_hands(const FrameResult& result, const std_msgs::Header& header) {
  for (const RenderedHand& rendered : result.rendered)
    hands_[static_cast<std::size_t>(rendered.hand.side)].publish(pose_array_message(rendered.hand, header));
}

void StandardOutputs::publish_objects(const Scene& scene, const SimulationState& state,
                                      const std_msgs::Header& header) {
  follow(scene);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].fixed) continue;
    geometry_msgs::PoseStamped pose;
    pose.header = header;
    pose.pose = to_message(state.bodies[i].pose);
    objects_.at(scene.bodies[i].name).pose.publish(pose);
  }
  std_msgs::String held;
  held.data = held_objects(scene, state);
  if (last_held_ != held.data) held_.publish(held);
  last_held_ = held.data;
}

}  // namespace mrhi
