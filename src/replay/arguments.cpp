#include "mr_hand_interaction/replay/replay.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "../scene/limits.h"
#include "../text/command_line.h"
#include "../text/text.h"
#include "../tracking/joints_input.h"

namespace mrhi {
namespace {

constexpr double kMinQuaternionNorm = 1e-6;
constexpr const char* kCompareUsage =
    "--compare takes the folders of two runs, then --tolerance METRES,RADIANS or nothing";

Pose pose(const OptionValue& given, std::size_t first) {
  const std::vector<double> v = given.numbers(first, 7);
  Quaternion orientation(v[6], v[3], v[4], v[5]);
  const double length = orientation.norm();
  if (!std::isfinite(length) || length < kMinQuaternionNorm) given.fail("the quaternion has no direction");
  orientation.coeffs() /= length;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!body_limits::kPlace.contains(v[i]))
      given.fail("the place is not within " + text::number(body_limits::kPlace.max) + " m on each axis");
  }
  return {{v[0], v[1], v[2]}, orientation};
}

Twist twist(const OptionValue& given) {
  const std::vector<double> v = given.numbers(1, 6);
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

std::string object_name(const OptionValue& given) {
  const std::string name = text::split(given.text).front();
  if (name.empty()) given.fail("the object's name is missing");
  return name;
}

std::string order(const OptionValue& given) {
  return rethrown<UsageError, std::invalid_argument>(given.option + ": ",
                                                     [&] { return joint_order(given.text).name; });
}

/// `zero`: what 0 stands for where it is allowed, for messages.
double rate(const OptionValue& given, const std::string& zero = "") {
  const double rate = given.numbers(0, 1).front();
  if (!((rate == 0.0 && !zero.empty()) || (rate >= 1.0 && rate <= 1000.0)))
    given.fail("is no rate from 1 to 1000 Hz" + (zero.empty() ? "" : ", and not 0 for " + zero));
  return rate;
}

std::set<std::size_t> frame_numbers(const OptionValue& given) {
  constexpr long kMaxFrame = 1000000000;
  std::set<std::size_t> frames;
  for (const std::string& number : text::split(given.text))
    frames.insert(
        static_cast<std::size_t>(OptionValue{given.option, given.form, number}.whole(0, kMaxFrame)));
  return frames;
}

/// In upper or lower case; `end` is in lower case.
bool ends_with(const std::string& text, const std::string& end) {
  return text.size() > end.size() &&
         std::equal(end.rbegin(), end.rend(), text.rbegin(),
                    [](char wanted, unsigned char letter) { return std::tolower(letter) == wanted; });
}

std::string film(const OptionValue& given) {
  if (!ends_with(given.text, ".webp") && !ends_with(given.text, ".mp4"))
    given.fail("is no film; allowed: a file that ends in .webp or .mp4");
  return given.text;
}

CommandLine command_line(ReplayArguments& a, bool& compare) {
  CommandLine line;
  line.flag("--compare", compare).flag("--explain", a.explain).flag("--serve", a.serve);
  line.once("--scene", "NAME|FILE", a.scene).once("--input", "FILE.bag|FILE.csv", a.input);
  line.once("--output", "DIR", a.output);
  line.once("--topic", "TOPIC", [&a](const OptionValue& given) { a.topic = given.text; });
  line.once("--params", "FILE.yaml", [&a](const OptionValue& given) { a.parameter_file = given.text; });
  line.each("--set", "KEY=VALUE", [&a](const OptionValue& given) { a.settings.push_back(given.setting()); });
  line.once("--export", "HZ",
            [&a](const OptionValue& given) { a.export_rate = rate(given, "the recording's"); });
  line.once("--markers", "RATE", [&a](const OptionValue& given) { a.marker_rate = rate(given); });
  line.once("--marker-frames", "FRAME,FRAME,...",
            [&a](const OptionValue& given) { a.marker_frames = frame_numbers(given); });
  line.once("--film", "FILE.webp|FILE.mp4", [&a](const OptionValue& given) { a.film = film(given); });
  line.each("--object-pose", "NAME,x,y,z,qx,qy,qz,qw", [&a](const OptionValue& given) {
    a.object_poses.emplace_back(object_name(given), pose(given, 1));
  });
  line.each("--object-twist", "NAME,vx,vy,vz,wx,wy,wz", [&a](const OptionValue& given) {
    a.object_twists.emplace_back(object_name(given), twist(given));
  });
  line.once("--hand-transform", "x,y,z,qx,qy,qz,qw",
            [&a](const OptionValue& given) { a.hand_transform = pose(given, 0); });
  line.once("--hand-order", "NAME", [&a](const OptionValue& given) { a.hands.order = order(given); });
  line.once("--hand-scale", "FACTOR",
            [&a](const OptionValue& given) { a.hands.scale = given.number(1e-6, 1e6); });
  for (const char* const side : {"left", "right", "both"}) {
    const std::string stands_for = std::string("hands/") + (side[0] == 'b' ? "" : side + std::string("/"));
    line.once(std::string("--") + side, "TOPIC", [&a, stands_for](const OptionValue& given) {
      a.hands.topics[given.text] = stands_for + "pose_array";
    });
  }
  return line;
}

void require(const char* option, const std::string& value) {
  if (value.empty()) throw UsageError(std::string(option) + " is missing; --help shows the usage");
}

/// Checks combinations. A bag needs no --scene if it has a log, and has a default output folder.
void check(ReplayArguments& arguments) {
  require("--input", arguments.input);
  const bool bag = ends_with(arguments.input, ".bag");
  if (!bag && !ends_with(arguments.input, ".csv")) {
    if (ends_with(arguments.input, ".bag.active"))
      throw UsageError(
          "--input " + arguments.input +
          ": a recording that was not ended; allowed: FILE.bag, which rosbag reindex makes of it "
          "once it is renamed");
    throw UsageError("--input " + arguments.input + ": unknown kind of file; allowed: FILE.bag or FILE.csv");
  }
  if (arguments.topic && !bag) throw UsageError("--topic: only a bag has topics");
  if (!arguments.hands.topics.empty() && (!bag || arguments.topic))
    throw UsageError("--left, --right and --both: only a bag has topics, and --topic chooses them too");
  if (!bag) require("--scene", arguments.scene);
  if (!bag) require("--output", arguments.output);
  if (arguments.output.empty())
    arguments.output = arguments.input.substr(0, arguments.input.size() - 4) + "_replay";
}

/// The arguments without the output folder and what is made of the results.
std::vector<std::string> repeatable(const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--explain" || words[i] == "--serve") continue;
    static const std::set<std::string> reports{"--output", "--export", "--markers", "--marker-frames",
                                               "--film"};
    if (reports.count(words[i]) > 0) {
      ++i;
    } else {
      kept.push_back(words[i]);
    }
  }
  return kept;
}

}  // namespace

