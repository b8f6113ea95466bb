#include "mr_hand_interaction/ros/server_parameters.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "mr_hand_interaction/parameters.h"

namespace mrhi {
namespace {

const std::string kTwists = "object_twist/";
/// What dynamic_reconfigure shows, and hand tracking's own in the same process.
const std::string kTuned = "tune/", kTracking = "hand_tracking/";
/// Read by libraries that the node uses.
const std::set<std::string> kOthers{"diagnostic_period", "diagnostic_updater_use_fqn", "tf_prefix"};

bool begins_with(const std::string& name, const std::string& prefix) {
  return name.compare(0, prefix.size(), prefix) == 0;
}

bool is_for_others(const std::string& name) {
  return kOthers.count(name) > 0 || begins_with(name, kTuned) || begins_with(name, kTracking);
}

std::string text_parameter(const std::string& name, const XmlRpc::XmlRpcValue& value) {
  XmlRpc::XmlRpcValue copy = value;
  if (copy.getType() != XmlRpc::XmlRpcValue::TypeString || static_cast<std::string>(copy).empty()) {
    throw ParameterError("parameter '" + name + "': " + yaml_text(copy) + " is not allowed; allowed: text");
  }
  return static_cast<std::string>(copy);
}

bool truth_parameter(const std::string& name, const XmlRpc::XmlRpcValue& value) {
  const std::string text = yaml_text(value);
  if (text == "true" || text == "false") return text == "true";
  throw ParameterError("parameter '" + name + "': " + text + " is not allowed; allowed: true, false");
}

HapticsRate haptics_rate(const std::string& name, const XmlRpc::XmlRpcValue& value) {
  const std::string rate = yaml_text(value);
  if (rate == "frame") return HapticsRate::frame;
  if (rate == "step") return HapticsRate::step;
  throw ParameterError("parameter '" + name + "': " + rate + " is not allowed; allowed: frame, step");
}

void require_known(const std::string& name) {
  std::string allowed = "scene, fixed_frame, haptics/rate, place_by_mouse, standard_outputs";
  for (const std::string& known : parameter_names()) {
    if (known == name) return;
    allowed += ", " + known;
  }
  throw ParameterError("unknown parameter '" + name + "'; allowed: " + allowed);
}

Twist twist_parameter(const std::string& name, const XmlRpc::XmlRpcValue& value) {
  XmlRpc::XmlRpcValue copy = value;
  std::array<double, 6> v{};
  bool good = copy.getType() == XmlRpc::XmlRpcValue::TypeArray && copy.size() == 6;
  for (int i = 0; good && i < 6; ++i) {
    const auto type = copy[i].getType();
    if (type == XmlRpc::XmlRpcValue::TypeInt) {
      v[static_cast<std::size_t>(i)] = static_cast<int>(copy[i]);
    } else if (type == XmlRpc::XmlRpcValue::TypeDouble) {
      v[static_cast<std::size_t>(i)] = static_cast<double>(copy[i]);
    } else {
      good = false;
    }
    good = good && std::isfinite(v[static_cast<std::size_t>(i)]);
  }
  if (good) return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  throw ParameterError("parameter '" + name + "': " + yaml_text(copy) +
                       " is not allowed; allowed: six numbers [vx, vy, vz, wx, wy, wz] in m/s and rad/s");
}

void take(const std::string& name, const XmlRpc::XmlRpcValue& value, ServerParameters& parameters) {
  if (name == "scene") {
    parameters.scene = text_parameter(name, value);
  } else if (name == "fixed_frame") {
    parameters.fixed_frame = text_parameter(name, value);
  } else if (name == "place_by_mouse") {
    parameters.place_by_mouse = truth_parameter(name, value);
  } else if (name == "standard_outputs") {
    parameters.standard_outputs = truth_parameter(name, value);
  } else if (name == "haptics/rate") {
    parameters.haptics_rate = haptics_rate(name, value);
  } else if (begins_with(name, kTwists)) {
    parameters.object_twists[name.substr(kTwists.size())] = twist_parameter(name, value);
  } else if (!is_for_others(name)) {
    require_known(name);
    set_parameter(parameters.configuration, name, yaml_text(value));
  }
}

void take_all(const std::string& prefix, XmlRpc::XmlRpcValue& values, ServerParameters& parameters) {
  for (auto& [name, value] : values) {
    if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
      take_all(prefix + name + "/", value, parameters);
    } else {
      take(prefix + name, value, parameters);
    }
  }
}

}  // namespace

std::string yaml_text(XmlRpc::XmlRpcValue value) {
  using Value = XmlRpc::XmlRpcValue;
  switch (value.getType()) {
    case Value::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case Value::TypeInt:
      return std::to_string(static_cast<int>(value));
    case Value::TypeString:
      return static_cast<std::string>(value);
    case Value::TypeDouble: {
      char text[32];
      std::snprintf(text, sizeof text, "%.17g", static_cast<double>(value));
      return text;
    }
    case Value::TypeArray: {
      std::string text;
      for (int i = 0; i < value.size(); ++i) text += (i > 0 ? ", " : "") + yaml_text(value[i]);
      return "[" + text + "]";
    }
    default:
      return "a value of no known type";
  }
}

ServerParameters read_server_parameters(const ros::NodeHandle& private_node) {
  ServerParameters parameters;
  XmlRpc::XmlRpcValue values;
  if (private_node.getParam(private_node.getNamespace(), values) &&
      values.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
    take_all("", values, parameters);
  }
  validate(parameters.configuration);
  return parameters;
}

}  // namespace mrhi
