#include "node.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <iostream>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "../text/yaml.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/server_parameters.h"

namespace mrhi {
namespace {

constexpr std::chrono::seconds kPeriod(2);

enum class Registration { known, unknown, no_master };

Registration registration() {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = request[1] = ros::this_node::getName();
  if (ros::master::execute("lookupNode", request, response, payload, false)) return Registration::known;
  return response.valid() ? Registration::unknown : Registration::no_master;
}

/// Logs a change.
void log_change(Registration before, Registration now) {
  const char* const uri = ros::master::getURI().c_str();
  if (now == Registration::no_master)
    ROS_WARN("no ROS master at %s: existing connections stay, new ones are impossible", uri);
  if (now == Registration::unknown)
    ROS_ERROR(
        "the ROS master at %s was restarted and does not know this node; existing connections stay, new ones "
        "are impossible: start this node again",
        uri);
  if (now == Registration::known && before == Registration::no_master)
    ROS_INFO("the ROS master at %s is back", uri);
}

/// Logs when the ROS master is gone, and when a new one does not know this node. Existing connections
/// continue without a master, but new ones need a restart of the node. Uses its own thread, as calls to a
/// master on a broken network block. To be created beside a NodeHandle, which has registered the node.
class MasterWatch {
 public:
  MasterWatch() : thread_([this] { run(); }) {}

  ~MasterWatch() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      end_ = true;
    }
    ended_.notify_all();
    thread_.join();
  }

 private:
  void run() {
    Registration before = Registration::known;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kPeriod, [this] { return end_; })) {
      lock.unlock();
      const Registration now = registration();
      lock.lock();
      if (end_ || !ros::ok()) continue;
      if (now != before) log_change(before, now);
      before = now;
    }
  }

  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

/// Exit status determined by the arguments alone, before there is a master; empty: run the node.
std::optional<int> status_of_arguments(int argc, char** argv, const char* usage) {
  std::vector<std::string> words;
  ros::removeROSArgs(argc, argv, words);
  if (words.size() < 2) return std::nullopt;
  if (words[1] == "--help" || words[1] == "-h") {
    std::cout << usage;
    return 0;
  }
  const std::string name = words[0].substr(words[0].rfind('/') + 1);
  std::cerr << name << ": unknown argument '" << words[1]
            << "'; allowed: --help; parameters and topics are set as _NAME:=VALUE and TOPIC:=OTHER\n";
  return 2;
}

const std::string kTwists = "object_twist/";

/// Lets the node finish its work on these signals. Call after ros::init().
void end_in_order() {
  struct sigaction action {};
  action.sa_handler = [](int) { ros::requestShutdown(); };  // only sets a flag
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT}) sigaction(signal, &action, nullptr);
}

}  // namespace

int run_node(int argc, char** argv, const char* name, const char* usage, const NodeBody& body) {
  if (const auto status = status_of_arguments(argc, argv, usage)) return *status;
  ros::init(argc, argv, name);
  end_in_order();
  const ros::NodeHandle node, private_node("~");  // outlive what may throw: without a node nothing is logged
  const MasterWatch master;
  try {
    body(node, private_node);
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}

NodeParameters& NodeParameters::add(const std::string& name, const std::string& allowed, const Take& take) {
  entries_.push_back({name, allowed, take});
  return *this;
}

NodeParameters& NodeParameters::text(const std::string& name, std::string& value) {
  return add(name, "text", [&value](const std::string&, const std::string& text) {
    value = text;
    return true;
  });
}

NodeParameters& NodeParameters::required(const std::string& name, const std::string& allowed,
                                         std::string& value) {
  text(name, value);
  entries_.back().allowed = allowed;
  entries_.back().required = &value;
  return *this;
}

NodeParameters& NodeParameters::number(const std::string& name, double min, double max, double& value,
                                       const std::string& more) {
  const Range range(min, max);
  return add(name, range.describe() + more, [range, &value](const std::string&, const std::string& text) {
    const auto number = text::to_number(text);
    if (!number || !range.contains(*number)) return false;
    value = *number;
    return true;
  });
}

NodeParameters& NodeParameters::truth(const std::string& name, bool& value) {
  return choice<bool>(name, {{"true", true}, {"false", false}}, value);
}

void NodeParameters::read(const ros::NodeHandle& private_node) const {
  XmlRpc::XmlRpcValue values;
  if (private_node.getParam(private_node.getNamespace(), values) &&
      values.getType() == XmlRpc::XmlRpcValue::TypeStruct)
    take_all("", values);
  for (const Entry& entry : entries_)
    if (entry.required != nullptr && entry.required->empty()) entry.refuse(entry.name, "");
}

void NodeParameters::Entry::refuse(const std::string& as, const std::string& text) const {
  throw ParameterError("parameter '" + as + "': " + (text.empty() ? "''" : text::one_line(text, 60)) +
                       " is not allowed; allowed: " + allowed);
}

void NodeParameters::take_all(const std::string& prefix, XmlRpc::XmlRpcValue& values) const {
  for (auto& [name, value] : values) {
    if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
      take_all(prefix + name + "/", value);
    } else {
      take(prefix + name, yaml_text(value));
    }
  }
}

