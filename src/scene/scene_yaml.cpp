#include "urdf.h"

#include <cmath>

#include "../text/yaml.h"
#include "limits.h"

namespace mrhi {
namespace {

double read_number(const YamlElement& element) {
  const std::optional<double> value = yaml_number(element.node);
  if (!value) element.refuse("a number");
  return *value;
}

JointSpring read_spring(const YamlElement& element) {
  JointSpring spring;
  for (const std::string& key : checked_keys(element, {"stiffness", "rest"}))
    (key == "stiffness" ? spring.stiffness : spring.rest) = read_number(element.at(key));
  return spring;
}

Detents read_detents(const YamlElement& element) {
  Detents detents;
  for (const std::string& key : checked_keys(element, {"at", "force"})) {
    const YamlElement value = element.at(key);
    if (key == "force") {
      detents.force = read_number(value);
      continue;
    }
    if (!value.node.IsSequence()) value.refuse("a list of places");
    for (std::size_t i = 0; i < value.node.size(); ++i) detents.at.push_back(read_number(value.at(i)));
  }
  return detents;
}

Latch read_latch(const YamlElement& element) {
  Latch latch;
  latch.reach = 0.005;
  for (const std::string& key : checked_keys(element, {"at", "force", "reach"}))
    (key == "at" ? latch.at : key == "force" ? latch.force : latch.reach) = read_number(element.at(key));
  return latch;
}

void read_joint(const YamlElement& element, Joint& joint) {
  for (const std::string& key :
       checked_keys(element, {"start", "damping", "friction", "restitution", "spring", "detents", "latch"})) {
    const YamlElement value = element.at(key);
    if (key == "start") joint.start = read_number(value);
    if (key == "damping") joint.damping = read_number(value);
    if (key == "friction") joint.friction = read_number(value);
    if (key == "restitution") joint.restitution = read_number(value);
    if (key == "spring") joint.spring = read_spring(value);
    if (key == "detents") joint.detents = read_detents(value);
    if (key == "latch") joint.latch = read_latch(value);
  }
}

/// Sets the properties of joints that a URDF has no element for. arrange_joints() checks their limits.
void read_joint_settings(const YamlElement& element, Scene& scene) {
  for (const std::string& name : checked_keys(element, text::names_of(scene.joints)))
    read_joint(element.at(name), scene.joints[*find_joint(scene, name)]);
}

/// [kg]. The operator is coupled explicitly to other bodies, which a very light one would make unstable
/// (docs/training.md).
constexpr Range kOperatorMass{10, 1000};
constexpr Range kRestraintReach{0, 3};  // [m]
constexpr Range kStart{-900, 900};      // of the frame, on each axis; leaves room for the centre of mass [m]
constexpr Range kTetherLength{0.001, 100};

/// Radii of gyration of an upright person about x (right), y (forward) and z (up) [m].
const Vector3 kGyration{0.38, 0.39, 0.14};
/// Centre of mass in the tracker's frame, whose origin is in front of the person [m].
const Vector3 kCentre{0.0, -0.4, 0.0};

/// Reads six numbers, each group of three in its range; or only the first three, if `three_will_do`.
Twist read_six(const YamlElement& element, const Range& first, const Range& last, bool three_will_do) {
  auto numbers = yaml_numbers(element.node, 6);
  if (!numbers && three_will_do) numbers = yaml_numbers(element.node, 3);
  for (std::size_t i = 0; numbers && i < numbers->size(); ++i)
    if (!(i < 3 ? first : last).contains((*numbers)[i])) numbers.reset();
  if (!numbers)
    element.refuse(std::string(three_will_do ? "three or six" : "six") + " numbers, the first three from " +
                   text::number(first.min) + " to " + text::number(first.max) + ", the others from " +
                   text::number(last.min) + " to " + text::number(last.max));
  numbers->resize(6, 0.0);
  return {Vector3(numbers->data()), Vector3(numbers->data() + 3)};
}

int read_body(const YamlElement& element, bool fixed, const Scene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) {
    const bool on_joint = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& joint) {
      return &scene.bodies[joint.child] == &body ||
             (joint.parent != Joint::kWorld && &scene.bodies[joint.parent] == &body);
    });
    if (body.fixed == fixed && (fixed || !on_joint)) names.push_back(body.name);
  }
  const std::string name = yaml_text(element.node);
  if (std::find(names.begin(), names.end(), name) == names.end())
    element.refuse((fixed ? "a fixture: " : "a free body without joints: ") +
                   (names.empty() ? "the scene has none" : text::joined(names)));
  return *find_body(scene, name);
}

