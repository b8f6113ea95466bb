#include "task_values.h"

#include <cmath>

#include "../scene/limits.h"
#include "../text/text.h"

namespace mrhi::task_yaml {

double number(const YamlElement& element, const Range& range, const char* unit) {
  const std::optional<double> value = yaml_number(element.node);
  if (!value || !range.contains(*value)) element.refuse(range.describe() + unit);
  return *value;
}

std::string string(const YamlElement& element) {
  if (!element.node.IsScalar() || element.node.Scalar().empty()) element.refuse("a text");
  return text::one_line(element.node.Scalar(), 500);
}

std::string choice(const YamlElement& element, const std::string& one, const std::string& other) {
  const std::string given = string(element);
  if (given != one && given != other) element.refuse(one + " or " + other);
  return given;
}

std::string name(const YamlElement& element) {
  const std::string given = string(element);
  if (!is_name(given)) element.refuse(std::string("a name of ") + kNameIs);
  return given;
}

Vector3 unit_vector(const YamlElement& element) {
  const Vector3 given = read_vector(element);
  if (given.norm() < 1e-6) element.refuse("a direction [x, y, z]");
  return given.normalized();
}

Quaternion quaternion(const YamlElement& element) {
  constexpr double kSlack = 0.01;
  const char* const allowed = "a unit quaternion [x, y, z, w]";
  if (!element.node.IsSequence() || element.node.size() != 4) element.refuse(allowed);
  Eigen::Vector4d given;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<double> value = yaml_number(element.node[i]);
    if (!value) element.refuse(allowed);
    given[static_cast<Eigen::Index>(i)] = *value;
  }
  if (std::abs(given.norm() - 1.0) > kSlack) element.refuse(allowed);
  return Quaternion(given.normalized());
}

Twist twist(const YamlElement& element) {
  const std::string allowed = "six numbers [vx, vy, vz, wx, wy, wz], at most " +
                              text::number(body_limits::kSpeed.max) + " m/s and " +
                              text::number(body_limits::kSpin.max) + " rad/s";
  if (!element.node.IsSequence() || element.node.size() != 6) element.refuse(allowed);
  double given[6];
  for (std::size_t i = 0; i < 6; ++i) {
    const std::optional<double> value = yaml_number(element.node[i]);
    if (!value) element.refuse(allowed);
    given[i] = *value;
  }
  const Twist twist{Vector3(given[0], given[1], given[2]), Vector3(given[3], given[4], given[5])};
  if (!body_limits::kSpeed.contains(twist.linear.norm()) ||
      !body_limits::kSpin.contains(twist.angular.norm()))
    element.refuse(allowed);
  return twist;
}

void check_has(const YamlElement& element, const std::vector<std::string>& needed) {
  for (const std::string& key : needed) {
    if (!element.node[key]) element.fail("no key '" + key + "'; needed: " + text::joined(needed));
  }
}

}  // namespace mrhi::task_yaml
