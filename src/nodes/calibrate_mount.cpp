#include <ros/ros.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/replay/arguments.h"
#include "mr_hand_interaction/ros/mount_calibration.h"

namespace {

constexpr const char* kHelp = R"(usage: calibrate_mount POINTS.yaml [options]

Finds the pose of the hand tracker in world. The points are touched, one after the other, with the tip of the index
finger, in view of a running Leap driver. Where all have a `device` place, nothing is touched and no master is needed.

  points:
    - {name: near left corner, world: [-0.2, -0.1, 0.0], normal: [0, 0, 1]}
    - ...

  --topic TOPIC       of the driver; default /leap_motion/leap_device
  --side left|right   hand that touches; default right
  --samples N         frames that are averaged at a point; default 100
  --max-rms MM        largest residual (rms) that is taken for a calibration; default 5
  --save FILE.yaml    writes the points with their device places, for another fit without touching
  --help              this text

Exit status: 0 done, 1 bad data, 2 bad usage.
)";

struct Arguments {
  bool help = false;
  std::string file, save;
  std::string topic = "/leap_motion/leap_device";
  mrhi::Side side = mrhi::Side::right;
  std::size_t samples = 100;
  double max_rms = 0.005;  // [m]
};

double number(const std::string& option, const std::string& text, double lowest, double highest) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && value >= lowest && value <= highest) return value;
  } catch (const std::exception&) {
  }
  throw mrhi::UsageError(option + " '" + text + "' is not allowed; allowed: a number from " +
                         std::to_string(static_cast<int>(lowest)) + " to " +
                         std::to_string(static_cast<int>(highest)));
}

void read_option(Arguments& arguments, const std::string& name, const std::string& value) {
  if (name == "--topic") {
    arguments.topic = value;
  } else if (name == "--save") {
    arguments.save = value;
  } else if (name == "--samples") {
    arguments.samples = static_cast<std::size_t>(number(name, value, 1, 10000));
  } else if (name == "--max-rms") {
    arguments.max_rms = 1e-3 * number(name, value, 0, 1000);
  } else if (name == "--side" && (value == "left" || value == "right")) {
    arguments.side = value == "left" ? mrhi::Side::left : mrhi::Side::right;
  } else if (name == "--side") {
    throw mrhi::UsageError("--side '" + value + "' is not allowed; allowed: left or right");
  } else {
    throw mrhi::UsageError("unknown argument '" + name +
                           "'; allowed: --topic, --side, --samples, --max-rms, --save, --help");
  }
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--help" || words[i] == "-h") {
      arguments.help = true;
    } else if (words[i].compare(0, 2, "--") != 0) {
      if (!arguments.file.empty()) throw mrhi::UsageError("one file of points, not also '" + words[i] + "'");
      arguments.file = words[i];
    } else {
      if (i + 1 == words.size()) throw mrhi::UsageError(words[i] + " needs a value");
      read_option(arguments, words[i], words[i + 1]);
      ++i;
    }
  }
  if (!arguments.help && arguments.file.empty())
    throw mrhi::UsageError("the file of points is missing; --help shows the usage");
  return arguments;
}

bool all_touched(const std::vector<mrhi::TouchedPoint>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](const auto& point) { return point.device.has_value(); });
}

std::vector<mrhi::TouchedPoint> touch(const Arguments& arguments, std::vector<mrhi::TouchedPoint> points) {
  mrhi::MountCalibration calibration(ros::NodeHandle(), arguments.topic, arguments.side,
                                     {std::move(points), arguments.samples}, std::cout);
  calibration.run();
  if (!calibration.recorder().done()) throw std::runtime_error("interrupted before all points were touched");
  return calibration.recorder().points();
}

void calibrate(const Arguments& arguments, int argc, char** argv) {
  std::vector<mrhi::TouchedPoint> points = mrhi::read_points(arguments.file);
  mrhi::check_places(points);
  if (!all_touched(points)) {
    ros::init(argc, argv, "calibrate_mount", ros::init_options::AnonymousName);
    points = touch(arguments, std::move(points));
  }
  if (!arguments.save.empty()) mrhi::write_points(arguments.save, points);
  const mrhi::RigidFit fit = mrhi::fit_mount(points);
  std::cout << mrhi::residual_table(points, fit);
  mrhi::check_residual(points, fit, arguments.max_rms);
  std::cout << "mount:=\"" << mrhi::mount_text(fit.local_in_world) << "\"\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words;
  ros::removeROSArgs(argc, argv, words);
  try {
    const Arguments arguments = parse({words.begin() + 1, words.end()});
    if (arguments.help) {
      std::cout << kHelp;
    } else {
      calibrate(arguments, argc, argv);
    }
  } catch (const mrhi::UsageError& error) {
    std::cerr << "calibrate_mount: " << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "calibrate_mount: " << error.what() << std::endl;
    return 1;
  }
  return 0;
}
