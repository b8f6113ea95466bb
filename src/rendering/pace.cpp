#include "pace.h"

#include <algorithm>
#include <limits>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

constexpr std::uint16_t kNoBody = std::numeric_limits<std::uint16_t>::max();

/// Of one end of a capsule: 0 its start, 1 its end.
ContactKey key_of(std::size_t capsule, int end) {
  ContactKey key{};
  key.point = key.shape = static_cast<std::uint8_t>(end);
  key.capsule = static_cast<std::uint8_t>(capsule);
  key.body = kNoBody;
  return key;
}

}  // namespace

double Pace::beyond(const Hand& placed) const {
  return farthest_joint(before_, placed) - way_;
}

/// The ball |x - x0| <= way is not linear: its tangent plane at the joint's side, with n = (x0 - x) / |x0 -
/// x|, has n.x >= n.x0 - way, and the gap there is way - |x - x0|. The height has the capsule's radius taken
/// off, so that a clearance's gap, which takes it off too, is that of the axis. Where a joint moves aside,
/// the plane turns from pass to pass.
double Pace::keep(const Hand& placed, std::vector<Clearance>& clearances) const {
  double least = 0.0;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &from = before_.capsules[c], &to = placed.capsules[c];
    if (from.radius <= 0.0 || to.radius <= 0.0) continue;
    for (int end = 0; end < 2; ++end) {
      const Vector3 &start = end == 0 ? from.start : from.end, &now = end == 0 ? to.start : to.end;
      const double gap = way_ - (now - start).norm();
      const ContactKey key = key_of(c, end);
      auto known = std::find_if(clearances.begin(), clearances.end(),
                                [&](const Clearance& clearance) { return clearance.key == key; });
      if (known == clearances.end()) {
        if (gap >= 0.0) continue;
        known = clearances.emplace(clearances.end());
        known->key = key;
        known->s = end;
      }
      known->normal = (start - now).normalized();
      known->height = known->normal.dot(start) - way_ - to.radius;
      known->gap = gap;
      least = std::min(least, gap);
    }
  }
  return least;
}

void Pace::forget(std::vector<Clearance>& clearances) {
  const auto ours = [](const Clearance& clearance) { return clearance.key.body == kNoBody; };
  clearances.erase(std::remove_if(clearances.begin(), clearances.end(), ours), clearances.end());
}

}  // namespace mrhi
