#include "mr_hand_interaction/ros/server_parameters.h"

#include <optional>

#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/parameters.h"
#include "node.h"

namespace mrhi {
namespace {

const std::string kTwists = "object_twist/";

std::optional<Twist> twist_in(const std::string& name, const std::string& text) {
  return read_yaml<ParameterError>("parameter '" + name + "'", [&]() -> std::optional<Twist> {
    const auto v = yaml_numbers(load_yaml("parameter '" + name + "'", text), 6);
    return v ? std::make_optional(Twist{Vector3(v->data()), Vector3(v->data() + 3)}) : std::nullopt;
  });
}

/// A name that must not be empty.
NodeParameters::Take name_of(std::string& value) {
  return [&value](const std::string&, const std::string& text) {
    value = text;
    return !text.empty();
  };
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
  known.add("scene", "text", name_of(read.scene)).add("fixed_frame", "text", name_of(read.fixed_frame));
  known.choice<HapticsRate>("haptics/rate", {{"frame", HapticsRate::frame}, {"step", HapticsRate::step}},
                            read.haptics_rate);
  known.truth("place_by_mouse", read.place_by_mouse).truth("standard_outputs", read.standard_outputs);
  known.add(kTwists, "six numbers [vx, vy, vz, wx, wy, wz] in m/s and rad/s",
            [&read](const std::string& name, const std::string& text) {
              const std::optional<Twist> twist = twist_in(name, text);
              if (twist) read.object_twists[name.substr(kTwists.size())] = *twist;
              return twist.has_value();
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
