#include "mr_hand_interaction/ros/haptics_publisher.h"

#include <boost/make_shared.hpp>

#include "haptics.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "result_conversion.h"

namespace mrhi {
namespace {

constexpr int kQueue = 100;  // the steps of a few frames come at once

template <typename Message>
void publish_all(std::vector<Message>& messages, const std_msgs::Header& header, ros::Publisher& publisher) {
  for (const Message& message : messages) {
    message->header.frame_id = header.frame_id;
    publisher.publish(message);
  }
  messages.clear();
}

}  // namespace

HapticsPublisher::HapticsPublisher(ros::NodeHandle& node, HapticsRate rate)
    : rate_(rate),
      publisher_(node.advertise<mr_hand_interaction::HapticsArray>("haptics", kQueue)),
      joint_publisher_(node.advertise<sensor_msgs::JointState>("haptics/joints", kQueue)) {}

void HapticsPublisher::add(const Simulation& simulation, const std::vector<Contact>& contacts,
                           const std_msgs::Header& header) {
  const Scene& scene = simulation.scene();
  const SimulationState& state = simulation.state();
  if (publisher_.getNumSubscribers() > 0)
    steps_.push_back(boost::make_shared<mr_hand_interaction::HapticsArray>(
        haptics_message(scene, state, contacts, header)));
  if (!scene.joints.empty() && joint_publisher_.getNumSubscribers() > 0)
    joint_steps_.push_back(
        boost::make_shared<sensor_msgs::JointState>(joint_states_message(scene, state, header)));
}

void HapticsPublisher::note_step(const Simulation& simulation, Nanoseconds stamp) {
  if (rate_ != HapticsRate::step) return;
  std_msgs::Header header;
  header.stamp = to_ros_time(stamp);
  add(simulation, simulation.state().contacts, header);
}

void HapticsPublisher::publish(const Simulation& simulation, const FrameResult& result,
                               const std_msgs::Header& header) {
  if (steps_.empty() && joint_steps_.empty()) add(simulation, result.contacts, header);
  publish_all(steps_, header, publisher_);
  publish_all(joint_steps_, header, joint_publisher_);
}

}  // namespace mrhi
