#include "hand_anatomy.h"

#include <Eigen/SVD>

namespace mrhi {
namespace {

struct Correspondences {
  std::array<Vector3, 10> anatomical, measured;
  std::size_t size = 0;

  void add(const Vector3& anatomical_point, const std::optional<Vector3>& measured_point) {
    if (!measured_point) return;
    anatomical[size] = anatomical_point;
    measured[size++] = *measured_point;
  }
};

Vector3 mirrored(const Vector3& point, Side side) {
  return side == Side::left ? Vector3(point.x(), -point.y(), point.z()) : point;
}

/// The wrist moves against the palm, so it serves only where the metacarpals' bases are not known.
Correspondences correspondences(const HandJoints& hand) {
  Correspondences points;
  points.add(Vector3::Zero(), hand.palm_centre);
  for (std::size_t i = 0; i < 4; ++i) {
    points.add(mirrored(anatomy::kMetacarpalBases[i], hand.side), hand.joints[i + 1][0]);
  }
  const bool bases_known = points.size > (hand.palm_centre ? 1u : 0u);
  for (std::size_t i = 0; i < 4; ++i)
    points.add(mirrored(anatomy::kKnuckles[i], hand.side), hand.joints[i + 1][1]);
  if (!bases_known) points.add(mirrored(anatomy::kWrist, hand.side), hand.wrist);
  return points;
}

Vector3 mean(const std::array<Vector3, 10>& points, std::size_t size) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < size; ++i) sum += points[i];
  return sum / static_cast<double>(size);
}

}  // namespace

Vector3 PalmFit::place(const Vector3& anatomical) const {
  return palm * (scale * mirrored(anatomical, side));
}

std::optional<PalmFit> fit_palm(const HandJoints& hand) {
  constexpr double kLeastSpread = 1e-6;  // of the second principal direction [m^2]
  const Correspondences points = correspondences(hand);
  if (points.size < 3) return std::nullopt;
  const Vector3 anatomical_mean = mean(points.anatomical, points.size);
  const Vector3 measured_mean = mean(points.measured, points.size);
  Matrix3 covariance = Matrix3::Zero();
  double spread = 0.0;
  for (std::size_t i = 0; i < points.size; ++i) {
    const Vector3 offset = points.anatomical[i] - anatomical_mean;
    covariance += (points.measured[i] - measured_mean) * offset.transpose();
    spread += offset.squaredNorm();
  }
  const Eigen::JacobiSVD<Matrix3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kLeastSpread * static_cast<double>(points.size))) return std::nullopt;
  Vector3 signs = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  PalmFit fit;
  fit.side = hand.side;
  fit.scale = signs.dot(svd.singularValues()) / spread;
  const Matrix3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  fit.palm.orientation = Quaternion(rotation).normalized();
  fit.palm.position = measured_mean - fit.scale * (rotation * anatomical_mean);
  if (!(fit.scale > 0.3 && fit.scale < 2.5)) return std::nullopt;
  return fit;
}

}  // namespace mrhi
