#include "mr_hand_interaction/replay/arguments.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>

#include "../text/text.h"

namespace mrhi {
namespace {

constexpr double kShortestQuaternion = 1e-6;

/// The values of one option, for reading and for saying what is wrong with them.
struct OptionText {
  std::string option, form, text;

  [[noreturn]] void refuse(const std::string& what) const {
    throw UsageError(option + " " + text + ": " + what + "; allowed: " + option + " " + form);
  }

  std::vector<double> numbers(const std::vector<std::string>& fields, std::size_t first,
                              std::size_t count) const {
    if (fields.size() != first + count) {
      refuse(std::to_string(fields.size()) + " fields instead of " + std::to_string(first + count));
    }
    std::vector<double> values;
    for (std::size_t i = first; i < fields.size(); ++i) {
      char* end = nullptr;
      values.push_back(std::strtod(fields[i].c_str(), &end));
      if (fields[i].empty() || *end != '\0' || !std::isfinite(values.back())) {
        refuse("'" + fields[i] + "' is no finite number");
      }
    }
    return values;
  }

  Pose pose(const std::vector<std::string>& fields, std::size_t first) const {
    const std::vector<double> v = numbers(fields, first, 7);
    Quaternion orientation(v[6], v[3], v[4], v[5]);
    const double length = orientation.norm();
    if (!std::isfinite(length) || length < kShortestQuaternion) refuse("the quaternion has no direction");
    orientation.coeffs() /= length;
    return {{v[0], v[1], v[2]}, orientation};
  }

  Twist twist(const std::vector<std::string>& fields, std::size_t first) const {
    const std::vector<double> v = numbers(fields, first, 6);
    return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  }

