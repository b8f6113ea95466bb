#include "mr_hand_interaction/ros/haptics_publisher.h"

#include <boost/make_shared.hpp>

#include "haptics.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr int kQueue = 100;  // the steps of a few frames come at once

mr_hand_interaction::HapticsArrayPtr shared_message(const Simulation& simulation,
                                                    const std::vector<Contact>& contacts,
                                                    const std_msgs::Header& header) {
  return boost::make_shared<mr_hand_interaction::HapticsArray>(
      haptics_message(simulation.scene(), simulation.state(), contacts, header));
}

}  // namespace

HapticsPublisher::HapticsPublisher(ros::NodeHandle& node, HapticsRate rate)
    : rate_(rate), publisher_(node.advertise<mr_hand_interaction::HapticsArray>("haptics", kQueue)) {}

void HapticsPublisher::note_step(const Simulation& simulation, Nanoseconds stamp) {
  if (rate_ != HapticsRate::step || publisher_.getNumSubscribers() == 0) return;
  std_msgs::Header header;
  header.stamp = to_ros_time(stamp);
  steps_.push_back(shared_message(simulation, simulation.state().contacts, header));
}

void HapticsPublisher::publish(const Simulation& simulation, const FrameResult& result,
                               const std_msgs::Header& header) {
  if (publisher_.getNumSubscribers() > 0 && steps_.empty()) {
    steps_.push_back(shared_message(simulation, result.contacts, header));
  }
  for (const auto& message : steps_) {
    message->header.frame_id = header.frame_id;
    publisher_.publish(message);
  }
  steps_.clear();
}

}  // namespace mrhi
