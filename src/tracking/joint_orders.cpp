#include "joints_input.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "../text/text.h"
#include "hand_anatomy.h"

namespace mrhi {
namespace {

/// Largest ratio of a bone to the adult's, relative to the hand's size.
constexpr double kMaxBoneRatio = 4.0;
/// Longest bone of a hand of unknown size [m].
constexpr double kMaxBone = 0.3;
/// Largest misfit of a bone, ln(kMaxBoneRatio): a stray joint says nothing about the order.
constexpr double kMaxMisfit = 1.4;

using Joint = std::optional<Vector3>;

/// Two joints that are a known distance apart in a hand, and that distance in the adult's.
struct Link {
  std::size_t from, to;  ///< as joint() counts
  double adult;          ///< [m]
};

/// Bones, and the distances from the wrist to the knuckles. The thumb has no metacarpal.
std::vector<Link> make_links() {
  std::vector<Link> links;
  for (std::size_t f = 0; f < kFingers; ++f) {
    for (std::size_t b = f == 0 ? 1 : 0; b < kBonesPerFinger; ++b)
      links.push_back({1 + 5 * f + b, 2 + 5 * f + b, 1e-3 * anatomy::kBoneLengths[f][b]});
    constexpr double kWristToThumb = 0.046;
    const double palm = f == 0 ? kWristToThumb : (anatomy::kKnuckles[f - 1] - anatomy::kWrist).norm();
    links.push_back({0, 2 + 5 * f, palm});
  }
  return links;
}
const std::vector<Link> kLinks = make_links();

struct Measured {
  const Link* link;
  double length;  ///< [m]
};

/// Links with known ends, without those of zero length: a tracker may repeat a joint for a metacarpal.
std::vector<Measured> measured(const HandJoints& hand) {
  std::vector<Measured> found;
  found.reserve(kLinks.size());
  for (const Link& link : kLinks) {
    const Joint &from = joint(hand, link.from), &to = joint(hand, link.to);
    if (!from || !to) continue;
    const double length = (*to - *from).norm();
    if (length > 0.0) found.push_back({&link, length});
  }
  return found;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vector3 median_point(const HandJoints& hand) {
  Vector3 centre;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < kHandJoints; ++i)
      if (joint(hand, i)) values.push_back((*joint(hand, i))[axis]);
    centre[axis] = median(values);
  }
  return centre;
}

std::optional<double> relative_size(const std::vector<Measured>& bones) {
  std::vector<double> ratios;
  ratios.reserve(bones.size());
  for (const Measured& bone : bones)
    if (std::isfinite(bone.length)) ratios.push_back(bone.length / bone.link->adult);
  if (ratios.size() < kMinKnownBones) return std::nullopt;
  return median(std::move(ratios));
}

/// The joint at the end of most overlong links; of several, the one farthest from the hand's median point.
std::optional<std::size_t> worst_joint(const HandJoints& hand) {
  const std::vector<Measured> bones = measured(hand);
  const auto size = relative_size(bones);
  std::array<int, kHandJoints> faults{};
  int max_faults = 0;
  for (const Measured& bone : bones) {
    const double longest = size ? kMaxBoneRatio * *size * bone.link->adult : kMaxBone;
    if (!(bone.length > longest)) continue;
    for (const std::size_t end : {bone.link->from, bone.link->to})
      max_faults = std::max(max_faults, ++faults[end]);
  }
  if (max_faults == 0) return std::nullopt;
  const Vector3 centre = median_point(hand);
  std::optional<std::size_t> worst;
  double farthest = -1.0;
  for (std::size_t i = 0; i < kHandJoints; ++i) {
    const double away = faults[i] == max_faults ? (*joint(hand, i) - centre).norm() : -1.0;
    if (away > farthest) worst = i, farthest = away;
  }
  return worst;
}

/// True if joints of two fingers are at this point. Bases of metacarpals do not count: trackers without them
/// repeat the wrist.
bool is_shared(const HandJoints& hand, const Vector3& point) {
  int fingers = 0;
  for (const auto& joints : hand.joints)
    fingers +=
        std::any_of(joints.begin() + 1, joints.end(), [&](const Joint& j) { return j && *j == point; });
  return fingers > 1;
}

/// True if a finger's joint is as near to the origin as to a wrist.
bool is_near_origin(const HandJoints& hand) {
  constexpr double kMaxToWrist = 0.2;  // of the nearest joint, in large hands too [m]
  for (std::size_t i = 1; i < kHandJoints; ++i)
    if (joint(hand, i) && joint(hand, i)->norm() < kMaxToWrist) return true;
  return false;
}

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

/// Three joints of each finger one after the other from its first, and its tip elsewhere; thumb to little.
JointOrder with_tips(const char* name, std::size_t size, const std::array<std::size_t, kFingers>& first,
                     const std::array<std::size_t, kFingers>& tips) {
  JointOrder order{name, size, 0, {}};
  for (std::size_t f = 0; f < kFingers; ++f)
    order.joints[f] = {{kNone, first[f], first[f] + 1, first[f] + 2, tips[f]}};
  return order;
}

std::vector<JointOrder> make_orders() {
  JointOrder interhand = finger_by_finger("interhand", 21, 20, 0, 4);  // each finger from its tip; the wrist
  for (auto& finger : interhand.joints) std::reverse(finger.begin() + 1, finger.end());
  JointOrder little_first = finger_by_finger("little_first", 21, 0, 1, 4);
  std::reverse(little_first.joints.begin(), little_first.joints.end());
  // Wrist, forearm, the thumb's trapezium; thumb to ring without tips; the little finger with its metacarpal;
  // the tips.
  JointOrder oculus = with_tips("oculus", 24, {{3, 6, 9, 12, 16}}, {{19, 20, 21, 22, 23}});
  oculus.joints[4][0] = 15;
  return {finger_by_finger("mediapipe", 21, 0, 1, 4),
          // Wrist; index, middle, little, ring, thumb without tips; the tips, thumb to little.
          with_tips("mano", 21, {{13, 1, 4, 10, 7}}, {{16, 17, 18, 19, 20}}),
          // The same with the tips in the order of the fingers before.
          with_tips("mano_tips", 21, {{13, 1, 4, 10, 7}}, {{20, 16, 17, 19, 18}}), interhand, little_first,
          oculus, finger_by_finger("webxr", 25, 0, 1, 5), finger_by_finger("openxr", 26, 1, 2, 5)};
}

std::string names_of(std::size_t size) {
  std::vector<std::string> names;
  for (const JointOrder& order : joint_orders())
    if (size == 0 || order.size == size) names.emplace_back(order.name);
  return text::joined(names);
}

std::optional<Vector3> known(const Vector3& point) {
  if (!point.allFinite()) return std::nullopt;
  return point;
}

/// Mean of |ln(ratio / size)|, each at most kMaxMisfit.
std::optional<double> misfit(HandJoints hand) {
  drop_placeholders(hand);
  const std::vector<Measured> bones = measured(hand);
  const auto size = relative_size(bones);
  if (!size) return std::nullopt;
  double sum = 0.0, known = 0.0;
  for (const Measured& bone : bones) {
    if (!std::isfinite(bone.length)) continue;
    sum += std::min(std::abs(std::log(bone.length / bone.link->adult) - std::log(*size)), kMaxMisfit);
    known += 1.0;
  }
  return sum / known;
}

}  // namespace

