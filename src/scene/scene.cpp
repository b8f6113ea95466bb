#include "mr_hand_interaction/scene/scene.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>

#include "../text/text.h"
#include "limits.h"

namespace mrhi {

const std::array<MaterialField, 4>& material_fields() {
  static const std::array<MaterialField, 4> fields{{
      {"restitution", "", &Material::restitution, &OwnMaterial::restitution, {0, 1}, {0, 1}},
      {"static_friction", "", &Material::static_friction, &OwnMaterial::static_friction, {0, 10}, {0, 2}},
      {"dynamic_friction", "", &Material::dynamic_friction, &OwnMaterial::dynamic_friction, {0, 10}, {0, 2}},
      {"stiffness", " [N/m]", &Material::stiffness, &OwnMaterial::stiffness, {1, 1e7}, {10, 10000}},
  }};
  return fields;
}

std::optional<std::string> material_conflict(const Material& material) {
  if (material.dynamic_friction <= material.static_friction) return {};
  return "dynamic_friction " + text::number(material.dynamic_friction) + " is above static_friction " +
         text::number(material.static_friction) +
         "; allowed: at most static_friction, both set at once if need be";
}

namespace {

using namespace body_limits;

constexpr double kMinMomentRatio = 1e-12;  // smallest principal moment over the largest

[[noreturn]] void refuse(const Body& body, const std::string& what, const Range& allowed,
                         const std::string& unit) {
  throw std::invalid_argument("body " + text::quoted(body.name) + ": " + what +
                              " is not allowed; allowed: " + allowed.describe() + unit);
}

void check_start(const Body& body) {
  const Vector3& place = body.start.position;
  if (!kPlace.contains(place.minCoeff()) || !kPlace.contains(place.maxCoeff()) || !place.allFinite())
    refuse(body, "place " + text::vector(place) + " m", kPlace, " m");
  const Twist& twist = body.start_twist;
  if (!kSpeed.contains(twist.linear.norm()))
    refuse(body, "velocity " + text::vector(twist.linear) + " m/s", kSpeed, " m/s");
  if (!kSpin.contains(twist.angular.norm()))
    refuse(body, "spin " + text::vector(twist.angular) + " rad/s", kSpin, " rad/s");
}

void check_inertia(const Body& body) {
  const Matrix3& inertia = body.inertia;
  const std::string what = "body '" + body.name + "': inertia ";
  if (!inertia.allFinite()) throw std::invalid_argument(what + "is not finite; allowed: finite numbers");
  if ((inertia - inertia.transpose()).norm() > 1e-9 * inertia.norm()) {
    throw std::invalid_argument(what + "is not symmetric; allowed: a symmetric matrix");
  }
  const Vector3 principal = Eigen::SelfAdjointEigenSolver<Matrix3>(inertia).eigenvalues();
  if (principal[0] > kMinMomentRatio * principal[2]) {
    if (!kInertia.contains(principal[0]) || !kInertia.contains(principal[2]))
      refuse(body, "inertia with the principal moments " + text::vector(principal) + " kg m^2", kInertia,
             " kg m^2");
    return;
  }
  throw std::invalid_argument(what + "with the principal moments " + text::vector(principal) +
                              " kg m^2 is not allowed; allowed: all three above 0, and the smallest more "
                              "than " +
                              text::number(kMinMomentRatio) + " of the largest");
}

/// Axis of the intermediate moment. It is the second axis of MomentumPath (integration/free_flight.cpp):
/// then A and B of the addition theorem are not negative, and its functions are real.
int intermediate(const Vector3& moments) {
  for (int i = 0; i < 2; ++i) {
    if ((moments[(i + 1) % 3] - moments[i]) * (moments[i] - moments[(i + 2) % 3]) >= 0.0) return i;
  }
  return 2;
}

/// Sets the principal axes. They are exactly the body's axes if its inertia is diagonal.
void find_principal_axes(Body& body) {
  const Vector3 diagonal = body.inverse_inertia.diagonal();
  const int second = intermediate(diagonal);
  for (int i = 0; i < 3; ++i) {
    const int axis = (second + 2 + i) % 3;
    body.principal_axes.col(i) = Vector3::Unit(axis);
    body.inverse_moments[i] = diagonal[axis];
  }
  if (body.fixed || Matrix3(diagonal.asDiagonal()) == body.inverse_inertia) return;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(body.inverse_inertia);
  body.principal_axes = solver.eigenvectors();
  if (body.principal_axes.determinant() < 0.0) body.principal_axes.col(2) *= -1.0;
  body.inverse_moments = solver.eigenvalues();
}

template <typename Named>
std::optional<int> index_of(const std::string& name, const std::vector<Named>& all) {
  const Named* const found = text::find_named(all, name);
  return found == nullptr ? std::nullopt : std::make_optional(static_cast<int>(found - all.data()));
}

/// Keeps the items for which `stays` returns true; it also updates their indices.
template <typename Item, typename Stays>
void keep(std::vector<Item>& items, const Stays& stays) {
  std::vector<Item> kept;
  for (Item& item : items)
    if (stays(item)) kept.push_back(std::move(item));
  items = std::move(kept);
}

}  // namespace

std::optional<GraspMode> grasp_mode(const std::string& name) {
  for (const GraspMode mode : {GraspMode::free, GraspMode::assist, GraspMode::never})
    if (name_of(mode) == name) return mode;
  return {};
}

std::string name_of(GraspMode mode) {
  static const char* const names[] = {"", "free", "assist", "never"};
  return names[static_cast<std::size_t>(mode)];
}

void complete(Body& body) {
  body.flies = !body.fixed;
  body.inverse_inertia = Matrix3::Zero();
  if (!body.fixed) {
    if (!kMass.contains(body.mass)) refuse(body, "mass " + text::number(body.mass) + " kg", kMass, " kg");
    check_inertia(body);
    const Matrix3 inverse = body.inertia.inverse();
    body.inverse_inertia = 0.5 * (inverse + inverse.transpose());
  }
  find_principal_axes(body);
  check_start(body);
  const Range allowed{0, kPlace.max};
  body.bounding_radius = 0;
  for (const PlacedShape& placed : body.shapes) {
    const double reach = placed.pose.position.norm() + bounding_radius(placed.shape);
    if (!allowed.contains(reach))
      refuse(body, "a shape that reaches " + text::number(reach) + " m", allowed, " m");
    body.bounding_radius = std::max(body.bounding_radius, reach);
  }
}

std::optional<int> find_body(const Scene& scene, const std::string& name) {
  return index_of(name, scene.bodies);
}

std::optional<int> find_joint(const Scene& scene, const std::string& name) {
  return index_of(name, scene.joints);
}

std::vector<std::string> graspable_bodies(const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto body = static_cast<int>(b);
    if (!scene.bodies[b].fixed && floating_root(scene, body).value_or(body) == body)
      names.push_back(scene.bodies[b].name);
  }
  return names;
}

