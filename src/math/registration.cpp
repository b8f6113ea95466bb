#include "registration.h"

#include <Eigen/SVD>

namespace mrhi {

std::optional<Registration> registered(const Vector3* from, const Vector3* to, std::size_t size) {
  constexpr double kMinSpread = 1e-6;  // along the second principal direction [m^2]
  if (size < 3) return std::nullopt;
  const auto mean = [size](const Vector3* points) -> Vector3 {
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < size; ++i) sum += points[i];
    return sum / static_cast<double>(size);
  };
  Registration found;
  found.from = mean(from);
  found.to = mean(to);
  Matrix3 covariance = Matrix3::Zero();
  double spread = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const Vector3 offset = from[i] - found.from;
    covariance += (to[i] - found.to) * offset.transpose();
    spread += offset.squaredNorm();
  }
  const Eigen::JacobiSVD<Matrix3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kMinSpread * static_cast<double>(size))) return std::nullopt;
  Vector3 signs = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  found.scale = signs.dot(svd.singularValues()) / spread;
  found.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return found;
}

}  // namespace mrhi
