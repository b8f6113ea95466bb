#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../ros/leap_human_publisher.h"
#include "../ros/node.h"
#include "../text/command_line.h"
#include "../text/files.h"
#include "exit_status.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {
namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction synthetic_hand_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...
       rosrun mr_hand_interaction synthetic_hand_node --csv FILE [--motion NAME] [--side left|right] [--rate HZ]
                                                      [--noise AMPLITUDE] [--seed N] [--scene NAME|FILE]

Publishes a scripted hand on /leap_motion/leap_device, like a Leap driver. With --csv it writes one run of the motion as
a recording instead and needs no ROS master.

  ~motion   grasp_cube (default) grasp_ball catch_ball pinch_long lift_flat nudge tap slap press_button flip_switch
            turn_valve pull_lever open_drawer open_door open_hatch squeeze_tongs; grasp_object grasps the only free
            object of ~scene by a narrow part
  ~scene    for grasp_object: a shipped scene or a URDF file
  ~side     left or right; default right
  ~rate     frames per second; default 115
  ~noise    factor on the noise of a Leap; default 0
  ~seed     of the noise; default 1
  ~loop     repeats the motion; default true
  ~reset    service that is called before each run; default none
)";

/// The motion of that name; `scene`: of grasp_object. Throws std::invalid_argument or SceneError.
ScriptedMotion motion_for(const std::string& motion, const std::string& scene) {
  if (motion != "grasp_object") return make_motion(motion);
  return grasp_object(load_scene(find_scene_file(scene, scene_folders()), scene_options({})));
}

/// Writes one run as a recording; needs no master.
int write_recording(const std::vector<std::string>& arguments) {
  SyntheticHandOptions options;
  std::string file, scene;
  CommandLine line;
  line.once("--csv", "FILE", file).once("--motion", "NAME", options.motion);
  line.once("--scene", "NAME|FILE", scene);
  line.once("--side", "left|right", options.side);
  line.once("--rate", "HZ", [&](const OptionValue& given) { options.rate = given.number(1.0, 1000.0); });
  line.once("--noise", "AMPLITUDE",
            [&](const OptionValue& given) { options.noise = given.number(0.0, 10.0); });
  line.once("--seed", "N", [&](const OptionValue& given) {
    options.seed = static_cast<std::uint64_t>(given.whole(0, 1000000000));
  });
  if (!line.read(arguments)) {
    std::cout << kUsage;
    return 0;
  }
  if (file.empty()) throw UsageError("--csv FILE is missing; see --help");
  const auto frames = record_motion(options, motion_for(options.motion, scene));
  std::ostringstream table;
  write_recording_csv(table, frames);
  write_file(file, table.str());
  return 0;
}

/// Parameters of the node on the parameter server.
struct Parameters {
  explicit Parameters(const ros::NodeHandle& node) {
    NodeParameters known;
    known.truth("loop", loop).text("motion", options.motion).number("noise", 0.0, 10.0, options.noise);
    known.number("rate", 1.0, 1000.0, options.rate).text("reset", reset_service).text("scene", scene);
    known.whole("seed", 0, options.seed).text("side", options.side).read(node);
  }

  SyntheticHandOptions options;
  std::string scene, reset_service;
  bool loop = true;
};

}  // namespace

/// Publishes the hand on its own schedule, and calls ~reset before each run but the first.
class SyntheticHandPublisher {
 public:
  /// Throws std::invalid_argument with the fault and what is allowed.
  SyntheticHandPublisher(const ros::NodeHandle& node, const Parameters& parameters)
      : node_(node),
        hand_(parameters.options, motion_for(parameters.options.motion, parameters.scene)),
        loop_(parameters.loop),
        reset_service_(parameters.reset_service),
        publisher_(node_, parameters.options.rate) {}

  /// Starts with the first subscriber, or after five seconds. Returns at shutdown or after the last run.
  void run() {
    wait_for_listener();
    if (!ros::Time::waitForValid()) return;
    last_now_ = start_ = from_ros_time(ros::Time::now());
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

 private:
  void wait_for_listener() const {
    const ros::SteadyTime latest = ros::SteadyTime::now() + ros::WallDuration(5.0);
    while (node_.ok() && !publisher_.has_listener() && ros::SteadyTime::now() < latest) {
      ros::WallDuration(0.005).sleep();
      ros::spinOnce();
    }
  }

  /// The run follows jumps of the clock in both directions: it neither catches up nor waits.
  void wait_for_next() {
    constexpr Nanoseconds kMinJump = 1'000'000'000, kMaxSleep = 50'000'000, kSimTimeSleep = 1'000'000;
    const Nanoseconds max_sleep = ros::Time::isSimTime() ? kSimTimeSleep : kMaxSleep;
    while (node_.ok()) {
      const Nanoseconds now = from_ros_time(ros::Time::now()), passed = now - std::exchange(last_now_, now);
      if (std::abs(passed) > kMinJump) start_ += passed;
      const Nanoseconds left = start_ + hand_.next_stamp() - now;
      if (left <= 0) return;
      ros::WallDuration().fromNSec(std::min(left, max_sleep)).sleep();
    }
  }

  void reset_scene() {
    if (reset_service_.empty()) return;
    std_srvs::Trigger trigger;
    if (!ros::service::call(reset_service_, trigger)) {
      ROS_WARN_THROTTLE(30, "service %s did not answer; the scene is not reset", reset_service_.c_str());
    }
  }

  ros::NodeHandle node_;
  SyntheticHand hand_;
  bool loop_;
  Nanoseconds start_ = 0, last_now_ = 0;  // ROS times of the first run, and of the last clock reading
  std::string reset_service_;
  LeapHumanPublisher publisher_;
};

}  // namespace mrhi

int main(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  if (arguments.size() > 1) {
    return mrhi::exit_status("synthetic_hand_node", [&] {
      return mrhi::write_recording({arguments.begin() + 1, arguments.end()});
    });
  }
  const auto body = [](const auto& node, const auto& private_node) {
    mrhi::SyntheticHandPublisher(node, mrhi::Parameters(private_node)).run();
  };
  return mrhi::run_node(argc, argv, "synthetic_hand_node", mrhi::kUsage, body);
}