void read_operator(const std::string& name, const YamlElement& element, Scene& scene) {
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
    const YamlElement value = element.at(key);
    if (key == "mass") body.mass = read_number(value, kOperatorMass, " kg");
    if (key == "inertia") inertia = read_vector(value, {0.01, 1000});
    if (key == "centre") centre = read_vector(value, {-3, 3});
    if (key == "twist") body.start_twist = read_six(value, {-10, 10}, {-10, 10}, false);
    if (key == "restraint") op.restraint = read_body(value, true, scene);
    if (key == "reach") op.reach = read_number(value, kRestraintReach, " m");
    if (key != "start") continue;
    const Twist numbers = read_six(value, kStart, {-2 * M_PI, 2 * M_PI}, true);
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

void read_tether(const YamlElement& element, Scene& scene) {
  Tether tether;
  Vector3 at = Vector3::Zero(), anchor = Vector3::Zero();
  const std::vector<std::string> keys = checked_keys(element, {"body", "at", "fixture", "anchor", "length"});
  for (const char* needed : {"body", "fixture", "length"}) {
    if (std::find(keys.begin(), keys.end(), needed) == keys.end())
      element.fail(std::string("has no '") + needed + "'; allowed: body, fixture and length always");
  }
  for (const std::string& key : keys) {
    const YamlElement value = element.at(key);
    if (key == "body") tether.body = read_body(value, false, scene);
    if (key == "fixture") tether.fixture = read_body(value, true, scene);
    if (key == "at") at = read_vector(value, {-10, 10});
    if (key == "anchor") anchor = read_vector(value, {-100, 100});
    if (key == "length") tether.length = read_number(value, kTetherLength, " m");
  }
  tether.at = scene.bodies[tether.body].link_in_body * at;
  tether.anchor = scene.bodies[tether.fixture].link_in_body * anchor;
  scene.tethers.push_back(tether);
}

/// Adds the bodies of operators to a scene whose other bodies are known.
void read_operators(const YamlElement& element, Scene& scene) {
  if (!element.node.IsMap()) element.refuse("a map of operators by their names");
  if (element.node.size() + scene.operators.size() > body_limits::kMaxOperators)
    element.fail("has " + std::to_string(element.node.size()) + " operators; allowed: at most " +
                 std::to_string(body_limits::kMaxOperators));
  for (const auto& entry : element.node) {
    const std::string name = yaml_text(entry.first);
    if (!is_name(name)) element.fail("name '" + name + "' is not allowed; allowed: " + kNameIs);
    read_operator(name, element.at(name), scene);
  }
}

void read_tethers(const YamlElement& element, Scene& scene) {
  if (!element.node.IsSequence()) element.refuse("a list of tethers");
  for (std::size_t i = 0; i < element.node.size(); ++i) read_tether(element.at(i), scene);
}

void read_bounds(const YamlElement& element, Bounds& bounds) {
  for (const std::string& key : checked_keys(element, {"min", "max"})) {
    (key == "min" ? bounds.min : bounds.max) = read_vector(element.at(key));
  }
  if ((bounds.min.array() < bounds.max.array()).all()) return;
  element.fail("min " + text::vector(bounds.min) + " is not below max " + text::vector(bounds.max) +
               "; allowed: min below max on each axis");
}

void read_material(const YamlElement& element, Body& body) {
  const std::vector<std::string> keys = checked_keys(element, text::names_of(material_fields()));
  for (const MaterialField& field : material_fields()) {
    if (std::find(keys.begin(), keys.end(), field.name) == keys.end()) continue;
    const YamlElement value = element.at(field.name);
    body.material.*field.value = read_number(value, field.range, field.unit);
    body.own_material.*field.own = true;
  }
  if (const auto conflict = material_conflict(body.material)) element.fail(*conflict);
}

void read_materials(const YamlElement& element, Scene& scene) {
  for (const std::string& link : checked_keys(element, text::names_of(scene.bodies)))
    read_material(element.at(link), scene.bodies[*find_body(scene, link)]);
}

void read_grasps(const YamlElement& element, Scene& scene) {
  for (const std::string& link : checked_keys(element, graspable_bodies(scene))) {
    const YamlElement value = element.at(link);
    const auto mode = value.node.IsScalar() ? grasp_mode(value.node.Scalar()) : std::nullopt;
    if (!mode) value.refuse(kGraspModes);
    scene.bodies[*find_body(scene, link)].grasp = *mode;
  }
}

/// Reads start velocities of bodies, [vx, vy, vz, wx, wy, wz] as in the service. A body on a joint keeps the
/// component that the joint allows.
void read_twists(const YamlElement& element, Scene& scene) {
  std::vector<std::string> links;
  for (const Body& body : scene.bodies) {
    if (!body.fixed) links.push_back(body.name);
  }
  for (const std::string& link : checked_keys(element, links)) {
    scene.bodies[*find_body(scene, link)].start_twist = read_twist(element.at(link));
  }
}

}  // namespace

