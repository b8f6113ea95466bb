#include "mr_hand_interaction/response/grip.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <bitset>
#include <cmath>

namespace mrhi {
namespace {

int finger_count(const Grip& grip) {
  return static_cast<int>(std::bitset<kFingers>(grip.fingers).count());
}

Vector3 mean_tip(const Grip& grip, const Hand& hand) {
  Vector3 sum = Vector3::Zero();
  for (int finger = 0; finger < kFingers; ++finger)
    if (grip.takes_part(finger)) sum += tip_of(hand, finger);
  return sum / finger_count(grip);
}

/// Weight of the palm's rotation, as the radius of pads around its centre [m]. Objects rotate in the hand:
/// within 0.2 s the median ARCTIC object rotates by 16 degrees against the palm, and by 9 against the pads
/// that hold it.
constexpr double kPalmRadius = 0.008;

/// Weight of each end of a distal phalanx. The opposing contact groups weigh 1/2 each.
std::array<double, kFingers> weights_of(const Grip& grip) {
  std::array<double, kFingers> result{};
  for (int finger = 0; finger < kFingers; ++finger)
    if (grip.takes_part(finger)) result[finger] = 0.25 / finger_count(grip);
  if (!grip.by_palm) result[0] = 0.25;
  return result;
}

/// Nearest rotation to a matrix that may be nearly singular or a reflection.
///
///     A = U S V',    R = U diag(1, 1, det U det V) V'
///
/// R has the largest tr(R'A) of all rotations (Kabsch 1976; Umeyama 1991). The sign belongs to the smallest
/// singular value, Eigen's last: without it the nearest orthogonal matrix may be a reflection.
Quaternion nearest_turn_of_any(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3 &u = svd.matrixU(), &v = svd.matrixV();
  const Vector3 signs(1.0, 1.0, u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0);
  return Quaternion(Matrix3(u * signs.asDiagonal() * v.transpose())).normalized();
}

/// Nearest rotation to a matrix: the limit of Newton's iteration for the polar decomposition (Higham 1986,
/// scaled), at a twentieth of the cost of a singular value decomposition.
///
///     X <- (z X + X^-T / z) / 2,     z = sqrt(|X^-T| / |X|)
///
/// X = Q H has X^-T = Q H^-1: the rotation Q stays, and each singular value s becomes (s + 1/s) / 2, which
/// converges to 1 quadratically. Scaling avoids the first iterations, which only halve a large s. A
/// determinant <= 0 would converge to a reflection, and a small one has an inverse of rounding errors: both
/// take nearest_turn_of_any().
Quaternion nearest_turn(const Matrix3& matrix) {
  constexpr double kMinDeterminant = 1e-4,
                   kOrthogonal = 1e-28;  // relative to the matrix's norm, to its power
  constexpr int kMaxIterations = 12;
  const double size = matrix.norm();
  if (!(matrix.determinant() > kMinDeterminant * size * size * size)) return nearest_turn_of_any(matrix);
  Matrix3 turn = matrix;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Matrix3 dual = turn.inverse().transpose();
    const double scale = std::sqrt(dual.norm() / turn.norm());
    const Matrix3 next = 0.5 * (scale * turn + (1.0 / scale) * dual);
    const double changed = (next - turn).squaredNorm();
    turn = next;
    if (changed < kOrthogonal) break;
  }
  return Quaternion(turn).normalized();
}

}  // namespace

std::size_t tip_point(int finger) {
  return 3 + 2 * capsule_index(finger, 3);
}

Vector3 tip_of(const Hand& hand, int finger) {
  return hand.capsules[capsule_index(finger, 3)].end;
}

Vector3 base_of(const Hand& hand, bool by_palm) {
  return by_palm ? hand.palm.position : tip_of(hand, 0);
}

double aperture(const Grip& grip, const Hand& hand) {
  return (mean_tip(grip, hand) - base_of(hand, grip.by_palm)).norm();
}

DistalEnds distal_ends(const Hand& hand) {
  DistalEnds result;
  for (int finger = 0; finger < kFingers; ++finger) {
    const Capsule& bone = hand.capsules[capsule_index(finger, 3)];
    result[2 * finger] = hand.palm.to_local(bone.start);
    result[2 * finger + 1] = hand.palm.to_local(bone.end);
  }
  return result;
}

// Kabsch (1976): the rigid motion x -> R x + t that minimises sum w_i |y_i - R x_i - t|^2 has as R the
// rotation nearest to H = sum w_i (y_i - y)(x_i - x)', and t = y - R x, with x, y the weighted means. The
// palm adds r^2 1 to H, like pads around it at the distance r that have not moved in its frame.
Pose moved_in_palm(const Grip& grip, const Hand& hand) {
  const DistalEnds pads = distal_ends(hand);
  const std::array<double, kFingers> weights = weights_of(grip);
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();
  for (std::size_t i = 0; i < pads.size(); ++i) {
    from += weights[i / 2] * grip.pads[i];
    to += weights[i / 2] * pads[i];
  }
  Matrix3 spread = kPalmRadius * kPalmRadius * Matrix3::Identity();
  for (std::size_t i = 0; i < pads.size(); ++i)
    spread += weights[i / 2] * (pads[i] - to) * (grip.pads[i] - from).transpose();
  // The palm's centre is one opposing group, of weight 1/2, at the origin: x_i = y_i = 0.
  if (grip.by_palm) spread += 0.5 * to * from.transpose();
  const Quaternion turn = nearest_turn(spread);
  return {to - turn * from, turn};
}

}  // namespace mrhi