std::optional<double> relative_size(const HandJoints& hand) {
  return relative_size(measured(hand));
}

std::size_t drop_placeholders(HandJoints& hand, bool wrist_is_origin) {
  std::array<bool, kHandJoints> placeholder{};
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < kHandJoints; ++i)
    placeholder[i] =
        joint(hand, i) && (*joint(hand, i) == Vector3::Zero() || is_shared(hand, *joint(hand, i)));
  if (wrist_is_origin && std::count(placeholder.begin() + 1, placeholder.end(), true) == 0 &&
      is_near_origin(hand))
    placeholder[0] = false;
  if (hand.palm_centre && hand.palm_centre->isZero(0.0)) {
    hand.palm_centre.reset();
    ++dropped;
  }
  for (std::size_t i = 0; i < kHandJoints; ++i) {
    if (!placeholder[i]) continue;
    joint(hand, i).reset();
    ++dropped;
  }
  return dropped;
}

std::size_t drop_stray_joints(HandJoints& hand) {
  if (!is_finite(hand)) return 0;  // it will be refused
  const std::size_t max_dropped = known_joints(hand) / 3;
  HandJoints without = hand;
  for (std::size_t dropped = 0; dropped <= max_dropped; ++dropped) {
    const auto worst = worst_joint(without);
    if (!worst) {
      if (dropped > 0) hand = without;
      return dropped;
    }
    joint(without, *worst).reset();
  }
  return 0;
}

