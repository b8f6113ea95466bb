#include "synthetic_hand_publisher.h"

#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "node.h"

namespace mrhi {
namespace {

SyntheticHandOptions options_from(const ros::NodeHandle& parameters) {
  refuse_unknown(parameters, {"loop", "motion", "noise", "rate", "reset", "scene", "seed", "side"});
  SyntheticHandOptions options;
  read_parameter(parameters, "motion", "a string", options.motion);
  read_parameter(parameters, "side", "a string", options.side);
  read_parameter(parameters, "rate", "a number", options.rate);
  read_parameter(parameters, "noise", "a number", options.noise);
  options.seed = read_seed(parameters, options.seed);
  return options;
}

SyntheticHand hand_from(const ros::NodeHandle& parameters) {
  const SyntheticHandOptions options = options_from(parameters);
  std::string scene;
  read_parameter(parameters, "scene", "a string", scene);
  return {options, motion_for(options.motion, scene)};
}

double rate_from(const ros::NodeHandle& parameters) {
  double rate = SyntheticHandOptions().rate;
  read_parameter(parameters, "rate", "a number", rate);
  return rate;
}

bool loop_from(const ros::NodeHandle& parameters) {
  bool loop = true;
  read_parameter(parameters, "loop", "true or false", loop);
  return loop;
}

}  // namespace

ScriptedMotion motion_for(const std::string& motion, const std::string& scene) {
  if (motion != "grasp_object") return make_motion(motion);
  return grasp_object(load_scene(find_scene_file(scene, scene_folders()), scene_options({})));
}

SyntheticHandPublisher::SyntheticHandPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters)
    : node_(node),
      hand_(hand_from(parameters)),
      loop_(loop_from(parameters)),
      publisher_(node_, rate_from(parameters)) {
  read_parameter(parameters, "reset", "the name of a service", reset_service_);
}

void SyntheticHandPublisher::run() {
  wait_for_listener();
  if (!ros::Time::waitForValid()) return;
  looked_ = start_ = from_ros_time(ros::Time::now());
  for (int run = 0; node_.ok();) {
    if (hand_.next_run() != run) {
      if (!loop_) return;
      run = hand_.next_run();
      reset_scene();
    }
    wait_for_next();
    if (node_.ok()) {
      JointsFrame frame = hand_.next();
      frame.stamp += start_;
      publisher_.publish(frame);
    }
    ros::spinOnce();
  }
}

void SyntheticHandPublisher::wait_for_listener() const {
  const ros::WallTime latest = ros::WallTime::now() + ros::WallDuration(5.0);
  while (node_.ok() && !publisher_.has_listener() && ros::WallTime::now() < latest) {
    ros::WallDuration(0.005).sleep();
    ros::spinOnce();
  }
}

/// The run moves along with a clock that leaps, either way: it neither makes up for the time nor waits for
/// it.
void SyntheticHandPublisher::wait_for_next() {
  constexpr Nanoseconds kLeap = 1'000'000'000, kLongestSleep = 50'000'000, kLookAtClock = 1'000'000;
  const Nanoseconds longest = ros::Time::isSimTime() ? kLookAtClock : kLongestSleep;
  while (node_.ok()) {
    const Nanoseconds now = from_ros_time(ros::Time::now()), passed = now - std::exchange(looked_, now);
    if (std::abs(passed) > kLeap) start_ += passed;
    const Nanoseconds left = start_ + hand_.next_stamp() - now;
    if (left <= 0) return;
    ros::WallDuration().fromNSec(std::min(left, longest)).sleep();
  }
}

void SyntheticHandPublisher::reset_scene() {
  if (reset_service_.empty()) return;
  std_srvs::Trigger trigger;
  if (!ros::service::call(reset_service_, trigger)) {
    ROS_WARN_THROTTLE(30, "service %s did not answer; the scene is not reset", reset_service_.c_str());
  }
}

}  // namespace mrhi
