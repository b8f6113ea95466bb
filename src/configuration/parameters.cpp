#include "mr_hand_interaction/parameters.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <type_traits>
#include <utility>

#include "../scene/limits.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "../tracking/hand_filter.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {
namespace {

using body_limits::kGravity;
constexpr Range kGravitySlider{-10, 10};  // [m/s^2]

/// One public parameter: functions to set, list and reject it.
struct ParameterEntry {
  std::string name;
  std::string allowed;  ///< allowed values, for messages
  /// Returns false without a change if the value has a wrong type or is out of range.
  std::function<bool(Configuration&, const YAML::Node&)> assign;
  /// Present value, as YAML for `assign`.
  std::function<std::string(const Configuration&)> text;
  std::optional<ParameterLimits> limits;  ///< of a number, or of each of several
};

/// Value of a number: the number, or empty for the word that stands for its absence.
std::optional<double> number_in(double value) {
  return std::isinf(value) ? std::nullopt : std::make_optional(value);
}
std::optional<double> number_in(const std::optional<double>& value) {
  return value;
}
template <class Number>
void set_number(const std::optional<double>& number, Number& value) {
  if constexpr (std::is_same_v<Number, std::optional<double>>) {
    value = number;
  } else {
    value = static_cast<Number>(number.value_or(HandStrength::kUnlimited));
  }
}

/// Accessor of a parameter's storage: a member of a configuration, of its part, or of a part's part.
template <class... Members>
auto of(Members... members) {
  return [=](auto& configuration) -> auto& {
    return (configuration.*....*members);
  };
}

/// A parameter's value that is not a number, with its meaning.
struct Word {
  std::string word, meaning;
};

/// A number in `range`, ends included, or a word; a slider spans `slider`, all or a part of it. `access`
/// returns the member of a configuration: a double, an int, or an optional number.
template <class Access>
ParameterEntry number(const std::string& name, const std::string& unit, const Range& range,
                      const Range& slider, Access access, const Word& otherwise = {}) {
  constexpr bool kWhole = std::is_same_v<int&, decltype(access(std::declval<Configuration&>()))>;
  const std::string word = otherwise.word;
  std::string allowed = range.describe() + unit;
  if (kWhole) allowed = "a whole number from " + text::exact(range.min) + " to " + text::exact(range.max);
  if (!word.empty()) allowed += ", or '" + word + "'" + otherwise.meaning;
  return {name, allowed,
          [=](Configuration& configuration, const YAML::Node& node) {
            const bool is_word = !word.empty() && node.IsScalar() && node.Scalar() == word;
            const std::optional<double> value = is_word ? std::nullopt : yaml_number(node);
            if (!is_word && (!value || !range.contains(*value) || (kWhole && !yaml_integer(node))))
              return false;
            set_number(value, access(configuration));
            return true;
          },
          [=](const Configuration& configuration) {
            const std::optional<double> value = number_in(access(configuration));
            return value ? text::exact(*value) : word;
          },
          ParameterLimits{range.min, range.max, slider.min, slider.max}};
}

template <class T>
struct NamedValue {
  std::string name;
  T value;
};

template <class T, class Access>
ParameterEntry choice(const std::string& name, const std::vector<NamedValue<T>>& options, Access access) {
  return {name,
          text::joined(text::names_of(options)),
          [=](Configuration& configuration, const YAML::Node& node) {
            // Python and other writers of YAML have True and TRUE.
            const std::string word = !node.IsScalar()          ? ""
                                     : std::is_same_v<T, bool> ? text::in_lower_case(node.Scalar())
                                                               : node.Scalar();
            const auto* const chosen = text::find_named(options, word);
            if (chosen != nullptr) access(configuration) = chosen->value;
            return chosen != nullptr;
          },
          [=](const Configuration& configuration) {
            const T& value = access(configuration);
            return std::find_if(options.begin(), options.end(),
                                [&](const auto& option) { return option.value == value; })
                ->name;
          },
          {}};
}

template <class Access>
ParameterEntry on_or_off(const std::string& name, Access access) {
  return choice<bool>(name, {{"true", true}, {"false", false}}, access);
}

bool assign_gravity(Configuration& configuration, const YAML::Node& node) {
  const bool of_the_scene = node.IsScalar() && node.Scalar() == "scene";
  const std::optional<Vector3> value = yaml_vector(node);
  const bool in_limits =
      value && kGravity.contains(value->minCoeff()) && kGravity.contains(value->maxCoeff());
  if (!in_limits && !of_the_scene) return false;
  configuration.gravity = value;
  return true;
}

std::string gravity_text(const Configuration& configuration) {
  return configuration.gravity ? text::exact(*configuration.gravity) : "scene";
}

/// One of the registered models or filters, by their names.
template <class Kind, class Entry, class Access>
ParameterEntry named_choice(const std::string& name, const std::vector<const Entry*>& entries,
                            Access access) {
  std::vector<NamedValue<Kind>> kinds;
  kinds.reserve(entries.size());
  for (const Entry* entry : entries) kinds.push_back({entry->name, {entry->name}});
  return choice(name, kinds, access);
}

std::vector<ParameterEntry> members() {
  using C = Configuration;
  using T = ContactConfiguration;
  using H = HandStrength;
  const Word unlimited{"unlimited", ""}, material{"material", " for that of the object's material"};
  return {
      named_choice<ContactModelKind>("contact_model", contact_models(), of(&C::contact_model)),
      {"gravity", "three numbers [x, y, z] from -100 to 100 in m/s^2, or 'scene' for the scene's own",
       assign_gravity, gravity_text,
       ParameterLimits{kGravity.min, kGravity.max, kGravitySlider.min, kGravitySlider.max}},
      number("step", " [s]", {1e-5, 0.05}, {0.0002, 0.01}, of(&C::step)),
      number("scene/density", " [kg/m^3]", {0.1, 1e5}, {10, 10000}, of(&C::density)),
      number("tracking/hold_time", " [s]", {0, 10}, {0, 2},
             of(&C::tracking, &TrackingConfiguration::hold_time)),
      number("tracking/max_speed", " [m/s]", {0.1, 1000}, {1, 50},
             of(&C::tracking, &TrackingConfiguration::max_speed)),
      on_or_off("seed/literal", of(&C::contact, &T::literal)),
      number("contact/object_stiffness", " [N/m]", {1, 1e9}, {1e4, 1e8},
             of(&C::contact, &T::object_stiffness)),
      // Refinements of contact.
      on_or_off("contact/anchors", of(&C::contact, &T::anchors)),
      on_or_off("contact/damping", of(&C::contact, &T::damping)),
      on_or_off("contact/edge_grip", of(&C::contact, &T::edge_grip)),
      on_or_off("contact/entry_face", of(&C::contact, &T::entry_face)),
      on_or_off("contact/grasp_assist", of(&C::contact, &T::grasp_assist)),
      on_or_off("contact/impact_friction", of(&C::contact, &T::impact_friction)),
      on_or_off("contact/release_fade", of(&C::contact, &T::release_fade)),
      on_or_off("contact/sleep", of(&C::contact, &T::sleep)),
      on_or_off("contact/sweep", of(&C::contact, &T::sweep)),
      on_or_off("contact/swing_back", of(&C::contact, &T::swing_back)),
      on_or_off("contact/torsion", of(&C::contact, &T::torsion)),
      on_or_off("contact/two_points", of(&C::contact, &T::two_points)),
      number("hand/strength", " [N]", {0.1, 1000}, {1, 100}, of(&C::contact, &T::hand, &H::finger),
             unlimited),
      number("hand/palm_strength", " [N]", {0.1, 1000}, {1, 200}, of(&C::contact, &T::hand, &H::palm),
             unlimited),
      number("hand/finger_mass", " [kg]", {0.001, 10}, {0.005, 0.5},
             of(&C::contact, &T::hand, &H::finger_mass), unlimited),
      number("hand/palm_mass", " [kg]", {0.001, 10}, {0.05, 2}, of(&C::contact, &T::hand, &H::palm_mass),
             unlimited),
      number("hand/pad", " [m]", {0, 0.01}, {0, 0.005}, of(&C::contact, &T::hand, &H::pad)),
      number("hand/restitution", "", {0, 1}, {0, 1}, of(&C::contact, &T::hand, &H::restitution), material),
      number("hand/joint_speed", " [rad/s]", {0.1, 100}, {0.5, 20}, of(&C::hand_joint_speed), unlimited),
      number("hand/radius_scale", "", {0.1, 10}, {0.5, 2}, of(&C::hand_radius_scale)),
      number("rendering/control_display_ratio", "", {1, 2}, {1, 2}, of(&C::control_display_ratio)),
  };
}

std::vector<ParameterEntry> filter_parameters() {
  std::vector<ParameterEntry> entries{named_choice<FilterKind>(
      "filter/type", hand_filters(), of(&Configuration::filter, &FilterConfiguration::type))};
  for (const FilterSetting& setting : filter_settings()) {
    const std::string meaning = *setting.meaning ? " " + std::string(setting.meaning) : "";
    const auto add = [&](auto member) {
      entries.push_back(number(std::string("filter/") + setting.name, setting.unit, setting.range,
                               setting.slider, of(&Configuration::filter, member), {setting.word, meaning}));
    };
    std::visit(add, setting.value);
  }
  return entries;
}

std::vector<ParameterEntry> material_parameters() {
  std::vector<ParameterEntry> entries;
  for (const MaterialField& field : material_fields()) {
    const auto add = [&](auto member, const Word& otherwise) {
      entries.push_back(number(std::string("material/") + field.name, field.unit, field.range, field.slider,
                               member, otherwise));
    };
    if (field.value == &Material::stiffness) {
      add(of(&Configuration::stiffness), {"model", " for the contact model's own"});
    } else {
      add(of(&Configuration::material, field.value), {});
    }
  }
  return entries;
}

const std::vector<ParameterEntry>& parameter_table() {
  static const std::vector<ParameterEntry> table = [] {
    std::vector<ParameterEntry> all;
    for (auto* some : {members, filter_parameters, material_parameters})
      for (ParameterEntry& entry : some()) all.push_back(std::move(entry));
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return all;
  }();
  return table;
}

const ParameterEntry& entry_of(const std::string& name) {
  if (const ParameterEntry* const entry = text::find_named(parameter_table(), name)) return *entry;
  throw ParameterError("unknown parameter '" + text::one_line(name, 60) +
                       "'; allowed: " + text::joined(parameter_names()));
}

void assign(Configuration& configuration, const std::string& name, const YAML::Node& node) {
  const ParameterEntry& entry = entry_of(name);
  if (entry.assign(configuration, node)) return;
  throw ParameterError("parameter '" + name + "': " + yaml_text(node) +
                       " is not allowed; allowed: " + entry.allowed);
}

/// Sets the parameters of a map; nested maps are name spaces. `seen`: names set so far.
void read_map(const std::string& file, const YAML::Node& map, const std::string& prefix,
              std::set<std::string>& seen, Configuration& configuration) {
  for (const auto& entry : map) {
    const YAML::Node node = entry.second;
    const std::string name = prefix + yaml_text(entry.first);
    if (node.IsMap()) {
      read_map(file, node, name + "/", seen, configuration);
      continue;
    }
    rethrown<ParameterError, ParameterError>(yaml_place(file, node.Mark()) + ": ", [&] {
      if (!seen.insert(name).second)
        throw ParameterError("parameter '" + name + "' is given twice; allowed: once");
      assign(configuration, name, node);
    });
  }
}

}  // namespace