GraspMode grasp_of(const Scene& scene, int body) {
  return scene.bodies[floating_root(scene, body).value_or(body)].grasp;
}

Body& free_body(Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (Body& body : scene.bodies) {
    if (body.fixed) continue;
    if (body.name == name) return body;
    names.push_back(body.name);
  }
  throw std::invalid_argument("scene '" + scene.name + "' has no free object '" + name +
                              "'; allowed: " + text::joined_or_none(names));
}

void append(const Scene& part, Scene& scene) {
  for (const Body& body : part.bodies) {
    if (find_body(scene, body.name))
      throw std::invalid_argument("object '" + body.name + "' is there already; allowed: a name other than " +
                                  text::joined(text::names_of(scene.bodies)));
  }
  for (const Joint& joint : part.joints) {
    if (find_joint(scene, joint.name))
      throw std::invalid_argument("joint '" + joint.name +
                                  "' is there already; allowed: a name that is not taken");
  }
  const auto first = static_cast<int>(scene.bodies.size());
  scene.bodies.insert(scene.bodies.end(), part.bodies.begin(), part.bodies.end());
  for (Joint joint : part.joints) {
    joint.child += first;
    if (joint.parent != Joint::kWorld) joint.parent += first;
    scene.joints.push_back(joint);
  }
  for (Operator op : part.operators) {
    op.body += first;
    if (op.restraint) *op.restraint += first;
    scene.operators.push_back(op);
  }
  for (Tether tether : part.tethers) {
    tether.body += first;
    tether.fixture += first;
    scene.tethers.push_back(tether);
  }
}

std::vector<std::size_t> hanging_on(std::size_t body, const Scene& scene) {
  std::vector<std::size_t> bodies{body};
  for (const Joint& joint : scene.joints)  // a body's joint precedes those of its children
    if (std::find(bodies.begin(), bodies.end(), joint.parent) != bodies.end()) bodies.push_back(joint.child);
  std::sort(bodies.begin(), bodies.end());
  return bodies;
}

void remove_body(std::size_t body, Scene& scene) {
  std::vector<int> place(scene.bodies.size(), 0);  // new index of each body; -1: removed
  for (const std::size_t removed : hanging_on(body, scene)) place[removed] = -1;
  int staying = 0;
  for (int& index : place)
    if (index == 0) index = staying++;
  std::size_t b = 0;
  keep(scene.bodies, [&](const Body&) { return place[b++] >= 0; });
  const auto stays = [&](int& index) { return (index = place[index]) >= 0; };
  keep(scene.joints, [&](Joint& joint) {
    if (joint.parent != Joint::kWorld) stays(joint.parent);
    return stays(joint.child);
  });
  keep(scene.operators, [&](Operator& op) {
    if (op.restraint && !stays(*op.restraint)) op.restraint.reset();
    return stays(op.body);
  });
  keep(scene.tethers, [&](Tether& tether) { return stays(tether.body) && stays(tether.fixture); });
}

}  // namespace mrhi
