#include "yaml_values.h"

#include <cmath>

#include "text.h"

namespace mrhi {

bool Range::contains(double value) const {
  return (min_allowed ? value >= min : value > min) && value <= max;  // not for NaN either
}

std::string Range::describe() const {
  const std::string low = text::number(min), high = text::number(max);
  return min_allowed ? "a number from " + low + " to " + high : "a number above " + low + ", at most " + high;
}

std::optional<double> yaml_number(const YAML::Node& node) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) return {};
  return value;
}

std::optional<int> yaml_integer(const YAML::Node& node) {
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value)) return {};
  return value;
}

std::optional<Vector3> yaml_vector(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) return {};
  Vector3 vector;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> value = yaml_number(node[i]);
    if (!value) return {};
    vector[i] = *value;
  }
  return vector;
}

std::string yaml_text(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  return text::one_line(node.IsScalar() ? node.Scalar() : YAML::Dump(node), 60);
}

std::string yaml_place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

}  // namespace mrhi
