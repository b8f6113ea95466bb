#include "mr_hand_interaction/scene/body.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../text/text.h"
#include "limits.h"

namespace mrhi {
namespace {

using namespace body_limits;

constexpr double kThinnest = 1e-12;  // smallest principal moment, of the largest

[[noreturn]] void refuse(const Body& body, const std::string& what, const Range& allowed,
                         const std::string& unit) {
  throw std::invalid_argument("body '" + text::one_line(body.name, 60) + "': " + what +
                              " is not allowed; allowed: " + allowed.describe() + unit);
}

void check_mass(const Body& body) {
  if (!kMass.contains(body.mass)) refuse(body, "mass " + text::number(body.mass) + " kg", kMass, " kg");
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
  if (principal[0] > kThinnest * principal[2]) {
    if (!kInertia.contains(principal[0]) || !kInertia.contains(principal[2]))
      refuse(body, "inertia with the principal moments " + text::vector(principal) + " kg m^2", kInertia,
             " kg m^2");
    return;
  }
  throw std::invalid_argument(what + "with the principal moments " + text::vector(principal) +
                              " kg m^2 is not allowed; allowed: all three above 0, and the smallest more "
                              "than " +
                              text::number(kThinnest) + " of the largest");
}

bool is_diagonal(const Matrix3& matrix) {
  return Matrix3(matrix.diagonal().asDiagonal()) == matrix;
}

/// Which axis has the intermediate moment: it is the second of the addition theorem (free_rotation.h), for
/// which A and B are then not negative, and the functions real.
int intermediate(const Vector3& moments) {
  for (int i = 0; i < 2; ++i) {
    if ((moments[(i + 1) % 3] - moments[i]) * (moments[i] - moments[(i + 2) % 3]) >= 0.0) return i;
  }
  return 2;
}

/// Of a body that has its inertia along its own axes, these: to the bit.
void find_principal_axes(Body& body) {
  const Vector3 diagonal = body.inverse_inertia.diagonal();
  const int second = intermediate(diagonal);
  for (int i = 0; i < 3; ++i) {
    const int axis = (second + 2 + i) % 3;
    body.principal_axes.col(i) = Vector3::Unit(axis);
    body.inverse_moments[i] = diagonal[axis];
  }
  if (body.fixed || is_diagonal(body.inverse_inertia)) return;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(body.inverse_inertia);
  body.principal_axes = solver.eigenvectors();
  if (body.principal_axes.determinant() < 0.0) body.principal_axes.col(2) *= -1.0;
  body.inverse_moments = solver.eigenvalues();
}

}  // namespace

std::optional<GraspMode> grasp_mode(const std::string& name) {
  for (const GraspMode mode : {GraspMode::free, GraspMode::assist, GraspMode::never})
    if (name_of(mode) == name) return mode;
  return {};
}

std::string name_of(GraspMode mode) {
  switch (mode) {
    case GraspMode::free:
      return "free";
    case GraspMode::assist:
      return "assist";
    case GraspMode::never:
      return "never";
    case GraspMode::parameter:
      break;
  }
  return "";
}

void complete(Body& body) {
  body.flies = !body.fixed;
  body.inverse_inertia = Matrix3::Zero();
  if (!body.fixed) {
    check_mass(body);
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

}  // namespace mrhi
