#include <algorithm>
#include <cmath>

#include "../text/text.h"
#include "limits.h"
#include "mr_hand_interaction/tracking/hand_track.h"
#include "scene_yaml.h"

namespace mrhi {
namespace {

using Element = YamlElement;

/// Explicit coupling of an operator to what is heavier needs a body of some mass (docs/training.md)
/// [kg].
constexpr Range kOperatorMass{10, 1000};
constexpr Range kRestraintReach{0, 3};  // [m]
constexpr Range kStart{-900, 900};      // of the frame, on each axis: its centre of mass is near [m]
constexpr Range kTetherLength{0.001, 100};

/// Radii of gyration of a person who stands upright, about x (to the right), y (ahead) and z (up) [m].
const Vector3 kGyration{0.38, 0.39, 0.14};
/// Of the centre of mass from the origin of the tracker's frame, which lies before the person [m].
const Vector3 kCentre{0.0, -0.4, 0.0};

double read_number(const Element& element, const Range& range, const char* unit) {
  const std::optional<double> value = yaml_number(element.node);
  if (!value || !range.contains(*value)) element.refuse(range.describe() + unit);
  return *value;
}

/// Six numbers, each group of three in its range, or the first three of them.
Twist read_six(const Element& element, const Range& first, const Range& last, bool three_will_do) {
  const std::string allowed = std::string(three_will_do ? "three or six" : "six") +
                              " numbers, the first three from " + text::number(first.min) + " to " +
                              text::number(first.max) + ", the others from " + text::number(last.min) +
                              " to " + text::number(last.max);
  const std::size_t size = element.node.IsSequence() ? element.node.size() : 0;
  if (size != 6 && !(three_will_do && size == 3)) element.refuse(allowed);
  Vector3 parts[2] = {Vector3::Zero(), Vector3::Zero()};
  for (std::size_t i = 0; i < size; ++i) {
    const std::optional<double> number = yaml_number(element.node[i]);
    if (!number || !(i < 3 ? first : last).contains(*number)) element.refuse(allowed);
    parts[i / 3][static_cast<Eigen::Index>(i % 3)] = *number;
  }
  return {parts[0], parts[1]};
}

int read_body(const Element& element, bool fixed, const Scene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) {
    const bool on_joint = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& joint) {
      return &scene.bodies[static_cast<std::size_t>(joint.child)] == &body ||
             (joint.parent != Joint::kWorld &&
              &scene.bodies[static_cast<std::size_t>(joint.parent)] == &body);
    });
    if (body.fixed == fixed && (fixed || !on_joint)) names.push_back(body.name);
  }
  const std::string name = yaml_text(element.node);
  if (std::find(names.begin(), names.end(), name) == names.end())
    element.refuse((fixed ? "a fixture: " : "a free body without joints: ") +
                   (names.empty() ? "the scene has none" : text::joined(names)));
  return *find_body(scene, name);
}

void read_operator(const std::string& name, const Element& element, Scene& scene) {
  if (find_body(scene, name)) element.fail("a link has the name '" + name + "'; allowed: a name of its own");
  Operator op;
  Body body;
  body.name = name;
  body.is_operator = true;
  body.mass = 80.0;
  Vector3 centre = kCentre;
  std::optional<Vector3> inertia;
  Pose start;
  const std::vector<std::string> keys =
      element.node.IsNull()
          ? std::vector<std::string>{}
          : checked_keys(element, {"mass", "inertia", "centre", "start", "twist", "restraint", "reach"});
  for (const std::string& key : keys) {
    const Element given = element.at(key);
    if (key == "mass") body.mass = read_number(given, kOperatorMass, " kg");
    if (key == "inertia") inertia = read_vector(given, {0.01, 1000});
    if (key == "centre") centre = read_vector(given, {-3, 3});
    if (key == "twist") body.start_twist = read_six(given, {-10, 10}, {-10, 10}, false);
    if (key == "restraint") op.restraint = read_body(given, true, scene);
    if (key == "reach") op.reach = read_number(given, kRestraintReach, " m");
    if (key != "start") continue;
    const Twist numbers = read_six(given, kStart, {-2 * M_PI, 2 * M_PI}, true);
    start = {numbers.linear, Quaternion(Eigen::AngleAxisd(numbers.angular.z(), Vector3::UnitZ()) *
                                        Eigen::AngleAxisd(numbers.angular.y(), Vector3::UnitY()) *
                                        Eigen::AngleAxisd(numbers.angular.x(), Vector3::UnitX()))};
  }
  const Vector3 moments = inertia.value_or(body.mass * kGyration.cwiseAbs2());
  if (2.0 * moments.maxCoeff() > moments.sum())
    element.fail("inertia " + text::vector(moments) +
                 " kg m^2 is none that a body can have; allowed: none above the sum of the two others");
  body.inertia = moments.asDiagonal();
  body.link_in_body.position = -centre;
  body.start = {start * centre, start.orientation};
  complete(body);
  op.body = static_cast<int>(scene.bodies.size());
  scene.bodies.push_back(body);
  scene.operators.push_back(op);
}

void read_tether(const Element& element, Scene& scene) {
  Tether tether;
  Vector3 at = Vector3::Zero(), anchor = Vector3::Zero();
  const std::vector<std::string> keys = checked_keys(element, {"body", "at", "fixture", "anchor", "length"});
  for (const char* needed : {"body", "fixture", "length"}) {
    if (std::find(keys.begin(), keys.end(), needed) == keys.end())
      element.fail(std::string("has no '") + needed + "'; allowed: body, fixture and length always");
  }
  for (const std::string& key : keys) {
    const Element given = element.at(key);
    if (key == "body") tether.body = read_body(given, false, scene);
    if (key == "fixture") tether.fixture = read_body(given, true, scene);
    if (key == "at") at = read_vector(given, {-10, 10});
    if (key == "anchor") anchor = read_vector(given, {-100, 100});
    if (key == "length") tether.length = read_number(given, kTetherLength, " m");
  }
  tether.at = scene.bodies[static_cast<std::size_t>(tether.body)].link_in_body * at;
  tether.anchor = scene.bodies[static_cast<std::size_t>(tether.fixture)].link_in_body * anchor;
  scene.tethers.push_back(tether);
}

}  // namespace

void read_operators(const YamlElement& element, Scene& scene) {
  if (!element.node.IsMap()) element.refuse("a map of operators by their names");
  if (element.node.size() + scene.operators.size() > kMaxHands)
    element.fail("has " + std::to_string(element.node.size()) + " operators; allowed: at most " +
                 std::to_string(kMaxHands));
  for (const auto& entry : element.node) {
    const std::string name = yaml_text(entry.first);
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
             c == '-';
    });
    if (!plain) element.fail("name '" + name + "' is not allowed; allowed: letters, digits, _ and -");
    read_operator(name, element.at(name), scene);
  }
}

void read_operator(const YamlElement& element, Scene& scene) {
  read_operator("operator", element, scene);
}

void read_tethers(const YamlElement& element, Scene& scene) {
  if (!element.node.IsSequence()) element.refuse("a list of tethers");
  for (std::size_t i = 0; i < element.node.size(); ++i) read_tether(element.at(i), scene);
}

}  // namespace mrhi
