#include <algorithm>
#include <cmath>

#include "skin_parts.h"

namespace mrhi {
namespace {

const Rgb kBack(0.91f, 0.73f, 0.62f), kPalmar(0.95f, 0.74f, 0.65f), kBlush(0.93f, 0.62f, 0.53f),
    kNail(1.0f, 0.80f, 0.76f), kNailFold(0.66f, 0.43f, 0.36f);
const Rgb kCreaseTint(0.89f, 0.81f, 0.78f);  // of the skin's colour, in the deepest fold
constexpr float kPalmCreases = 0.5f;  // of that: lines across the palm's wide triangles would look torn
const Rgb kSleeve(0.36f, 0.44f, 0.55f);
constexpr float kSleeveShade = 0.4f;            // what it takes of the light beside it
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

/// In the frame of the bone, in its radii: where fingers are redder.
Rgb finger_colour(int finger, const Vector3& vertex, const Rgb& skin) {
  const SkinBone& tip = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, 3))];
  const Vector3 q = tip.axes.transpose() * (vertex - tip.start) / tip.radius;
  const double length = tip.length / tip.radius;
  const double red = smooth_step(-0.3, length + 0.5, q.x()) * smooth_step(0.9, -0.6, q.z());
  return skin + static_cast<float>(0.7 * red) * (kBlush - skin);
}

/// Nails are lighter, and skin is darker along their edges.
Rgb with_nail(const Vector3& vertex, const Rgb& skin) {
  const SkinNail here = skin_nail(vertex);
  const Rgb colour = skin + static_cast<float>(here.nail) * (kNail - skin);
  return colour + static_cast<float>(0.5 * here.edge) * (kNailFold - colour);
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

SkinModel::Look skin_look(const Vector3& vertex, bool creases) {
  const SkinSleeve sleeve = skin_sleeve(vertex);
  const auto shares = capsule_shares(vertex);
  const auto most =
      static_cast<int>(std::max_element(shares.begin(), shares.begin() + kPhalanges) - shares.begin());
  // The palm is pinker than the back of the hand, so that one can be told from the other.
  const auto palmar = static_cast<float>(smooth_step(0.004, -0.008, vertex.z()));
  Rgb colour = kBack + palmar * (kPalmar - kBack);
  if (bone_of(most) >= 2) colour = finger_colour(finger_of(most), vertex, colour);
  if (creases) {
    const float deep = bone_of(most) == 0 ? kPalmCreases : 1.0f;
    colour *= 1.0f - deep * static_cast<float>(skin_crease(vertex)) * (1.0f - kCreaseTint);
  }
  const auto shade = static_cast<float>(sleeve.shade);
  if (sleeve.covers) return {kSleeve, most};
  return {with_nail(vertex, colour) * (1.0f - kSleeveShade * shade), most};
}

}  // namespace mrhi