ReplayArguments parse_replay_arguments(const std::vector<std::string>& arguments) {
  ReplayArguments parsed;
  bool compare = false;
  if (!arguments.empty() && arguments[0] == "--compare") {
    parsed.compare.assign(arguments.begin() + 1, arguments.end());
    if (parsed.compare.size() < 2) throw UsageError(kCompareUsage);
  } else if (!command_line(parsed, compare).read(arguments)) {
    parsed.help = true;
  } else if (compare) {
    throw UsageError(kCompareUsage);
  } else {
    check(parsed);
    parsed.repeatable = repeatable(arguments);
  }
  return parsed;
}

const char* replay_help() {
  return R"(usage: replay --input FILE.bag [options]
       replay --scene NAME|FILE --input FILE.bag|FILE.csv --output DIR [options]
       replay --compare DIR DIR [--tolerance METRES,RADIANS]

Repeats a live simulation from a bag of record.launch, or runs a recording of hands through a scene. Runs as fast as
the machine allows and needs no ROS master.

  --scene NAME|FILE         a shipped scene or a URDF file; default: as recorded
  --input FILE              a CSV recording, or a bag (leap_motion/Human, leap_motion_controller/Hand,
                            PoseArray, PointCloud or HandFrame)
  --output DIR              folder of objects.csv, contacts.csv, hands.csv, events.csv, summary.json; created if it is
                            missing; default for a bag: FILE_replay
  --topic TOPIC             of the bag; default: the topic of the live simulation, else /leap_motion/leap_device, else
                            hands/[left/|right/]pose_array and point_cloud, else the only topic of a suitable type
  --params FILE.yaml        parameters, under the names of the parameter server
  --set KEY=VALUE           one parameter; overrides --params; repeatable
  --object-pose NAME,x,y,z,qx,qy,qz,qw
                            start pose of an object's centre of mass in world [m]; repeatable
  --object-twist NAME,vx,vy,vz,wx,wy,wz
                            velocity of an object at the start, world axes [m/s, rad/s]; repeatable
  --hand-transform x,y,z,qx,qy,qz,qw
                            pose of the device frame in world; default: from the bag's /tf_static and /tf, else at the origin
                            and rotated by +90 degrees about x
  --left TOPIC, --right TOPIC, --both TOPIC
                            topics of the bag with hand joints, if they have other names
  --hand-order NAME         order of the joints in PoseArray and PointCloud, see docs/trackers.md; default: recognised
  --hand-scale FACTOR       metres per unit of the recording, such as 0.001 for millimetres
  --export HZ               runs scripts/export afterwards: demonstration.csv and demonstration.bag with standard messages
                            only; 0: a row for each frame
  --explain                 runs scripts/explain afterwards: explain.html and explain.json tell when and how each object
                            was held and why it was lost
  --markers RATE            also writes markers.bag: markers at this rate [Hz] for rviz and other viewers, and the hands,
                            objects and contacts of each frame for rviz's Interaction display
  --marker-frames FRAME,... markers.bag of these frames only, by their numbers in frames.csv
  --film FILE.webp|FILE.mp4 film of the run as rviz shows it; needs rviz, Xvfb, ImageMagick, and webp or ffmpeg
  --serve                   shows the run to browsers of this machine until Ctrl-C: web.launch hands:=bag with markers.bag
  --compare DIR DIR         runs scripts/compare: when and where the objects of two runs diverge, by how much, and whether
                            the runs are equal bit by bit
  --tolerance METRES,RADIANS
                            tolerance of --compare; default 1e-9,1e-9; 0,0: equal to the last digit
  --help                    this text

Exit status: 0 done, 1 bad data (what was written stays) or runs that diverge, 2 bad usage.
)";
}

}  // namespace mrhi
