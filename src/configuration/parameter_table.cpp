#include "parameter_table.h"

#include <algorithm>
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

ParameterLimits limits(const Range& range, const Range& slider) {
  return {range.min, range.max, slider.min, slider.max};
}

template <class T>
using Member = std::function<T&(Configuration&)>;

template <class T>
T value_of(Configuration configuration, const Member<T>& member) {
  return member(configuration);
}

/// A number in `range`, both ends of which are allowed; a slider spans `slider`, which is all of it or a
/// part.
ParameterEntry number(const std::string& name, const std::string& unit, const Range& range,
                      const Range& slider, const Member<double>& member) {
  return {name, range.describe() + unit,
          [=](Configuration& configuration, const YAML::Node& node) {
            const std::optional<double> value = yaml_number(node);
            if (!value || !range.contains(*value)) return false;
            member(configuration) = *value;
            return true;
          },
          [=](const Configuration& configuration) { return text::exact(value_of(configuration, member)); },
          limits(range, slider)};
}

ParameterEntry integer(const std::string& name, int min, int max, const Member<int>& member) {
  const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  return {name, allowed,
          [=](Configuration& configuration, const YAML::Node& node) {
            const std::optional<int> value = yaml_integer(node);
            if (!value || *value < min || *value > max) return false;
            member(configuration) = *value;
            return true;
          },
          [=](const Configuration& configuration) { return std::to_string(value_of(configuration, member)); },
          ParameterLimits{double(min), double(max), double(min), double(max)}};
}

template <class T>
ParameterEntry choice(const std::string& name, const std::vector<std::pair<std::string, T>>& choices,
                      const Member<T>& member) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& option : choices) words.push_back(option.first);
  return {name,
          text::joined(words),
          [=](Configuration& configuration, const YAML::Node& node) {
            for (const auto& option : choices) {
              if (!node.IsScalar() || node.Scalar() != option.first) continue;
              member(configuration) = option.second;
              return true;
            }
            return false;
          },
          [=](const Configuration& configuration) {
            const T value = value_of(configuration, member);
            return std::find_if(choices.begin(), choices.end(),
                                [&](const auto& option) { return option.second == value; })
                ->first;
          },
          {}};
}

bool assign_gravity(Configuration& configuration, const YAML::Node& node) {
  const bool of_the_scene = node.IsScalar() && node.Scalar() == "scene";
  const std::optional<Vector3> value = yaml_vector(node);
  const bool in_limits = value && value->minCoeff() >= kGravity.min && value->maxCoeff() <= kGravity.max;
  if (!in_limits && !of_the_scene) return false;
  configuration.gravity = value;
  return true;
}

std::string gravity_text(const Configuration& configuration) {
  if (!configuration.gravity) return "scene";
  const Vector3& g = *configuration.gravity;
  return "[" + text::exact(g.x()) + ", " + text::exact(g.y()) + ", " + text::exact(g.z()) + "]";
}

/// What a parameter is that is not a number, and what that means.
struct Word {
  std::string word, meaning;
};

ParameterEntry number_or(const Word& otherwise, const std::string& name, const std::string& unit,
                         const Range& range, const Range& slider,
                         const Member<std::optional<double>>& member) {
  const std::string word = otherwise.word;
  return {name, range.describe() + unit + ", or '" + word + "' " + otherwise.meaning,
          [=](Configuration& configuration, const YAML::Node& node) {
            const bool is_word = node.IsScalar() && node.Scalar() == word;
            const std::optional<double> value = yaml_number(node);
            if (!is_word && (!value || !range.contains(*value))) return false;
            member(configuration) = is_word ? std::nullopt : value;
            return true;
          },
          [=](const Configuration& configuration) {
            const std::optional<double> value = value_of(configuration, member);
            return value ? text::exact(*value) : word;
          },
          limits(range, slider)};
}

/// Of a hand's strength: a number, or none.
ParameterEntry limit(const std::string& name, const std::string& unit, const Range& range,
                     const Range& slider, double HandStrength::*member) {
  return {"hand/" + name, range.describe() + unit + ", or 'unlimited'",
          [=](Configuration& configuration, const YAML::Node& node) {
            const bool unlimited = node.IsScalar() && node.Scalar() == "unlimited";
            const std::optional<double> value = yaml_number(node);
            if (!unlimited && (!value || !range.contains(*value))) return false;
            configuration.contact.hand.*member = unlimited ? HandStrength::kUnlimited : *value;
            return true;
          },
          [=](const Configuration& configuration) {
            const double value = configuration.contact.hand.*member;
            return value == HandStrength::kUnlimited ? "unlimited" : text::exact(value);
          },
          limits(range, slider)};
}

std::vector<ParameterEntry> hand_parameters() {
  using H = HandStrength;
  return {limit("strength", " [N]", {0.1, 1000}, {1, 100}, &H::finger),
          limit("palm_strength", " [N]", {0.1, 1000}, {1, 200}, &H::palm),
          limit("finger_mass", " [kg]", {0.001, 10}, {0.005, 0.5}, &H::finger_mass),
          limit("palm_mass", " [kg]", {0.001, 10}, {0.05, 2}, &H::palm_mass),
          number(
              "hand/pad", " [m]", {0, 0.01}, {0, 0.005},
              [](Configuration & c) -> auto& { return c.contact.hand.pad; }),
          number_or(
              {"material", "for that of the object's material"}, "hand/restitution", "", {0, 1}, {0, 1},
              [](Configuration & c) -> auto& { return c.contact.hand.restitution; }),
          number(
              "hand/radius_scale", "", {0.1, 10}, {0.5, 2},
              [](Configuration & c) -> auto& { return c.hand_radius_scale; })};
}