  const std::string& object_name(const std::vector<std::string>& fields) const {
    if (fields.front().empty()) refuse("the object's name is missing");
    return fields.front();
  }
};

struct Option {
  std::string form;
  bool repeatable;
  std::function<void(ReplayArguments&, const OptionText&)> read;
};

void read_setting(ReplayArguments& arguments, const OptionText& value) {
  const std::size_t equals = value.text.find('=');
  if (equals == std::string::npos || equals == 0) value.refuse("no KEY=VALUE");
  arguments.settings.emplace_back(value.text.substr(0, equals), value.text.substr(equals + 1));
}

const std::map<std::string, Option>& options() {
  using A = ReplayArguments;
  static const std::map<std::string, Option> table{
      {"--scene", {"NAME|FILE", false, [](A& a, const OptionText& v) { a.scene = v.text; }}},
      {"--input", {"FILE.bag|FILE.csv", false, [](A& a, const OptionText& v) { a.input = v.text; }}},
      {"--output", {"DIR", false, [](A& a, const OptionText& v) { a.output = v.text; }}},
      {"--topic", {"TOPIC", false, [](A& a, const OptionText& v) { a.topic = v.text; }}},
      {"--params", {"FILE.yaml", false, [](A& a, const OptionText& v) { a.parameter_file = v.text; }}},
      {"--set", {"KEY=VALUE", true, read_setting}},
      {"--export",
       {"HZ", false,
        [](A& a, const OptionText& v) {
          a.demonstration = v.numbers({v.text}, 0, 1).front();
          if (!(*a.demonstration == 0.0 || (*a.demonstration >= 1.0 && *a.demonstration <= 1000.0)))
            v.refuse("is no rate from 1 to 1000 Hz, and not 0 for the recording's");
        }}},
      {"--object-pose",
       {"NAME,x,y,z,qx,qy,qz,qw", true,
        [](A& a, const OptionText& v) {
          const auto fields = text::split(v.text);
          a.object_poses.emplace_back(v.object_name(fields), v.pose(fields, 1));
        }}},
      {"--object-twist",
       {"NAME,vx,vy,vz,wx,wy,wz", true,
        [](A& a, const OptionText& v) {
          const auto fields = text::split(v.text);
          a.object_twists.emplace_back(v.object_name(fields), v.twist(fields, 1));
        }}},
      {"--hand-transform", {"x,y,z,qx,qy,qz,qw", false, [](A& a, const OptionText& v) {
                              a.hand_transform = v.pose(text::split(v.text), 0);
                            }}}};
  return table;
}

std::string option_names() {
  std::string names = "--help, --compare, --explain";
  for (const auto& entry : options()) names += ", " + entry.first;
  return names;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void require(const char* option, const std::string& value) {
  if (value.empty()) throw UsageError(std::string(option) + " is missing; --help shows the usage");
}

/// A bag may tell its scene, and has a place for what comes of it.
void check(ReplayArguments& arguments) {
  require("--input", arguments.input);
  const bool bag = ends_with(arguments.input, ".bag");
  if (!bag && !ends_with(arguments.input, ".csv")) {
    throw UsageError("--input " + arguments.input + ": unknown kind of file; allowed: FILE.bag or FILE.csv");
  }
  if (arguments.topic && !bag) throw UsageError("--topic: only a bag has topics");
  if (!bag) require("--scene", arguments.scene);
  if (!bag) require("--output", arguments.output);
  if (arguments.output.empty())
    arguments.output = arguments.input.substr(0, arguments.input.size() - 4) + "_replay";
}

constexpr const char* kCompareUsage =
    "--compare takes the folders of two runs, then --tolerance METRES,RADIANS or nothing";

void read_comparison(const std::vector<std::string>& arguments, ReplayArguments& parsed) {
  const bool tolerant = arguments.size() == 5 && arguments[3] == "--tolerance";
  if (arguments.size() != 3 && !tolerant) throw UsageError(kCompareUsage);
  parsed.compare = {arguments[1], arguments[2]};
  if (!tolerant) return;
  const OptionText text{"--tolerance", "METRES,RADIANS, each from 0 to 1", arguments[4]};
  const std::vector<double> values = text.numbers(text::split(text.text), 0, 2);
  for (const double value : values)
    if (!(value >= 0.0 && value <= 1.0)) text.refuse("out of range");
  parsed.tolerance = {values[0], values[1]};
}

}  // namespace

ReplayArguments parse_replay_arguments(const std::vector<std::string>& arguments) {
  ReplayArguments parsed;
  std::map<std::string, int> seen;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& name = arguments[i];
    if (name == "--help" || name == "-h") {
      parsed.help = true;
      return parsed;
    }
    if (name == "--compare") {
      if (i != 0) throw UsageError(kCompareUsage);
      read_comparison(arguments, parsed);
      return parsed;
    }
    if (name == "--explain") {
      parsed.explain = true;
      continue;
    }
    const auto option = options().find(name);
    if (option == options().end()) {
      throw UsageError("unknown argument '" + name + "'; allowed: " + option_names());
    }
    const auto& [form, repeatable, read] = option->second;
    if (++seen[name] > 1 && !repeatable) throw UsageError(name + " is given twice; allowed: once");
    if (i + 1 == arguments.size() || arguments[i + 1].empty() || options().count(arguments[i + 1]) > 0) {
      throw UsageError(name + " needs a value: " + name + " " + form);
    }
    read(parsed, {name, form, arguments[++i]});
  }
  check(parsed);
  return parsed;
}

const char* replay_help() {
  return R"(usage: replay --input FILE.bag [options]
       replay --scene NAME|FILE --input FILE.bag|FILE.csv --output DIR [options]
       replay --compare DIR DIR [--tolerance METRES,RADIANS]

Does again what a live simulation did, from a bag of record.launch; or runs a recording of hands through a scene. As
fast as the machine goes; needs no ROS master.

  --scene NAME|FILE         a shipped scene, or a URDF file; else as recorded
  --input FILE              a CSV recording, or a bag (leap_motion/Human, PoseArray, PointCloud or HandFrame)
  --output DIR              created if need be; objects.csv, contacts.csv, hands.csv, events.csv, summary.json;
                            of a bag FILE_replay where none is given
  --topic TOPIC             of the bag; else what the live simulation took, /leap_motion/leap_device, /hands/[left/|right/]pose_array or point_cloud, or the only fitting
  --params FILE.yaml        parameters, under the names of the parameter server
  --set KEY=VALUE           one parameter; stands above --params; repeatable
  --object-pose NAME,x,y,z,qx,qy,qz,qw
                            where an object's centre of mass starts, in world [m]; repeatable
  --object-twist NAME,vx,vy,vz,wx,wy,wz
                            how it moves at the start, world axes [m/s, rad/s]; repeatable
  --hand-transform x,y,z,qx,qy,qz,qw
                            pose of the device frame in world; else the bag's /tf_static, else at the origin
                            and turned by +90 degrees about x
  --export HZ               demonstration.csv and demonstration.bag too, of standard messages alone; 0: a row for
                            each frame
  --explain                 explain.html and explain.json too: when each object was held, how, and why it was lost
  --compare DIR DIR         when and where the objects of two runs part, and by how much, and whether the bits are the
                            same
  --tolerance METRES,RADIANS
                            what --compare takes as the same place; else 1e-9,1e-9; 0,0: the same to the last digit
  --help                    this text

Exit status: 0 done, 1 bad data (what was written stays) or runs that part, 2 bad usage.
)";
}

}  // namespace mrhi