Twist read_twist(const YamlElement& element) {
  const auto value = yaml_numbers(element.node, 6);
  const Twist twist = value ? Twist{Vector3(value->data()), Vector3(value->data() + 3)} : Twist{};
  if (!value || !body_limits::kSpeed.contains(twist.linear.norm()) ||
      !body_limits::kSpin.contains(twist.angular.norm()))
    element.refuse("six numbers [vx, vy, vz, wx, wy, wz], at most " + text::number(body_limits::kSpeed.max) +
                   " m/s and " + text::number(body_limits::kSpin.max) + " rad/s");
  return twist;
}

void apply_scene_yaml(const std::string& yaml_file, Scene& scene) {
  read_yaml<SceneError>(yaml_file, [&] {
    const YamlElement root{yaml_file, "", load_yaml_file(yaml_file)};
    if (root.node.IsNull()) return;
    const std::vector<std::string> keys = checked_keys(
        root,
        {"gravity", "bounds", "materials", "grasp", "twists", "joints", "operator", "operators", "tethers"});
    const auto has = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
    for (const std::string& key : keys) {
      const YamlElement element = root.at(key);
      if (element.node.IsNull()) continue;  // all its lines are commented out
      if (key == "gravity") scene.gravity = read_vector(element, body_limits::kGravity);
      if (key == "bounds") read_bounds(element, scene.bounds);
      if (key == "materials") read_materials(element, scene);
      if (key == "grasp") read_grasps(element, scene);
      if (key == "twists") read_twists(element, scene);
      if (key == "joints") read_joint_settings(element, scene);
    }
    if (has("operator") && has("operators"))
      root.fail("has both 'operator' and 'operators'; allowed: one of them");
    if (has("operator")) read_operator("operator", root.at("operator"), scene);
    if (has("operators")) read_operators(root.at("operators"), scene);
    if (has("tethers")) read_tethers(root.at("tethers"), scene);
    if (!scene.operators.empty() && !scene.gravity.isZero(0.0))
      scene.warnings.push_back("the operator falls with gravity " + text::vector(scene.gravity) +
                               " m/s^2 as objects do; set gravity to 0 or use a restraint");
  });
}

void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene) {
  read_yaml<SceneError>(source, [&] {
    const YamlElement joints{source, "", load_yaml(source, yaml)};
    const bool is_empty = joints.node.IsNull() || (joints.node.IsMap() && joints.node.size() == 0);
    if (scene.joints.empty() && !is_empty) joints.refuse("nothing: this URDF has no joints");
    read_joint_settings(joints, scene);
  });
}

void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body) {
  read_yaml<SceneError>(source, [&] { read_material({source, "", load_yaml(source, yaml)}, body); });
}

}  // namespace mrhi
