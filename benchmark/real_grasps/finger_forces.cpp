#include "finger_forces.h"

#include <map>
#include <utility>

namespace mrhi::real_grasps {

void add_finger_forces(const FrameResult& result, std::vector<double>& forces) {
  std::map<std::pair<int, int>, double> sums;  // by hand and finger
  for (const Contact& contact : result.contacts) {
    if (contact.impulse.isZero(0.0))
      sums[{contact.key.hand, finger_of(contact.key.capsule)}] += contact.force.norm();
  }
  for (const auto& [finger, sum] : sums) forces.push_back(sum);
}

}  // namespace mrhi::real_grasps
