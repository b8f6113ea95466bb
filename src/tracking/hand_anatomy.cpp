#include "hand_anatomy.h"

#include "../math/registration.h"

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

}  // namespace

/// The inverse way: out of the adult's palm to the device.
Vector3 PalmFit::place(const Vector3& anatomical) const {
  return palm * (scale * mirrored(anatomical, side));
}

///     sum |s R a_i + t - m_i|^2 -> min,   t = mean m - s R mean a
/// over a scale s, a rotation R and a place t, a_i of the adult's palm, m_i measured in the device's frame
/// (Umeyama 1991). A left hand is fitted to the mirrored palm, not by a reflection: R is a rotation for both.
std::optional<PalmFit> fit_palm(const HandJoints& hand) {
  const Correspondences points = correspondences(hand);
  const auto found = registered(points.anatomical.data(), points.measured.data(), points.size);
  if (!found) return std::nullopt;
  PalmFit fit;
  fit.side = hand.side;
  fit.scale = found->scale;
  fit.palm.orientation = Quaternion(found->rotation).normalized();
  fit.palm.position = found->to - fit.scale * (found->rotation * found->from);
  if (!(fit.scale > kSmallestHand && fit.scale < kLargestHand)) return std::nullopt;
  return fit;
}

}  // namespace mrhi
