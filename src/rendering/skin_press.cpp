#include "skin_press.h"

#include <cmath>

#include "../simulation/contact_phase.h"

namespace mrhi {
namespace {

constexpr double kFirm = 2.0;    // force with which 63 % of the deepest compression is reached [N]
constexpr double kAround = 1.3;  // radii of the phalanx about the contact, in which skin is flattened

bool is_palm(int capsule) {
  return capsule == kPalm || bone_of(capsule) == 0;
}

bool same_part(int a, int b) {
  return is_palm(a) ? is_palm(b) : !is_palm(b) && finger_of(a) == finger_of(b);
}

/// Height h over the plane becomes 0 up to the depth d, h from 3 d on, and 3/2 (h - d) between.
double flattened(double height, double depth) {
  if (height >= 3.0 * depth) return height;
  return std::max(0.0, 1.5 * (height - depth));
}

}  // namespace

void press_flat(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                const Skin& skin, SkinSurface& surface) {
  for (const Contact& contact : contacts) {
    if (!contact.touching() || hand_id(contact, state) != hand) continue;
    const double force = std::abs(contact.normal.dot(contact.force));
    const double depth = kDeepestPress * (1.0 - std::exp(-force / kFirm));
    const double around = kAround * contact.radius;
    for (std::size_t v = 0; v < skin.size(); ++v) {
      if (!same_part(contact.key.capsule, skin.model().looks[v].capsule)) continue;
      const Vector3 out = surface.vertices[v] - contact.point;
      const double height = contact.normal.dot(out);
      const bool near = height < 3.0 * depth && height > -depth && out.squaredNorm() < around * around;
      if (near) surface.vertices[v] += (flattened(height, depth) - height) * contact.normal;
    }
  }
}

}  // namespace mrhi
