#include "mr_hand_interaction/tracking/joints.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "../math/registration.h"
#include "../text/text.h"
#include "hand_anatomy.h"
#include "joints_input.h"

namespace mrhi {
namespace {

Vector3 mirrored(const Vector3& point, Side side) {
  return side == Side::left ? Vector3(point.x(), -point.y(), point.z()) : point;
}

/// Fit of the anatomical palm in the device's frame.
struct PalmFit {
  Pose palm;
  double scale = 1.0;  ///< of this hand to the adult's
  Side side = Side::right;

  /// A point of the anatomical palm in the device's frame.
  Vector3 place(const Vector3& anatomical) const { return palm * (scale * mirrored(anatomical, side)); }
};

/// The rotation, scale and translation that map the anatomical palm onto the given joints by least squares.
/// Empty if they do not determine it: fewer than three, collinear, or not of a hand's size. The wrist moves
/// relative to the palm, so it is used only if the metacarpals' bases are unknown.
///
///     sum |s R a_i + t - m_i|^2 -> min,   t = mean m - s R mean a
/// over a scale s, a rotation R and a place t, a_i of the adult's palm, m_i measured in the device's frame
/// (Umeyama 1991). A left hand is fitted to the mirrored palm, not by a reflection: R is a rotation for both.
std::optional<PalmFit> fit_palm(const HandJoints& hand) {
  std::array<Vector3, 10> anatomical, measured;
  std::size_t size = 0;
  const auto add = [&](const Vector3& point, const std::optional<Vector3>& seen) {
    if (!seen) return;
    anatomical[size] = mirrored(point, hand.side);
    measured[size++] = *seen;
  };
  add(Vector3::Zero(), hand.palm_centre);
  const std::size_t before = size;
  for (std::size_t i = 0; i < 4; ++i) add(anatomy::kMetacarpalBases[i], hand.joints[i + 1][0]);
  const bool bases_known = size > before;
  for (std::size_t i = 0; i < 4; ++i) add(anatomy::kKnuckles[i], hand.joints[i + 1][1]);
  if (!bases_known) add(anatomy::kWrist, hand.wrist);
  const auto found = registered(anatomical.data(), measured.data(), size);
  if (!found) return std::nullopt;
  PalmFit fit;
  fit.side = hand.side;
  fit.scale = found->scale;
  fit.palm.orientation = Quaternion(found->rotation).normalized();
  fit.palm.position = found->to - fit.scale * (found->rotation * found->from);
  if (!(fit.scale > kSmallestHand && fit.scale < kLargestHand)) return std::nullopt;
  return fit;
}

/// Shortest bone with a direction [m]; the thumb's metacarpal has length zero in Leap's skeleton.
constexpr double kMinBoneLength = 1e-6;

/// Rounded to float32. Volatile, because GCC 12 at -O2 drops the conversion there and back where it
/// vectorises it.
double as_float(double value) {
  const volatile float rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

double fraction(float value) {
  return static_cast<double>(std::min(std::max(value, 0.0f), 1.0f));
}

/// A tracker's width is a diameter in single precision; a default is rounded likewise.
double bone_radius(const HandJoints& joints, const PalmFit& fit, std::size_t finger, std::size_t bone) {
  const auto& own = joints.bone_width[finger][bone];
  const auto& width = own ? own : joints.finger_width[finger];
  return as_float(width ? 0.5 * static_cast<double>(*width)
                        : fit.scale * (1e-3 * anatomy::kFingerRadii[finger]));
}

/// Joint i is the start of bone i and the end of bone i - 1, in the device's frame; capsules are in world. A
/// missing base of a metacarpal is filled in; the thumb has no metacarpal in the palm. A bone without length
/// has no direction, and is left out as if it were missing.
void place_finger(const HandJoints& joints, const PalmFit& fit, std::size_t finger,
                  const Pose& device_in_world, Hand& hand) {
  auto completed = joints.joints[finger];
  if (finger > 0 && !completed[0] && completed[1])
    completed[0] = fit.place(anatomy::kMetacarpalBases[finger - 1]);
  for (std::size_t bone = 0; bone < kBonesPerFinger; ++bone) {
    const auto &start = completed[bone], &end = completed[bone + 1];
    if (!start || !end || (*end - *start).norm() < kMinBoneLength) continue;
    hand.capsules[finger * kBonesPerFinger + bone] = {device_in_world * *start, device_in_world * *end,
                                                      bone_radius(joints, fit, finger, bone)};
  }
}

Vector3 wrist_of(const HandJoints& joints, const PalmFit& fit) {
  const Vector3 wrist = joints.wrist.value_or(fit.place(anatomy::kWrist));
  return {as_float(wrist.x()), as_float(wrist.y()), as_float(wrist.z())};
}

constexpr double kMaxBoneLength = 0.3;        // [m]
constexpr double kMaxTrackerDistance = 10.0;  // of a joint [m]
/// Largest coordinate of a hand in world [m]: below HandFrame.msg's limit, with a margin for its joints.
constexpr double kMaxCoordinate = 980.0;
constexpr float kMaxPalmWidth = 0.3f, kMaxFingerWidth = 0.1f, kMaxBoneWidth = 0.19f;  // [m]

const char* const kFingerNames[kFingers] = {"thumb", "index", "middle", "ring", "little"};
const char* const kJointNames[5] = {"metacarpal base", "metacarpal end", "proximal end", "intermediate end",
                                    "tip"};
const char* const kBoneNames[kBonesPerFinger] = {"metacarpal", "proximal", "intermediate", "distal"};

/// The words of a name, joined only if there is a defect: nearly every hand has none.
using Name = std::initializer_list<const char*>;

std::string point_defect(Name name, const std::optional<Vector3>& point) {
  if (!point) return "";
  if (!point->allFinite()) return text::joined(name, " ") + " is not finite";
  if (point->norm() > kMaxTrackerDistance)
    return text::joined(name, " ") + " is " + std::to_string(point->norm()) + " m away; at most 10 m";
  return "";
}

/// NaN fails both comparisons, and is a defect.
std::string width_defect(Name name, const std::optional<float>& width, float widest) {
  if (!width || (*width > 0.0f && *width <= widest)) return "";
  return text::joined(name, " ") + " " + std::to_string(*width) + " m is not in (0, " +
         std::to_string(widest) + "]";
}

std::string finger_defect(const HandJoints& hand, std::size_t finger) {
  const char* const name = kFingerNames[finger];
  const auto& joints = hand.joints[finger];
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::string found = point_defect({name, kJointNames[j]}, joints[j]);
    if (!found.empty()) return found;
  }
  for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
    const std::string wide =
        width_defect({name, kBoneNames[b], "width"}, hand.bone_width[finger][b], kMaxBoneWidth);
    if (!wide.empty()) return wide;
    if (!joints[b] || !joints[b + 1]) continue;
    const double length = (*joints[b + 1] - *joints[b]).norm();
    if (length > kMaxBoneLength)
      return text::joined({name, kBoneNames[b]}, " ") + " is " + std::to_string(length) +
             " m long; at most 0.3 m";
  }
  return width_defect({name, "width"}, hand.finger_width[finger], kMaxFingerWidth);
}

struct Unit {
  const char* name;
  double metres;
};
constexpr Unit kUnits[] = {
    {"millimetres", 0.001}, {"centimetres", 0.01}, {"inches", 0.0254}, {"decimetres", 0.1}, {"feet", 0.3048}};

/// The unit that explains a hand `size` times as large as an adult's.
const Unit& likely_unit(double size) {
  const auto error = [size](const Unit& unit) { return std::abs(std::log(size * unit.metres)); };
  return *std::min_element(std::begin(kUnits), std::end(kUnits),
                           [&](const Unit& a, const Unit& b) { return error(a) < error(b); });
}

std::string size_defect(const HandJoints& hand) {
  const auto size = relative_size(hand);
  if (!size || (*size > kSmallestHand && *size < kLargestHand)) return "";
  std::string text = "its bones are " + text::number(*size) + " times as long as an adult's";
  if (*size > 1.0) {
    const Unit& unit = likely_unit(*size);
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

/// The first defect, or empty. Checks numbers, then bones, then the whole palm; later checks rely on earlier
/// ones. Without a defect, `fit` is the hand's fit.
std::string defect(const HandJoints& hand, std::optional<PalmFit>& fit) {
  const std::pair<const char*, float> strengths[] = {{"confidence", hand.confidence},
                                                     {"grab strength", hand.grab_strength},
                                                     {"pinch strength", hand.pinch_strength}};
  for (const auto& [name, value] : strengths)
    if (!std::isfinite(value)) return std::string(name) + " is not finite";
  if (std::string found = size_defect(hand); !found.empty()) return found;
  for (const std::string& found :
       {point_defect({"palm centre"}, hand.palm_centre), point_defect({"wrist"}, hand.wrist),
        width_defect({"palm width"}, hand.palm_width, kMaxPalmWidth)})
    if (!found.empty()) return found;
  for (std::size_t f = 0; f < kFingers; ++f) {
    const std::string found = finger_defect(hand, f);
    if (!found.empty()) return found;
  }
  if (!has_bone(hand)) return "it has no finger";
  fit = fit_palm(hand);
  if (!fit)
    return "its palm cannot be placed: needs three points of a hand's size, not in one line, out of palm "
           "centre, "
           "wrist, metacarpal bases and ends";
  return "";
}

Hand completed(const HandJoints& joints, const PalmFit& fit, const Pose& device_in_world) {
  Hand hand;
  hand.id = joints.id;
  hand.side = joints.side;
  hand.confidence = fraction(joints.confidence);
  hand.grab_strength = fraction(joints.grab_strength);
  hand.pinch_strength = fraction(joints.pinch_strength);
  hand.palm = device_in_world * Pose{joints.palm_centre.value_or(fit.palm.position), fit.palm.orientation};
  // The product of two unit quaternions is of length 1 but for rounding.
  hand.palm.orientation.normalize();
  hand.palm_width =
      joints.palm_width ? static_cast<double>(*joints.palm_width) : as_float(fit.scale * anatomy::kPalmWidth);
  hand.wrist = device_in_world * wrist_of(joints, fit);
  for (std::size_t finger = 0; finger < kFingers; ++finger)
    place_finger(joints, fit, finger, device_in_world, hand);
  hand.capsules[kPalm] = palm_capsule(hand.palm, hand.palm_width);
  return hand;
}

}  // namespace

/// Along the palm's x, from the wrist to the fingers: 0.4 of its width between the ends' centres and 0.3
/// thick, so that it is 0.7 long over all.
Capsule palm_capsule(const Pose& palm, double palm_width) {
  const Vector3 half = 0.2 * palm_width * (palm.orientation * Vector3::UnitX());
  return {palm.position - half, palm.position + half, 0.15 * palm_width};
}

std::string defect(const HandJoints& hand) {
  std::optional<PalmFit> fit;
  return defect(hand, fit);
}

Hand complete_hand(const HandJoints& joints, const Pose& device_in_world) {
  std::optional<PalmFit> fit;
  const std::string found = defect(joints, fit);
  if (!found.empty()) throw std::invalid_argument("hand " + std::to_string(joints.id) + ": " + found);
  return completed(joints, *fit, device_in_world);
}

/// Returns nothing for a frame whose hands are all unusable: as an empty frame it would end these hands.
std::optional<HandFrame> complete_frame(const JointsFrame& joints, const Pose& device_in_world,
                                        std::vector<std::string>& defects) {
  HandFrame frame;
  frame.stamp = joints.stamp;
  for (const HandJoints& hand : joints.hands) {
    std::optional<PalmFit> fit;
    std::string found = defect(hand, fit);
    for (const Hand& other : frame.hands)
      if (found.empty() && other.id == hand.id) found = "its id is that of another hand in the frame";
    if (found.empty()) {
      frame.hands.push_back(completed(hand, *fit, device_in_world));
      const Vector3& palm = frame.hands.back().palm.position;
      if (palm.allFinite() && palm.cwiseAbs().maxCoeff() < kMaxCoordinate) continue;
      frame.hands.pop_back();
      found = "palm is farther than " + text::number(kMaxCoordinate) + " m";
    }
    defects.push_back("hand " + std::to_string(hand.id) + ": " + found);
  }
  if (frame.hands.empty() && !joints.hands.empty()) return std::nullopt;
  return frame;
}

}  // namespace mrhi
