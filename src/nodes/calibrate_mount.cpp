#include <ros/ros.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../ros/mount_calibration.h"
#include "../text/command_line.h"
#include "exit_status.h"

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

Arguments parse(const std::vector<std::string>& words) {
  using mrhi::Given;
  Arguments arguments;
  mrhi::CommandLine line;
  line.once("--topic", "TOPIC", arguments.topic).once("--save", "FILE.yaml", arguments.save);
  line.once("--side", "left|right", [&](const Given& given) {
    if (given.text != "left" && given.text != "right") given.refuse("left or right");
    arguments.side = given.text == "left" ? mrhi::Side::left : mrhi::Side::right;
  });
  line.once("--samples", "N",
            [&](const Given& given) { arguments.samples = static_cast<std::size_t>(given.whole(1, 10000)); });
  line.once("--max-rms", "MM",
            [&](const Given& given) { arguments.max_rms = 1e-3 * given.number(0.0, 1000.0); });
  line.words([&](const Given& given) {
    if (!arguments.file.empty()) throw mrhi::UsageError("one file of points, not also '" + given.text + "'");
    arguments.file = given.text;
  });
  arguments.help = !line.read(words);
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
  return mrhi::exit_status("calibrate_mount", [&] {
    const Arguments arguments = parse({words.begin() + 1, words.end()});
    if (arguments.help) {
      std::cout << kHelp;
    } else {
      calibrate(arguments, argc, argv);
    }
    return 0;
  });
}