void set_parameter(Configuration& configuration, const std::string& name, const std::string& yaml_value) {
  const std::string what =
      "parameter '" + text::one_line(name, 60) + "': '" + text::one_line(yaml_value, 60) + "'";
  rethrown<ParameterError, YamlError>("", [&] { assign(configuration, name, load_yaml(what, yaml_value)); });
}

void load_parameters(Configuration& configuration, const std::string& yaml_file) {
  read_yaml<ParameterError>(yaml_file, [&] {
    const YAML::Node root = load_yaml_file(yaml_file);
    if (!root.IsMap() && !root.IsNull()) {
      throw ParameterError(yaml_file + ": " + yaml_text(root) +
                           " is not allowed; allowed: a map of parameters");
    }
    Configuration changed = configuration;
    std::set<std::string> seen;
    read_map(yaml_file, root, "", seen, changed);
    configuration = changed;
  });
}

void validate(const Configuration& configuration) {
  Configuration copy = configuration;
  for (const ParameterEntry& entry : parameter_table()) {
    if (entry.limits) assign(copy, entry.name, YAML::Load(entry.text(configuration)));
  }
  if (const auto conflict = material_conflict(configuration.material)) {
    throw ParameterError("parameter 'material/dynamic_friction': " + *conflict);
  }
}

std::string parameter_text(const Configuration& configuration, const std::string& name) {
  return entry_of(name).text(configuration);
}

std::map<std::string, std::string> parameter_texts(const Configuration& configuration) {
  std::map<std::string, std::string> texts;
  for (const ParameterEntry& entry : parameter_table()) texts[entry.name] = entry.text(configuration);
  return texts;
}

std::optional<ParameterLimits> parameter_limits(const std::string& name) {
  return entry_of(name).limits;
}

std::vector<std::string> parameter_names() {
  return text::names_of(parameter_table());
}

}  // namespace mrhi