void NodeParameters::take(const std::string& name, const std::string& text) const {
  // Parameters of libraries that nodes use.
  static const std::set<std::string> others{"diagnostic_period", "diagnostic_updater_use_fqn", "tf_prefix"};
  if (others.count(name) > 0) return;
  std::vector<std::string> names;
  for (const Entry& entry : entries_) {
    const bool space = entry.name.back() == '/';
    if (name == entry.name || (space && name.compare(0, entry.name.size(), entry.name) == 0)) {
      if (entry.take(name, text)) return;
      entry.refuse(name, text);
    }
    if (!space) names.push_back(entry.name);
  }
  throw ParameterError("unknown parameter '" + text::one_line(name, 60) +
                       "'; allowed: " + text::joined(names));
}

std::string yaml_text(XmlRpc::XmlRpcValue value) {
  using Value = XmlRpc::XmlRpcValue;
  switch (value.getType()) {
    case Value::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case Value::TypeInt:
      return std::to_string(static_cast<int>(value));
    case Value::TypeString:
      return static_cast<std::string>(value);
    case Value::TypeDouble:
      return text::exact(static_cast<double>(value));
    case Value::TypeArray: {
      std::vector<std::string> items;
      for (int i = 0; i < value.size(); ++i) items.push_back(yaml_text(value[i]));
      return "[" + text::joined(items) + "]";
    }
    default:
      return "a value of no known type";
  }
}

ServerParameters read_server_parameters(const ros::NodeHandle& private_node) {
  ServerParameters read;
  NodeParameters known;
  known.required("scene", "text", read.scene).required("fixed_frame", "text", read.fixed_frame);
  known.choice<HapticsRate>("haptics/rate", {{"frame", HapticsRate::frame}, {"step", HapticsRate::step}},
                            read.haptics_rate);
  known.truth("place_by_mouse", read.place_by_mouse).truth("standard_outputs", read.standard_outputs);
  known.add(
      kTwists, "six numbers [vx, vy, vz, wx, wy, wz] in m/s and rad/s",
      [&read](const std::string& name, const std::string& text) {
        const std::string source = "parameter '" + name + "'";
        const auto v =
            read_yaml<ParameterError>(source, [&] { return yaml_numbers(load_yaml(source, text), 6); });
        if (v) read.object_twists[name.substr(kTwists.size())] = {Vector3(v->data()), Vector3(v->data() + 3)};
        return v.has_value();
      });
  const auto leave = [](const std::string&, const std::string&) { return true; };
  // Parameters of dynamic_reconfigure, and of hand tracking in the same process.
  known.add("tune/", "", leave).add("hand_tracking/", "", leave);
  for (const std::string& parameter : parameter_names())
    known.add(parameter, "", [&read](const std::string& name, const std::string& text) {
      set_parameter(read.configuration, name, text);
      return true;
    });
  known.read(private_node);
  validate(read.configuration);
  return read;
}

}  // namespace mrhi
