#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <stdexcept>

#include "../text/file_text.h"
#include "demonstration.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

const char* const kSides[] = {"left", "right"};

class DemonstrationBag {
 public:
  explicit DemonstrationBag(const std::string& file) : bag_(file, rosbag::bagmode::Write) {}

  void write(const DemonstrationFrame& frame) {
    header_.stamp = to_ros_time(frame.stamp);
    header_.frame_id = "world";
    recorded_ = std::max(header_.stamp, ros::TIME_MIN);  // no bag takes 0, with which a recording may begin
    transforms_.transforms.clear();
    for (const auto& [name, object] : frame.objects) write_object(name, object);
    for (std::size_t side = 0; side < frame.hands.size(); ++side)
      if (frame.hands[side]) write_hand(kSides[side], *frame.hands[side]);
    for (const std::string& event : frame.events) {
      std_msgs::String message;
      message.data = event;
      bag_.write("/events", recorded_, message);
    }
    bag_.write("/tf", recorded_, transforms_);
  }

 private:
  void write_object(const std::string& name, const DemonstratedObject& object) {
    write_pose("/demonstration/" + name + "/pose", name, object.pose);
    geometry_msgs::WrenchStamped wrench;
    wrench.header = header_;
    wrench.wrench.force = vector_message(object.force);
    wrench.wrench.torque = vector_message(object.torque);
    bag_.write("/demonstration/" + name + "/wrench", recorded_, wrench);
  }

  void write_hand(const std::string& side, const Hand& hand) {
    write_pose("/demonstration/" + side + "_palm/pose", side + "_palm", hand.palm);
    sensor_msgs::JointState joints;
    joints.header = header_;
    for (const auto& [name, angle] : joint_angles(hand)) {
      joints.name.push_back(side + "_" + name);
      joints.position.push_back(angle);
    }
    bag_.write("/demonstration/" + side + "_hand/joint_states", recorded_, joints);
  }

  void write_pose(const std::string& topic, const std::string& frame, const Pose& pose) {
    geometry_msgs::PoseStamped message;
    message.header = header_;
    message.pose = to_message(pose);
    bag_.write(topic, recorded_, message);
    geometry_msgs::TransformStamped transform;
    transform.header = header_;
    transform.child_frame_id = frame;
    transform.transform.translation = vector_message(pose.position);
    transform.transform.rotation = message.pose.orientation;
    transforms_.transforms.push_back(transform);
  }

  rosbag::Bag bag_;
  std_msgs::Header header_;
  ros::Time recorded_;
  tf2_msgs::TFMessage transforms_;
};

}  // namespace

void write_demonstration_bag(const Demonstration& demonstration, const std::string& file) try {
  check_may_be_written(file);
  DemonstrationBag bag(file);
  for (const DemonstrationFrame& frame : demonstration.frames()) bag.write(frame);
} catch (const rosbag::BagException& error) {
  throw std::runtime_error("cannot write " + file + ": " + error.what());
}

}  // namespace mrhi
