#include "mr_hand_interaction/scene/body.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "text.h"

namespace mrhi {
namespace {

void check_mass(const Body& body) {
  if (std::isfinite(body.mass) && body.mass > 0) return;
  throw std::invalid_argument("body '" + body.name + "': mass " + text::number(body.mass) +
                              " kg is not allowed; allowed: above 0");
}

void check_inertia(const Body& body) {
  const Matrix3& inertia = body.inertia;
  const std::string what = "body '" + body.name + "': inertia ";
  if (!inertia.allFinite()) throw std::invalid_argument(what + "is not finite; allowed: finite numbers");
  if ((inertia - inertia.transpose()).norm() > 1e-9 * inertia.norm()) {
    throw std::invalid_argument(what + "is not symmetric; allowed: a symmetric matrix");
  }
  const Vector3 principal = Eigen::SelfAdjointEigenSolver<Matrix3>(inertia).eigenvalues();
  if (principal[0] > 1e-12 * principal[2]) return;
  throw std::invalid_argument(what + "with the principal moments " + text::vector(principal) +
                              " kg m^2 is not positive definite; allowed: all three above 0");
}

}  // namespace

void complete(Body& body) {
  body.inverse_inertia = Matrix3::Zero();
  if (!body.fixed) {
    check_mass(body);
    check_inertia(body);
    const Matrix3 inverse = body.inertia.inverse();
    body.inverse_inertia = 0.5 * (inverse + inverse.transpose());
  }
  body.bounding_radius = 0;
  for (const PlacedShape& placed : body.shapes) {
    const double reach = placed.pose.position.norm() + bounding_radius(placed.shape);
    body.bounding_radius = std::max(body.bounding_radius, reach);
  }
}

}  // namespace mrhi
