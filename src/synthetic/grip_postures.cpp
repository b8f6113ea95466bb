#include "scripted_grasp.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr double kNearly = 0.0015;  // [m] mean gap at which the fingers have arrived
constexpr int kSteps = 5;

HandPosture pressed(Grasp grasp, double depth) {
  for (FingertipContact& contact : grasp.contacts) contact.depth *= depth;
  return place_fingertips(human_hand(), grasp.wrist, grasp.contacts, -1.0, grasp.preferred);
}

}  // namespace

GripPostures::GripPostures(const Grasp& grasp, double deepest) : deepest_(deepest) {
  double mean_share = 0.0;
  for (const FingertipContact& contact : grasp.contacts)
    mean_share += contact.depth / static_cast<double>(grasp.contacts.size());
  near_depth = -kNearly / mean_share;
  open = place_fingertips(human_hand(), grasp.wrist, grasp.contacts, grasp.opening, grasp.preferred);
  near = pressed(grasp, near_depth);
  for (int i = 0; i < kSteps; ++i) pressed_.push_back(pressed(grasp, deepest * i / (kSteps - 1)));
}

HandPosture GripPostures::at(double depth) const {
  if (depth < 0.0) {
    const double share = std::min(1.0, depth / near_depth);
    return pressed_.front() + share * (near - pressed_.front());
  }
  const double place = std::min(1.0, depth / deepest_) * (kSteps - 1);
  const auto below = static_cast<std::size_t>(std::min(kSteps - 2.0, place));
  return pressed_[below] + (place - static_cast<double>(below)) * (pressed_[below + 1] - pressed_[below]);
}

}  // namespace mrhi
