#include "joint_orders.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "../text/text.h"
#include "joint_check.h"

namespace mrhi {
namespace {

constexpr std::size_t kNone = JointOrder::kNotListed;

/// Fingers one after the other from `first`, each with `listed` joints of a finger, of the thumb with four.
JointOrder finger_by_finger(const char* name, std::size_t size, std::size_t wrist, std::size_t first,
                            std::size_t listed) {
  JointOrder order{name, size, wrist, {}};
  for (std::size_t f = 0; f < kFingers; ++f) {
    const std::size_t own = f == 0 ? 4 : listed;
    for (std::size_t j = 0; j < 5; ++j) order.joints[f][j] = j < 5 - own ? kNone : first++;
  }
  return order;
}

std::vector<JointOrder> make_orders() {
  JointOrder little_first = finger_by_finger("little_first", 21, 0, 1, 4);
  std::reverse(little_first.joints.begin(), little_first.joints.end());
  return {finger_by_finger("mediapipe", 21, 0, 1, 4),
          // Wrist; index, middle, little, ring, thumb without tips; the tips, thumb to little.
          {"mano",
           21,
           0,
           {{{kNone, 13, 14, 15, 16},
             {kNone, 1, 2, 3, 17},
             {kNone, 4, 5, 6, 18},
             {kNone, 10, 11, 12, 19},
             {kNone, 7, 8, 9, 20}}}},
          // The same with the tips in the order of the fingers before.
          {"mano_tips",
           21,
           0,
           {{{kNone, 13, 14, 15, 20},
             {kNone, 1, 2, 3, 16},
             {kNone, 4, 5, 6, 17},
             {kNone, 10, 11, 12, 19},
             {kNone, 7, 8, 9, 18}}}},
          // Thumb to little, each from its tip; the wrist.
          {"interhand",
           21,
           20,
           {{{kNone, 3, 2, 1, 0},
             {kNone, 7, 6, 5, 4},
             {kNone, 11, 10, 9, 8},
             {kNone, 15, 14, 13, 12},
             {kNone, 19, 18, 17, 16}}}},
          little_first,
          // Wrist, forearm; the thumb's trapezium and three joints; index, middle, ring three each; little
          // four; tips.
          {"oculus",
           24,
           0,
           {{{kNone, 3, 4, 5, 19},
             {kNone, 6, 7, 8, 20},
             {kNone, 9, 10, 11, 21},
             {kNone, 12, 13, 14, 22},
             {15, 16, 17, 18, 23}}}},
          finger_by_finger("webxr", 25, 0, 1, 5),
          finger_by_finger("openxr", 26, 1, 2, 5)};
}

std::string names_of(std::size_t size) {
  std::vector<std::string> names;
  for (const JointOrder& order : joint_orders())
    if (size == 0 || order.size == size) names.emplace_back(order.name);
  return text::joined(names);
}

std::optional<Vector3> known(const Vector3& point) {
  if (point.hasNaN()) return std::nullopt;
  return point;
}

/// NaN fails the comparison.
bool is_radius(float radius) {
  return radius > 0.0f;
}

std::optional<double> misfit(HandJoints hand) {
  drop_placeholders(hand);
  const auto fit = proportions(hand);
  return fit ? std::make_optional(fit->misfit) : std::nullopt;
}

}  // namespace

const std::vector<JointOrder>& joint_orders() {
  static const std::vector<JointOrder> orders = make_orders();
  return orders;
}

const JointOrder& joint_order(const std::string& name) {
  for (const JointOrder& order : joint_orders())
    if (order.name == name) return order;
  throw std::invalid_argument("order '" + text::one_line(name, 60) +
                              "' is not known; allowed: " + names_of(0));
}

HandJoints hand_in_order(const JointOrder& order, const Vector3* points, const float* radii, Side side) {
  HandJoints hand;
  hand.id = 1u + static_cast<std::uint32_t>(side);
  hand.side = side;
  hand.wrist = known(points[order.wrist]);
  for (std::size_t f = 0; f < kFingers; ++f) {
    const auto& places = order.joints[f];
    for (std::size_t j = 0; j < places.size(); ++j)
      if (places[j] != kNone) hand.joints[f][j] = known(points[places[j]]);
    for (std::size_t b = 0; radii != nullptr && b < kBonesPerFinger; ++b) {
      if (places[b] == kNone || places[b + 1] == kNone) continue;
      const float start = radii[places[b]], end = radii[places[b + 1]];
      if (is_radius(start) && is_radius(end)) hand.bone_width[f][b] = start + end;  // twice their mean
    }
  }
  return hand;
}

const JointOrder& OrderRecognition::order_of(std::size_t size, const Vector3* points, bool& changed) {
  const std::vector<JointOrder>& orders = joint_orders();
  if (size != size_) {
    size_ = size;
    misfits_.assign(orders.size(), std::nullopt);
    chosen_ = &*std::find_if(orders.begin(), orders.end(),
                             [=](const JointOrder& order) { return order.size == size; });
  }
  std::size_t best = orders.size();
  const auto now = static_cast<std::size_t>(chosen_ - orders.data());
  for (std::size_t i = 0; i < orders.size(); ++i) {
    if (orders[i].size != size) continue;
    const auto found = misfit(hand_in_order(orders[i], points, nullptr, Side::right));
    if (found) misfits_[i] = misfits_[i] ? *misfits_[i] + kNewShare * (*found - *misfits_[i]) : *found;
    if (misfits_[i] && (best == orders.size() || *misfits_[i] < *misfits_[best])) best = i;
  }
  if (best == orders.size()) return *chosen_;
  if (*misfits_[best] > kNoHand)
    throw std::invalid_argument(
        std::to_string(size) + " joints, but their bones are a hand's in no known order; allowed: " +
        names_of(size) + "; order:=NAME (replay: --hand-order NAME) takes them all the same");
  changed = misfits_[now] && *misfits_[best] + kMargin < *misfits_[now];
  if (changed) chosen_ = &orders[best];
  return *chosen_;
}

}  // namespace mrhi
