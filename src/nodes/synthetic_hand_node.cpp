#include <ros/ros.h>

#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../ros/node.h"
#include "mr_hand_interaction/ros/synthetic_hand_publisher.h"
#include "mr_hand_interaction/synthetic/recording_writer.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction synthetic_hand_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...
       rosrun mr_hand_interaction synthetic_hand_node --csv FILE [--motion NAME] [--side left|right] [--rate HZ]
                                                      [--noise AMPLITUDE] [--seed N]

Publishes a scripted hand on /leap_motion/leap_device, as a Leap's driver would; with --csv writes one run of it as a
recording, which needs no master.

  ~motion   grasp_cube (default) grasp_ball catch_ball pinch_long lift_flat nudge tap slap press_button flip_switch
            turn_valve pull_lever open_drawer open_door open_hatch squeeze_tongs
  ~side     left or right; default right
  ~rate     frames per second; default 115
  ~noise    1: as a Leap's; default 0
  ~seed     of the noise; default 1
  ~loop     begins again when it is done; default true
  ~reset    the service that a run begins with; default none
)";

double number(const std::string& option, const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != text.size())
    throw std::invalid_argument(option + " '" + text + "' is not a number");
  return value;
}

/// Writes one run as a recording; needs no master.
void write_recording(const std::vector<std::string>& arguments) {
  mrhi::SyntheticHandOptions options;
  std::string file;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    const std::string& name = arguments[i];
    const bool known = name == "--csv" || name == "--motion" || name == "--side" || name == "--rate" ||
                       name == "--noise" || name == "--seed";
    if (!known || i + 1 == arguments.size())
      throw std::invalid_argument((known ? "value missing after " : "unknown option ") + name +
                                  "; see --help");
    const std::string& value = arguments[i + 1];
    if (name == "--csv") file = value;
    if (name == "--motion") options.motion = value;
    if (name == "--side") options.side = value;
    if (name == "--rate") options.rate = number("rate", value);
    if (name == "--noise") options.noise = number("noise", value);
    if (name == "--seed") options.seed = static_cast<std::uint64_t>(number("seed", value));
  }
  if (file.empty()) throw std::invalid_argument("--csv FILE is missing; see --help");
  const auto frames = mrhi::record_motion(options);
  std::ofstream out(file);
  mrhi::write_recording_csv(out, frames);
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  if (arguments.size() > 1 && (arguments[1] == "--help" || arguments[1] == "-h")) {
    std::cout << kUsage;
    return 0;
  }
  if (arguments.size() > 1) {
    try {
      write_recording({arguments.begin() + 1, arguments.end()});
    } catch (const std::exception& error) {
      std::cerr << "synthetic_hand_node: " << error.what() << '\n';
      return 1;
    }
    return 0;
  }
  ros::init(argc, argv, "synthetic_hand_node");
  mrhi::end_in_order();
  const ros::NodeHandle node,
      parameters("~");  // the last handle to go would close the log before it is written to
  const mrhi::MasterWatch master;
  try {
    mrhi::SyntheticHandPublisher(node, parameters).run();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
