#include "mr_hand_interaction/tracking/joints.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "../text/text.h"
#include "hand_anatomy.h"
#include "joint_check.h"

namespace mrhi {
namespace {

constexpr double kLongestBone = 0.3;     // [m]
constexpr double kFarthestJoint = 10.0;  // [m]
constexpr float kWidestPalm = 0.3f;      // [m]
constexpr float kWidestFinger = 0.1f;    // [m]

const char* const kFingerNames[kFingers] = {"thumb", "index", "middle", "ring", "little"};
const char* const kJointNames[5] = {"metacarpal base", "metacarpal end", "proximal end", "intermediate end",
                                    "tip"};
const char* const kBoneNames[kBonesPerFinger] = {"metacarpal", "proximal", "intermediate", "distal"};

std::string point_defect(const std::string& name, const std::optional<Vector3>& point) {
  if (!point) return "";
  if (!point->allFinite()) return name + " is not finite";
  if (point->norm() > kFarthestJoint)
    return name + " is " + std::to_string(point->norm()) + " m away; at most 10 m";
  return "";
}

/// Not a number fails both comparisons, and is a defect.
std::string width_defect(const std::string& name, const std::optional<float>& width, float widest) {
  if (!width || (*width > 0.0f && *width <= widest)) return "";
  return name + " " + std::to_string(*width) + " m is not in (0, " + std::to_string(widest) + "]";
}

std::string finger_defect(const HandJoints& hand, std::size_t finger) {
  const std::string name = kFingerNames[finger];
  const auto& joints = hand.joints[finger];
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::string found = point_defect(name + " " + kJointNames[j], joints[j]);
    if (!found.empty()) return found;
  }
  for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
    if (!joints[b] || !joints[b + 1]) continue;
    const double length = (*joints[b + 1] - *joints[b]).norm();
    if (length > kLongestBone)
      return name + " " + kBoneNames[b] + " is " + std::to_string(length) + " m long; at most 0.3 m";
  }
  return width_defect(name + " width", hand.finger_width[finger], kWidestFinger);
}

struct Unit {
  const char* name;
  double metres;
};
constexpr Unit kUnits[] = {
    {"millimetres", 0.001}, {"centimetres", 0.01}, {"inches", 0.0254}, {"decimetres", 0.1}, {"feet", 0.3048}};

/// The unit in which a hand would be so many times as large as an adult's.
const Unit& likely_unit(double size) {
  const auto error = [size](const Unit& unit) { return std::abs(std::log(size * unit.metres)); };
  return *std::min_element(std::begin(kUnits), std::end(kUnits),
                           [&](const Unit& a, const Unit& b) { return error(a) < error(b); });
}

std::string size_defect(const HandJoints& hand) {
  const auto fit = proportions(hand);
  if (!fit || (fit->size > kSmallestHand && fit->size < kLargestHand)) return "";
  std::string text = "its bones are " + text::number(fit->size) + " times as long as an adult's";
  if (fit->size > 1.0) {
    const Unit& unit = likely_unit(fit->size);
    const std::string factor = text::number(unit.metres);
    text += std::string(", as of ") + unit.name + "; allowed: metres; scale:=" + factor +
            " (replay: --hand-scale " + factor + ") converts";
  } else {
    text += "; allowed: metres; scale:=FACTOR (replay: --hand-scale FACTOR) converts";
  }
  return text;
}

/// A metacarpal alone, b = 0, is within the palm.
bool has_bone(const HandJoints& hand) {
  for (const auto& joints : hand.joints)
    for (std::size_t b = 1; b < kBonesPerFinger; ++b)
      if (joints[b] && joints[b + 1]) return true;
  return false;
}

}  // namespace

/// The first that is found, from numbers to bones to the palm as a whole, so that what comes later may count
/// on what came before.
std::string defect(const HandJoints& hand) {
  const std::pair<const char*, float> strengths[] = {{"confidence", hand.confidence},
                                                     {"grab strength", hand.grab_strength},
                                                     {"pinch strength", hand.pinch_strength}};
  for (const auto& [name, value] : strengths)
    if (!std::isfinite(value)) return std::string(name) + " is not finite";
  if (std::string found = size_defect(hand); !found.empty()) return found;
  for (std::string found : {point_defect("palm centre", hand.palm_centre), point_defect("wrist", hand.wrist),
                            width_defect("palm width", hand.palm_width, kWidestPalm)})
    if (!found.empty()) return found;
  for (std::size_t f = 0; f < kFingers; ++f) {
    const std::string found = finger_defect(hand, f);
    if (!found.empty()) return found;
  }
  if (!has_bone(hand)) return "it has no finger";
  if (!fit_palm(hand))
    return "its palm cannot be placed: needs three points of a hand's size, not in one line, out of palm "
           "centre, "
           "wrist, metacarpal bases and ends";
  return "";
}

/// A frame that has hands, but none that is right, is nothing: taken as empty, the hands that there are would
/// count as gone.
std::optional<HandFrame> complete_frame(const JointsFrame& joints, const Pose& device_in_world,
                                        std::vector<std::string>& defects) {
  HandFrame frame;
  frame.stamp = joints.stamp;
  for (const HandJoints& hand : joints.hands) {
    std::string found = defect(hand);
    for (const Hand& other : frame.hands)
      if (found.empty() && other.id == hand.id) found = "its id is that of another hand in the frame";
    if (found.empty())
      frame.hands.push_back(complete_hand(hand, device_in_world));
    else
      defects.push_back("hand " + std::to_string(hand.id) + ": " + found);
  }
  if (frame.hands.empty() && !joints.hands.empty()) return std::nullopt;
  return frame;
}

}  // namespace mrhi
