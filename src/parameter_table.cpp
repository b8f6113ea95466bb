#include "parameter_table.h"

#include <algorithm>
#include <utility>

#include "mr_hand_interaction/tracking/filter_memory.h"
#include "scene/material_fields.h"
#include "scene/text.h"
#include "scene/yaml_values.h"

namespace mrhi {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

template <class T>
using Member = std::function<T&(Configuration&)>;

template <class T>
T value_of(Configuration configuration, const Member<T>& member) {
  return member(configuration);
}

ParameterEntry number(const std::string& name, const std::string& unit, Range range,
                      const Member<double>& member) {
  return {name, range.describe() + unit,
          [=](Configuration& configuration, const YAML::Node& node) {
            const std::optional<double> value = yaml_number(node);
            if (!value || !range.contains(*value)) return false;
            member(configuration) = *value;
            return true;
          },
          [=](const Configuration& configuration) { return text::exact(value_of(configuration, member)); }};
}

ParameterEntry integer(const std::string& name, int min, int max, const Member<int>& member) {
  const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  return {
      name, allowed,
      [=](Configuration& configuration, const YAML::Node& node) {
        const std::optional<int> value = yaml_integer(node);
        if (!value || *value < min || *value > max) return false;
        member(configuration) = *value;
        return true;
      },
      [=](const Configuration& configuration) { return std::to_string(value_of(configuration, member)); }};
}

template <class T>
ParameterEntry choice(const std::string& name, const std::vector<std::pair<std::string, T>>& choices,
                      const Member<T>& member) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& option : choices) words.push_back(option.first);
  return {name, text::joined(words),
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
          }};
}

bool assign_gravity(Configuration& configuration, const YAML::Node& node) {
  const bool of_the_scene = node.IsScalar() && node.Scalar() == "scene";
  const std::optional<Vector3> value = yaml_vector(node);
  if (!value && !of_the_scene) return false;
  configuration.gravity = value;
  return true;
}

std::string gravity_text(const Configuration& configuration) {
  if (!configuration.gravity) return "scene";
  const Vector3& g = *configuration.gravity;
  return "[" + text::exact(g.x()) + ", " + text::exact(g.y()) + ", " + text::exact(g.z()) + "]";
}

ParameterEntry stiffness(const MaterialField& field) {
  const Range range = field.range;
  return {std::string("material/") + field.name,
          range.describe() + field.unit + ", or 'model' for the contact model's own",
          [range](Configuration& configuration, const YAML::Node& node) {
            const bool of_the_model = node.IsScalar() && node.Scalar() == "model";
            const std::optional<double> value = yaml_number(node);
            if (!of_the_model && (!value || !range.contains(*value))) return false;
            configuration.stiffness = of_the_model ? std::nullopt : value;
            return true;
          },
          [](const Configuration& configuration) {
            return configuration.stiffness ? text::exact(*configuration.stiffness) : "model";
          }};
}

/// Refinements of contact, on or off.
std::vector<ParameterEntry> refinements() {
  using C = ContactConfiguration;
  const std::vector<std::pair<std::string, bool C::*>> members{{"anchors", &C::anchors},
                                                               {"damping", &C::damping},
                                                               {"edge_grip", &C::edge_grip},
                                                               {"entry_face", &C::entry_face},
                                                               {"impact_friction", &C::impact_friction},
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

std::vector<ParameterEntry> filter_parameters() {
  using C = Configuration;
  return {choice<FilterKind>(
              "filter/type",
              {{"none", FilterKind::none},
               {"window", FilterKind::window},
               {"one_euro", FilterKind::one_euro},
               {"constant_velocity", FilterKind::constant_velocity}},
              [](C & c) -> auto& { return c.filter.type; }),
          integer(
              "filter/window", 1, kMaxFilterWindow, [](C & c) -> auto& { return c.filter.window; }),
          number(
              "filter/min_cutoff", " [Hz]", {0, kNoLimit, false},
              [](C & c) -> auto& { return c.filter.min_cutoff; }),
          number(
              "filter/beta", " [Hz per m/s]", {0}, [](C & c) -> auto& { return c.filter.beta; }),
          number(
              "filter/derivative_cutoff", " [Hz]", {0, kNoLimit, false},
              [](C & c) -> auto& { return c.filter.derivative_cutoff; }),
          number(
              "filter/noise", " [m]", {0, kNoLimit, false}, [](C & c) -> auto& { return c.filter.noise; }),
          number(
              "filter/acceleration", " [m/s^2]", {0, kNoLimit, false},
              [](C & c) -> auto& { return c.filter.acceleration; }),
          number(
              "filter/agility", " [1/s]", {0}, [](C & c) -> auto& { return c.filter.agility; })};
}

std::vector<ParameterEntry> make_table() {
  using C = Configuration;
  std::vector<ParameterEntry> table{
      choice<ContactModelKind>(
          "contact_model",
          {{"implicit", ContactModelKind::implicit},
           {"seed", ContactModelKind::seed},
           {"penetration", ContactModelKind::penetration},
           {"impulse", ContactModelKind::impulse},
           {"virtual_spring", ContactModelKind::virtual_spring},
           {"soft_pad", ContactModelKind::soft_pad}},
          [](C & c) -> auto& { return c.contact_model; }),
      number(
          "contact/object_stiffness", " [N/m]", {0, kNoLimit, false},
          [](C & c) -> auto& { return c.contact.object_stiffness; }),
      number(
          "step", " [s]", {0, 0.05, false}, [](C & c) -> auto& { return c.step; }),
      {"gravity", "three finite numbers [x, y, z] in m/s^2, or 'scene' for the scene's own", assign_gravity,
       gravity_text},
      number(
          "hand/radius_scale", "", {0.1, 10}, [](C & c) -> auto& { return c.hand_radius_scale; }),
      number(
          "tracking/hold_time", " [s]", {0, 10}, [](C & c) -> auto& { return c.tracking.hold_time; }),
      number(
          "tracking/max_speed", " [m/s]", {0, kNoLimit, false},
          [](C & c) -> auto& { return c.tracking.max_speed; }),
  };
  for (ParameterEntry& entry : filter_parameters()) table.push_back(std::move(entry));
  for (ParameterEntry& entry : refinements()) table.push_back(std::move(entry));
  for (const MaterialField& field : material_fields()) {
    const auto member = field.value;
    if (member == &Material::stiffness) {
      table.push_back(stiffness(field));
      continue;
    }
    table.push_back(number(
        std::string("material/") + field.name, field.unit,
        field.range, [member](C & c) -> auto& { return c.material.*member; }));
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
