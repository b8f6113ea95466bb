#include "mr_hand_interaction/response/grip.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace mrhi {
namespace {

Vector3 mean_tip(const Grip& grip, const Hand& hand) {
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    if (!grip.takes_part(finger)) continue;
    sum += tip_of(hand, finger);
    ++count;
  }
  return sum / count;
}

/// The palm's turn counts as that of pads which are so far from the middle [m]. Objects turn in hands: over
/// 0.2 s in the median ARCTIC's turn by 16 degrees against the palm, and by 9 against the pads that hold
/// them.
constexpr double kPalmTurns = 0.008;

/// Of each end of a distal phalanx: both sides of the grip count alike, one of 1/2 in the sum.
std::array<double, kFingers> weights_of(const Grip& grip) {
  std::array<double, kFingers> result{};
  int count = 0;
  for (int finger = 0; finger < kFingers; ++finger) count += grip.takes_part(finger) ? 1 : 0;
  for (int finger = 0; finger < kFingers; ++finger)
    if (grip.takes_part(finger)) result[static_cast<std::size_t>(finger)] = 0.25 / count;
  if (!grip.by_palm) result[0] = 0.25;
  return result;
}

/// Of a matrix that is nearly flat, or mirrors.
///
///     A = U S V',    R = U diag(1, 1, det U det V) V'
///
/// of all rotations that with the largest tr(R'A) (Kabsch 1976; Umeyama 1991). The sign is on the least
/// singular value, which Eigen has last: without it the nearest orthogonal matrix may be a mirror.
Quaternion nearest_turn_of_any(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3 &u = svd.matrixU(), &v = svd.matrixV();
  const Vector3 signs(1.0, 1.0, u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0);
  return Quaternion(Matrix3(u * signs.asDiagonal() * v.transpose())).normalized();
}

/// The rotation that is nearest to a matrix: what is left of it in the limit of Newton's iteration for the
/// polar decomposition (Higham 1986, scaled), in a twentieth of a singular value decomposition's time.
///
///     X <- (z X + X^-T / z) / 2,     z = sqrt(|X^-T| / |X|)
///
/// X = Q H has X^-T = Q H^-1: the turn Q stays, and each singular value s becomes (s + 1/s) / 2, which goes
/// to 1 by squares. Scaling spares the first steps, which halve a large s only. A determinant <= 0 would
/// lead to a mirror, and a small one to an inverse that is rounding: these go the other way.
Quaternion nearest_turn(const Matrix3& matrix) {
  constexpr double kFlat = 1e-4, kSettled = 1e-28;  // of the size to its power
  constexpr int kMostSteps = 12;
  const double size = matrix.norm();
  if (!(matrix.determinant() > kFlat * size * size * size)) return nearest_turn_of_any(matrix);
  Matrix3 turn = matrix;
  for (int i = 0; i < kMostSteps; ++i) {
    const Matrix3 dual = turn.inverse().transpose();
    const double scale = std::sqrt(dual.norm() / turn.norm());
    const Matrix3 next = 0.5 * (scale * turn + (1.0 / scale) * dual);
    const double changed = (next - turn).squaredNorm();
    turn = next;
    if (changed < kSettled) break;
  }
  return Quaternion(turn).normalized();
}

}  // namespace

std::size_t tip_point(int finger) {
  return 3 + 2 * static_cast<std::size_t>(capsule_index(finger, 3));
}

Vector3 tip_of(const Hand& hand, int finger) {
  return hand.capsules[static_cast<std::size_t>(capsule_index(finger, 3))].end;
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
    const Capsule& bone = hand.capsules[static_cast<std::size_t>(capsule_index(finger, 3))];
    const std::size_t i = 2 * static_cast<std::size_t>(finger);
    result[i] = hand.palm.to_local(bone.start);
    result[i + 1] = hand.palm.to_local(bone.end);
  }
  return result;
}

// Kabsch (1976): of rigid motions x -> R x + t the one with the least sum w_i |y_i - R x_i - t|^2 has R the
// rotation nearest to H = sum w_i (y_i - y)(x_i - x)', and t = y - R x, with x, y the weighted means. The
// palm adds r^2 1 to H, as if it had pads all round at a distance r that have not moved in its frame.
Pose moved_in_palm(const Grip& grip, const Hand& hand) {
  const DistalEnds pads = distal_ends(hand);
  const std::array<double, kFingers> weights = weights_of(grip);
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();
  for (std::size_t i = 0; i < pads.size(); ++i) {
    from += weights[i / 2] * grip.pads[i];
    to += weights[i / 2] * pads[i];
  }
  Matrix3 spread = kPalmTurns * kPalmTurns * Matrix3::Identity();
  for (std::size_t i = 0; i < pads.size(); ++i)
    spread += weights[i / 2] * (pads[i] - to) * (grip.pads[i] - from).transpose();
  // The palm's middle is one side of the grip, of weight 1/2: it is the origin, x_i = y_i = 0.
  if (grip.by_palm) spread += 0.5 * to * from.transpose();
  const Quaternion turn = nearest_turn(spread);
  return {to - turn * from, turn};
}

}  // namespace mrhi
