#include "mr_hand_interaction/ros/synthetic_hand_publisher.h"

#include <ros/serialization.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

#include "mr_hand_interaction/ros/leap_human_encoder.h"

namespace mrhi {
namespace {

constexpr const char* kTopic = "/leap_motion/leap_device";
constexpr const char* kFrame = "leap_hands";

/// A private parameter of the node, if it is set. Throws std::invalid_argument if it is of another type.
template <class T>
void read(const ros::NodeHandle& parameters, const std::string& name, const char* type, T& value) {
  if (!parameters.hasParam(name) || parameters.getParam(name, value)) return;
  throw std::invalid_argument("parameter " + parameters.resolveName(name) + " must be " + type);
}

void refuse_unknown(const ros::NodeHandle& parameters) {
  const std::set<std::string> known{"loop", "motion", "noise", "rate", "reset", "seed", "side"};
  std::vector<std::string> names;
  ros::param::getParamNames(names);
  const std::string space = parameters.getNamespace() + "/";
  for (const std::string& name : names) {
    if (name.compare(0, space.size(), space) != 0 || known.count(name.substr(space.size())) > 0) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    throw std::invalid_argument("parameter " + name + " is not known: use " + list);
  }
}

SyntheticHandOptions options_from(const ros::NodeHandle& parameters) {
  refuse_unknown(parameters);
  SyntheticHandOptions options;
  read(parameters, "motion", "a string", options.motion);
  read(parameters, "side", "a string", options.side);
  read(parameters, "rate", "a number", options.rate);
  read(parameters, "noise", "a number", options.noise);
  int seed = static_cast<int>(options.seed);
  read(parameters, "seed", "an integer", seed);
  if (seed < 0) throw std::invalid_argument("seed is " + std::to_string(seed) + ": use 0 or more");
  options.seed = static_cast<std::uint64_t>(seed);
  return options;
}

bool loop_from(const ros::NodeHandle& parameters) {
  bool loop = true;
  read(parameters, "loop", "true or false", loop);
  return loop;
}

}  // namespace

SyntheticHandPublisher::SyntheticHandPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters)
    : node_(node), hand_(options_from(parameters)), loop_(loop_from(parameters)) {
  double rate = SyntheticHandOptions().rate;
  read(parameters, "rate", "a number", rate);
  rate_ = static_cast<float>(rate);
  read(parameters, "reset", "the name of a service", reset_service_);
  message_.morph(LeapHumanEncoder::md5(), LeapHumanEncoder::type(), LeapHumanEncoder::definition(), "");
  publisher_ = message_.advertise(node_, kTopic, 10);
}

void SyntheticHandPublisher::run() {
  wait_for_listener();
  if (!ros::Time::waitForValid()) return;
  const auto start = static_cast<Nanoseconds>(ros::Time::now().toNSec());
  for (int run = 0; node_.ok();) {
    if (hand_.next_run() != run) {
      if (!loop_) return;
      run = hand_.next_run();
      reset_scene();
    }
    ros::Time::sleepUntil(ros::Time().fromNSec(static_cast<std::uint64_t>(start + hand_.next_stamp())));
    if (node_.ok()) publish(hand_.next(), start);
    ros::spinOnce();
  }
}

void SyntheticHandPublisher::wait_for_listener() const {
  const ros::WallTime latest = ros::WallTime::now() + ros::WallDuration(5.0);
  while (node_.ok() && publisher_.getNumSubscribers() == 0 && ros::WallTime::now() < latest) {
    ros::WallDuration(0.005).sleep();
    ros::spinOnce();
  }
}

void SyntheticHandPublisher::publish(JointsFrame frame, Nanoseconds start) {
  frame.stamp += start;
  auto bytes = LeapHumanEncoder::encode(frame, kFrame, sequence_++, rate_);
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message_.read(stream);
  publisher_.publish(message_);
}

void SyntheticHandPublisher::reset_scene() {
  if (reset_service_.empty()) return;
  std_srvs::Trigger trigger;
  if (!ros::service::call(reset_service_, trigger)) {
    ROS_WARN_THROTTLE(30, "service %s did not answer; the scene is not reset", reset_service_.c_str());
  }
}

}  // namespace mrhi