std::size_t known_joints(const HandJoints& hand) {
  std::size_t known = 0;
  for (std::size_t i = 0; i < kHandJoints; ++i) known += joint(hand, i).has_value();
  return known;
}

bool is_finite(const HandJoints& hand) {
  for (std::size_t i = 0; i < kHandJoints; ++i)
    if (joint(hand, i) && !joint(hand, i)->allFinite()) return false;
  return true;
}

void scale(HandJoints& hand, double factor) {
  if (factor == 1.0) return;
  for (std::size_t i = 0; i < kHandJoints; ++i)
    if (joint(hand, i)) *joint(hand, i) *= factor;
  if (hand.palm_centre) *hand.palm_centre *= factor;
  const auto scale_width = [&](std::optional<float>& width) {
    if (width) *width = static_cast<float>(*width * factor);
  };
  scale_width(hand.palm_width);
  for (std::size_t f = 0; f < kFingers; ++f) {
    scale_width(hand.finger_width[f]);
    for (auto& width : hand.bone_width[f]) scale_width(width);
  }
}

const std::vector<JointOrder>& joint_orders() {
  static const std::vector<JointOrder> orders = make_orders();
  return orders;
}

const JointOrder* usual_order(std::size_t size) {
  for (const JointOrder& order : joint_orders())
    if (order.size == size) return &order;
  return nullptr;
}

const JointOrder& joint_order(const std::string& name) {
  if (const JointOrder* const order = text::find_named(joint_orders(), name)) return *order;
  throw std::invalid_argument("order " + text::quoted(name) + " is not known; allowed: " + names_of(0));
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
      const bool has_radii = start > 0.0f && end > 0.0f;   // NaN is not
      if (has_radii) hand.bone_width[f][b] = start + end;  // twice their mean
    }
  }
  return hand;
}

const JointOrder& OrderRecognition::order_of(std::size_t size, const Vector3* points, bool& changed) {
  const std::vector<JointOrder>& orders = joint_orders();
  if (size != size_) {
    size_ = size;
    misfits_.assign(orders.size(), std::nullopt);
    chosen_ = usual_order(size);
  }
  std::size_t best = orders.size();
  const auto now = static_cast<std::size_t>(chosen_ - orders.data());
  for (std::size_t i = 0; i < orders.size(); ++i) {
    if (orders[i].size != size) continue;
    const auto found = misfit(hand_in_order(orders[i], points, nullptr, Side::right));
    if (found) misfits_[i] = misfits_[i] ? *misfits_[i] + kNewWeight * (*found - *misfits_[i]) : *found;
    if (misfits_[i] && (best == orders.size() || *misfits_[i] < *misfits_[best])) best = i;
  }
  if (best == orders.size()) return *chosen_;
  if (*misfits_[best] > kMaxMisfit)
    throw std::invalid_argument(
        std::to_string(size) + " joints, but their bones are a hand's in no known order; allowed: " +
        names_of(size) + "; order:=NAME (replay: --hand-order NAME) takes them all the same");
  changed = misfits_[now] && *misfits_[best] + kMargin < *misfits_[now];
  if (changed) chosen_ = &orders[best];
  return *chosen_;
}

}  // namespace mrhi
