#include <ros/ros.h>

#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../ros/node.h"
#include "../ros/synthetic_hand_publisher.h"
#include "../text/command_line.h"
#include "../text/files.h"
#include "exit_status.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction synthetic_hand_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...
       rosrun mr_hand_interaction synthetic_hand_node --csv FILE [--motion NAME] [--side left|right] [--rate HZ]
                                                      [--noise AMPLITUDE] [--seed N] [--scene NAME|FILE]

Publishes a scripted hand on /leap_motion/leap_device, as a Leap's driver would; with --csv writes one run of it as a
recording, which needs no master.

  ~motion   grasp_cube (default) grasp_ball catch_ball pinch_long lift_flat nudge tap slap press_button flip_switch
            turn_valve pull_lever open_drawer open_door open_hatch squeeze_tongs; grasp_object takes the only free
            object of ~scene on its narrowest side
  ~scene    of grasp_object: a shipped scene or a URDF file
  ~side     left or right; default right
  ~rate     frames per second; default 115
  ~noise    1: as a Leap's; default 0
  ~seed     of the noise; default 1
  ~loop     begins again when it is done; default true
  ~reset    the service that a run begins with; default none
)";

/// Writes one run as a recording; needs no master.
int write_recording(const std::vector<std::string>& arguments) {
  using mrhi::Given;
  mrhi::SyntheticHandOptions options;
  std::string file, scene;
  mrhi::CommandLine line;
  line.once("--csv", "FILE", file).once("--motion", "NAME", options.motion);
  line.once("--scene", "NAME|FILE", scene);
  line.once("--side", "left|right", options.side);
  line.once("--rate", "HZ", [&](const Given& given) { options.rate = given.number(1.0, 1000.0); });
  line.once("--noise", "AMPLITUDE", [&](const Given& given) { options.noise = given.number(0.0, 10.0); });
  line.once("--seed", "N", [&](const Given& given) {
    options.seed = static_cast<std::uint64_t>(given.whole(0, 1000000000));
  });
  if (!line.read(arguments)) {
    std::cout << kUsage;
    return 0;
  }
  if (file.empty()) throw mrhi::UsageError("--csv FILE is missing; see --help");
  const auto frames = mrhi::record_motion(options, mrhi::motion_for(options.motion, scene));
  std::ofstream out = mrhi::file_to_write(file);
  mrhi::write_recording_csv(out, frames);
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  if (arguments.size() > 1) {
    return mrhi::exit_status("synthetic_hand_node", [&] {
      return write_recording({arguments.begin() + 1, arguments.end()});
    });
  }
  return mrhi::run_node(argc, argv, "synthetic_hand_node", [](const auto& node, const auto& private_node) {
    mrhi::SyntheticHandPublisher(node, private_node).run();
  });
}
