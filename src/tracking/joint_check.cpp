#include "joint_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hand_anatomy.h"

namespace mrhi {
namespace {

constexpr double kLongestRatio = 4.0;  // of a bone to the adult's, in proportion to the hand's size
constexpr double kLongestBone = 0.3;   // where the size is not known [m]
constexpr std::size_t kJoints = 1 + 5 * kFingers;  // the wrist, then finger by finger

using Joint = std::optional<Vector3>;

Joint& joint(HandJoints& hand, std::size_t i) {
  return i == 0 ? hand.wrist : hand.joints[(i - 1) / 5][(i - 1) % 5];
}
const Joint& joint(const HandJoints& hand, std::size_t i) {
  return joint(const_cast<HandJoints&>(hand), i);
}

/// Two joints that are a known distance apart in a hand, and that distance in the adult's.
struct Link {
  std::size_t from, to;  ///< as joint() counts
  double adult;          ///< [m]
};

/// Bones, and the ways from the wrist to the knuckles. The thumb has no metacarpal.
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

/// A link whose ends are known.
struct Measured {
  const Link* link;
  double length;  ///< [m]
};

/// Without those of no length, as of a metacarpal that a tracker fills with another joint.
std::vector<Measured> measured(const HandJoints& hand) {
  std::vector<Measured> found;
  for (const Link& link : kLinks) {
    const Joint &from = joint(hand, link.from), &to = joint(hand, link.to);
    if (!from || !to) continue;
    const double length = (*to - *from).norm();
    if (length > 0.0) found.push_back({&link, length});
  }
  return found;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vector3 median_point(const HandJoints& hand) {
  Vector3 centre;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < kJoints; ++i)
      if (joint(hand, i)) values.push_back((*joint(hand, i))[axis]);
    centre[axis] = median(values);
  }
  return centre;
}

std::size_t known_joints(const HandJoints& hand) {
  std::size_t known = 0;
  for (std::size_t i = 0; i < kJoints; ++i) known += joint(hand, i).has_value();
  return known;
}

/// The end of most links that are too long, of several the one that is farthest from the middle of the hand.
std::optional<std::size_t> worst_joint(const HandJoints& hand) {
  const auto fit = proportions(hand);
  std::array<int, kJoints> faults{};
  int most = 0;
  for (const Measured& bone : measured(hand)) {
    const double longest = fit ? kLongestRatio * fit->size * bone.link->adult : kLongestBone;
    if (!(bone.length > longest)) continue;
    for (const std::size_t end : {bone.link->from, bone.link->to}) most = std::max(most, ++faults[end]);
  }
  if (most == 0) return std::nullopt;
  const Vector3 centre = median_point(hand);
  std::optional<std::size_t> worst;
  double farthest = -1.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double away = faults[i] == most ? (*joint(hand, i) - centre).norm() : -1.0;
    if (away > farthest) worst = i, farthest = away;
  }
  return worst;
}

/// A point at which joints of two fingers are cannot be of a hand. Metacarpals' bases may be: trackers that
/// have none fill them with the wrist.
bool is_shared(const HandJoints& hand, const Vector3& point) {
  int fingers = 0;
  for (const auto& joints : hand.joints)
    fingers +=
        std::any_of(joints.begin() + 1, joints.end(), [&](const Joint& j) { return j && *j == point; });
  return fingers > 1;
}

}  // namespace

std::optional<Proportions> proportions(const HandJoints& hand) {
  std::vector<double> ratios;
  for (const Measured& bone : measured(hand))
    if (std::isfinite(bone.length)) ratios.push_back(std::log(bone.length / bone.link->adult));
  if (ratios.size() < kBonesToJudge) return std::nullopt;
  const double common = median(ratios);
  double misfit = 0.0;
  for (const double ratio : ratios) misfit += std::abs(ratio - common);
  return Proportions{std::exp(common), misfit / static_cast<double>(ratios.size())};
}

std::size_t drop_placeholders(HandJoints& hand, bool wrist_is_origin) {
  std::array<bool, kJoints> placeholder{};
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < kJoints; ++i)
    placeholder[i] =
        joint(hand, i) && (*joint(hand, i) == Vector3::Zero() || is_shared(hand, *joint(hand, i)));
  if (wrist_is_origin && std::count(placeholder.begin() + 1, placeholder.end(), true) == 0)
    placeholder[0] = false;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!placeholder[i]) continue;
    joint(hand, i).reset();
    ++dropped;
  }
  return dropped;
}

std::size_t drop_stray_joints(HandJoints& hand) {
  for (std::size_t i = 0; i < kJoints; ++i)
    if (joint(hand, i) && !joint(hand, i)->allFinite()) return 0;  // it will be refused
  const std::size_t most = known_joints(hand) / 3;
  HandJoints without = hand;
  for (std::size_t dropped = 0; dropped <= most; ++dropped) {
    const auto worst = worst_joint(without);
    if (!worst) {
      if (dropped > 0) hand = without;
      return dropped;
    }
    joint(without, *worst).reset();
  }
  return 0;
}

bool has_joints(const HandJoints& hand) {
  return known_joints(hand) > 0;
}

void scale(HandJoints& hand, double factor) {
  if (factor == 1.0) return;
  for (std::size_t i = 0; i < kJoints; ++i)
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

}  // namespace mrhi
