#include "floating_person.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

namespace mrhi {
namespace {

constexpr double kMaxRailRadius = 0.03, kMinRailLength = 0.3;  // of a cylinder that is held as a rail [m]
constexpr double kMaxBar = 0.03, kMinBar = 0.1;  // width and length of a bar by which an object is held [m]

constexpr double kPalmDepth = 0.003;           // of the palm beyond the bar's surface [m]
constexpr double kClosedDepth = 0.005;         // of the closed fingers, likewise [m]
constexpr double kOpenGap = 0.001;             // of the fingers before they touch [m]
constexpr double kFlexionStep = M_PI / 360.0;  // of a joint that closes [rad]

/// Distance of the line through `bar` along y from the segment, seen along the line [m].
double distance(const Vector3& bar, const Vector3& start, const Vector3& end) {
  const auto flat = [](const Vector3& v) { return Vector3(v.x(), 0.0, v.z()); };
  const Vector3 from = flat(start - bar), along = flat(end - start);
  const double length = along.squaredNorm();
  const double fraction = length > 0.0 ? std::clamp(-from.dot(along) / length, 0.0, 1.0) : 0.0;
  return (from + fraction * along).norm();
}

/// Smallest distance from the line of the bones that a joint moves [m].
double distance(const FingerSkeleton& finger, const FingerAngles& angles, FingerJoint joint,
                const Vector3& bar) {
  const auto joints = finger_joints(finger, angles);
  double smallest = 1.0;
  for (auto bone = static_cast<std::size_t>(joint); bone < kBonesPerFinger; ++bone)
    smallest = std::min(smallest, distance(bar, joints[bone], joints[bone + 1]));
  return smallest;
}

/// Flexes joint by joint, from the palm outwards, until bones are that far from the bar's axis.
FingerAngles close_round(const FingerSkeleton& finger, FingerAngles angles, const Vector3& bar, double off) {
  static_assert(kBaseFlexion == 1 && kMiddleFlexion == 2 && kEndFlexion == 3, "a joint moves its bone");
  for (const FingerJoint joint : {kBaseFlexion, kMiddleFlexion, kEndFlexion}) {
    for (FingerAngles next = angles; next[joint] <= finger.upper[joint]; next[joint] += kFlexionStep) {
      if (distance(finger, next, joint, bar) < off) break;
      angles = next;
    }
  }
  return angles;
}

HandPosture close_round(const HandPosture& open, const Vector3& bar, double radius, double gap) {
  HandPosture closed = open;
  for (int f = 0; f < kFingers; ++f) {
    const FingerSkeleton& finger = human_hand().fingers[f];
    closed.col(f) = close_round(finger, open.col(f), bar, radius + finger.radius + gap);
  }
  return closed;
}

/// Bars along the body's z by which two hands hold it, from left to right.
std::vector<Vector3> bars_of(const Body& body) {
  std::vector<Vector3> bars;
  for (const PlacedShape& shape : body.shapes) {
    const auto* box = std::get_if<Box>(&shape.shape);
    if (box == nullptr || shape.pose.orientation.angularDistance(Quaternion::Identity()) > 1e-6) continue;
    const Vector3 size = 2.0 * box->half_extents;
    if (size.x() <= kMaxBar && size.y() <= kMaxBar && size.z() >= kMinBar)
      bars.push_back(shape.pose.position);
  }
  std::sort(bars.begin(), bars.end(), [](const Vector3& a, const Vector3& b) { return a.x() < b.x(); });
  return bars;
}

/// Grasp of an object that is to fly in a direction: of those that are equal by its symmetry, the one that
/// closes and leaves across that direction with the least rotation.
Grasp grasp_to_throw(const Body& object, const Vector3& direction) {
  const Grasp usual = grasp_of(object);
  const auto cost = [&](const Quaternion& turn) {
    return std::abs(direction.dot(turn * usual.contacts.front().normal)) +
           std::abs(direction.dot(turn * usual.retreat)) + 0.1 * turn.angularDistance(Quaternion::Identity());
  };
  const std::vector<Quaternion> turns = box_symmetries(object);
  return usual.turned(*std::min_element(turns.begin(), turns.end(),
                                        [&](const auto& a, const auto& b) { return cost(a) < cost(b); }));
}

Handhold hold_of(const Grasp& grasp) {
  const GraspPostures postures(grasp);
  return {grasp.wrist, postures.open, postures.near, postures.closed, grasp.retreat};
}

}  // namespace

PowerGrip::PowerGrip(double radius) {
  const HandJoints flat = hand_joints(human_hand(), Side::right, {}, flat_posture());
  bar = *flat.palm_centre + Vector3(0.2, 0.0, -0.15) * human_hand().palm_width;
  bar.z() -= radius - kPalmDepth;
  open = posture_of_degrees(
      {{40, 0, 0, 0, 0}, {-25, -5, -5, -5, -5}, {0, 25, 25, 25, 25}, {0, 15, 15, 15, 15}, {50}});
  near = close_round(open, bar, radius, kOpenGap);
  closed = close_round(open, bar, radius, -kClosedDepth);
}

double Rail::distance(const Vector3& from) const {
  const Vector3 off = from - centre;
  return (off - std::clamp(axis.dot(off), -half_length, half_length) * axis).norm();
}

Handhold Rail::hold(Side side, const Vector3& at, const Quaternion& person) const {
  const double sign = side == Side::left ? -1.0 : 1.0;
  const PowerGrip grip(radius);
  Vector3 dorsal = person * -Vector3::UnitY();
  dorsal = (dorsal - axis.dot(dorsal) * axis).normalized();
  const Vector3 inward = person * Vector3(-sign, 0.0, 1.0);
  const Vector3 thumb = std::copysign(1.0, axis.dot(inward)) * axis;
  Pose wrist = hand_pose(Vector3::Zero(), (sign * thumb).cross(dorsal), dorsal);
  const double along = std::clamp(axis.dot(at - centre), -half_length, half_length);
  const Vector3 mirror(1.0, sign, 1.0);
  wrist.position = centre + along * axis - wrist.orientation * Vector3(mirror.cwiseProduct(grip.bar));
  return {wrist, grip.open, grip.near, grip.closed, dorsal};
}

std::vector<Rail> rails_of(const Scene& scene) {
  std::vector<Rail> rails;
  for (const Body& body : scene.bodies) {
    if (!body.fixed || body.shapes.size() != 1) continue;
    const auto* bar = std::get_if<Cylinder>(&body.shapes[0].shape);
    if (bar == nullptr || bar->radius > kMaxRailRadius || 2.0 * bar->half_length < kMinRailLength) continue;
    const Pose pose = body.start * body.shapes[0].pose;
    rails.push_back({pose.position, pose.orientation * Vector3::UnitZ(), bar->half_length, bar->radius});
  }
  if (rails.empty())
    throw std::invalid_argument(
        "a simulated operator who floats needs a hold: the task's scene has no rail; " +
        std::string("allowed: a scene with a fixture that is one cylinder, at most 6 ") +
        "cm thick and at least 30 cm long");
  return rails;
}

std::vector<std::pair<Side, Handhold>> holds_of(const Body& object, const Vector3& place) {
  const std::vector<Vector3> bars = bars_of(object);
  if (bars.size() != 2)
    return {{Side::right, hold_of(grasp_to_throw(object, (place - object.start.position).normalized()))}};
  Handhold right = hold_of(shipped_grasp("long_cuboid")), left = right;
  left.wrist = mirrored(right.wrist), left.retreat.x() *= -1.0;
  left.wrist.position += bars[0], right.wrist.position += bars[1];
  return {{Side::left, left}, {Side::right, right}};
}

}  // namespace mrhi
