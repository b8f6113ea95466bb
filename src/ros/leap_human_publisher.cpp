#include "leap_human_publisher.h"

#include <ros/serialization.h>

#include "leap_human_encoder.h"

namespace mrhi {

LeapHumanPublisher::LeapHumanPublisher(ros::NodeHandle& node, double rate) : rate_(static_cast<float>(rate)) {
  message_.morph(LeapHumanEncoder::md5(), LeapHumanEncoder::type(), LeapHumanEncoder::definition(), "");
  publisher_ = message_.advertise(node, "/leap_motion/leap_device", 10);
}

void LeapHumanPublisher::publish(const JointsFrame& frame) {
  auto bytes = LeapHumanEncoder::encode(frame, "leap_hands", sequence_++, rate_);
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message_.read(stream);
  publisher_.publish(message_);
}

}  // namespace mrhi