/// Refinements of contact, on or off.
std::vector<ParameterEntry> refinements() {
  using C = ContactConfiguration;
  const std::vector<std::pair<std::string, bool C::*>> members{{"anchors", &C::anchors},
                                                               {"damping", &C::damping},
                                                               {"edge_grip", &C::edge_grip},
                                                               {"entry_face", &C::entry_face},
                                                               {"grasp_assist", &C::grasp_assist},
                                                               {"impact_friction", &C::impact_friction},
                                                               {"release_fade", &C::release_fade},
                                                               {"sleep", &C::sleep},
                                                               {"sweep", &C::sweep},
                                                               {"swing_back", &C::swing_back},
                                                               {"torsion", &C::torsion},
                                                               {"two_points", &C::two_points}};
  std::vector<ParameterEntry> entries;
  for (const auto& refinement : members) {
    const auto member = refinement.second;
    entries.push_back(choice<bool>(
        "contact/" + refinement.first,
        {{"true", true}, {"false", false}}, [member](Configuration & c) -> auto& {
          return c.contact.*member;
        }));
  }
  return entries;
}

/// By what a filter's setting is of: a whole number, a number, or one that may be a word.
struct FilterParameter {
  const FilterSetting& setting;
  const std::string name = std::string("filter/") + setting.name;

  template <class T>
  static Member<T> member(T FilterConfiguration::*value) {
    return [value](Configuration & c) -> auto& {
      return c.filter.*value;
    };
  }
  ParameterEntry operator()(int FilterConfiguration::*value) const {
    return integer(name, static_cast<int>(setting.range.min), static_cast<int>(setting.range.max),
                   member(value));
  }
  ParameterEntry operator()(double FilterConfiguration::*value) const {
    return number(name, setting.unit, setting.range, setting.slider, member(value));
  }
  ParameterEntry operator()(std::optional<double> FilterConfiguration::*value) const {
    return number_or({setting.word, setting.meaning}, name, setting.unit, setting.range, setting.slider,
                     member(value));
  }
};

std::vector<ParameterEntry> filter_parameters() {
  std::vector<std::pair<std::string, FilterKind>> names;
  for (const HandFilter* filter : hand_filters()) names.push_back({filter->name, {filter->name}});
  std::vector<ParameterEntry> entries{choice<FilterKind>(
      "filter/type", names, [](Configuration & c) -> auto& { return c.filter.type; })};
  for (const FilterSetting& setting : filter_settings())
    entries.push_back(std::visit(FilterParameter{setting}, setting.value));
  return entries;
}

std::vector<std::pair<std::string, ContactModelKind>> contact_model_names() {
  std::vector<std::pair<std::string, ContactModelKind>> names;
  for (const ContactModelEntry* model : contact_models()) names.push_back({model->name, {model->name}});
  return names;
}

std::vector<ParameterEntry> make_table() {
  using C = Configuration;
  std::vector<ParameterEntry> table{
      choice<ContactModelKind>(
          "contact_model", contact_model_names(), [](C & c) -> auto& { return c.contact_model; }),
      choice<bool>(
          "seed/literal", {{"true", true}, {"false", false}},
          [](C & c) -> auto& { return c.contact.literal; }),
      number(
          "contact/object_stiffness", " [N/m]", {1, 1e9}, {1e4, 1e8},
          [](C & c) -> auto& { return c.contact.object_stiffness; }),
      number(
          "step", " [s]", {1e-5, 0.05}, {0.0002, 0.01}, [](C & c) -> auto& { return c.step; }),
      {"gravity", "three numbers [x, y, z] from -100 to 100 in m/s^2, or 'scene' for the scene's own",
       assign_gravity, gravity_text, limits(kGravity, kGravitySlider)},
      number(
          "scene/density", " [kg/m^3]", {0.1, 1e5}, {10, 10000}, [](C & c) -> auto& { return c.density; }),
      number(
          "tracking/hold_time", " [s]", {0, 10}, {0, 2}, [](C & c) -> auto& { return c.tracking.hold_time; }),
      number(
          "tracking/max_speed", " [m/s]", {0.1, 1000}, {1, 50},
          [](C & c) -> auto& { return c.tracking.max_speed; }),
  };
  for (ParameterEntry& entry : hand_parameters()) table.push_back(std::move(entry));
  for (ParameterEntry& entry : filter_parameters()) table.push_back(std::move(entry));
  for (ParameterEntry& entry : refinements()) table.push_back(std::move(entry));
  for (const MaterialField& field : material_fields()) {
    const auto member = field.value;
    if (member == &Material::stiffness) {
      table.push_back(number_or(
          {"model", "for the contact model's own"}, std::string("material/") + field.name, field.unit,
          field.range, field.slider, [](C & c) -> auto& { return c.stiffness; }));
      continue;
    }
    table.push_back(number(
        std::string("material/") + field.name, field.unit, field.range,
        field.slider, [member](C & c) -> auto& { return c.material.*member; }));
  }
  std::sort(table.begin(), table.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return table;
}

}  // namespace

const std::vector<ParameterEntry>& parameter_table() {
  static const std::vector<ParameterEntry> table = make_table();
  return table;
}

}  // namespace mrhi
