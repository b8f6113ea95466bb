#include "skin_nails.h"

#include <cmath>

#include "skin_rig.h"

namespace mrhi {
namespace {

constexpr double kRound = 0.85;                 // how far round the finger half a nail goes [rad]
constexpr double kBegins = 0.42, kPast = 0.72;  // along the bone, of its length; past its end, in its radii

double to_fourth(double x) {
  return x * x * x * x;
}

/// From a nail's middle, 1 at its edge: rather square. (x^4 + y^4)^(1/4), a superellipse (Lame), x along the
/// finger and y round it.
double from_middle(const Vector3& on_bone, double length) {
  const double begin = kBegins * length, end = length + kPast;
  const double along = (2.0 * on_bone.x() - begin - end) / (end - begin);
  const double round = std::atan2(on_bone.y(), on_bone.z()) / kRound;
  return std::sqrt(std::sqrt(to_fourth(along) + to_fourth(round)));
}

}  // namespace

SkinNail skin_nail(const Vector3& vertex) {
  for (int finger = 0; finger < kFingers; ++finger) {
    const SkinBone& tip = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, 3))];
    const Vector3 on_bone = tip.axes.transpose() * (vertex - tip.start) / tip.radius;  // in its radii
    if (on_bone.x() <= 0.0 || std::hypot(on_bone.y(), on_bone.z()) > 1.3) continue;
    const double out = from_middle(on_bone, tip.length / tip.radius);
    return {smooth_step(1.0, 0.8, out), smooth_step(0.75, 1.0, out) * smooth_step(1.4, 1.05, out)};
  }
  return {};
}

}  // namespace mrhi
