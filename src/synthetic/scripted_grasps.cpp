#include "motions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "../text/text.h"

namespace mrhi {
namespace {

using Jacobian = Eigen::Matrix<double, 3, kFingerJoints>;
using JointMatrix = Eigen::Matrix<double, kFingerJoints, kFingerJoints>;

Vector3 tip(const FingerSkeleton& finger, const FingerAngles& angles) {
  return finger_joints(finger, angles)[4];
}

/// Central differences; a joint that cannot move (no range, or at its limit) has no column.
Jacobian tip_jacobian(const FingerSkeleton& finger, const FingerAngles& angles, const Vector3& error) {
  constexpr double kStep = 1e-5;
  Jacobian jacobian = Jacobian::Zero();
  for (int joint = 0; joint < kFingerJoints; ++joint) {
    if (finger.lower[joint] == finger.upper[joint]) continue;
    FingerAngles ahead = angles, behind = angles;
    ahead[joint] += kStep;
    behind[joint] -= kStep;
    const Vector3 column = (tip(finger, ahead) - tip(finger, behind)) / (2.0 * kStep);
    const double closing_rate = column.dot(error);
    const bool at_limit = (angles[joint] >= finger.upper[joint] && closing_rate > 0.0) ||
                          (angles[joint] <= finger.lower[joint] && closing_rate < 0.0);
    if (!at_limit) jacobian.col(joint) = column;
  }
  return jacobian;
}

constexpr double kSlowClosingGap =
    0.003;  // mean gap from which the fingers close slowly, so that they touch gently [m]
constexpr double kClosedGap = 0.0015;  // mean gap at which the fingers of a grip have arrived [m]
constexpr int kGripSteps = 5;          // of a grip's depth

/// All tips at `fraction` of their depths; below 0 they are off the surface.
HandPosture posture_at(Grasp grasp, double fraction) {
  for (FingertipContact& contact : grasp.contacts) contact.depth *= fraction;
  return grasp.posture(-1.0);
}

// The thumb bears against three fingers opposite it, or against four round a ball, which push obliquely.
constexpr double kThumbDepth = 0.006, kFingerDepth = 0.002;
constexpr double kBallThumbDepth = 0.006, kBallFingerDepth = 0.00198;

/// Thumb on the near face (-y), three fingers on the far one of a body `width` thick, the hand above.
std::vector<FingertipContact> opposed_contacts(double width, double spacing) {
  const double y = 0.5 * width;
  const Vector3 far(0.0, 1.0, 0.0);
  return {{0, {0.0, -y, 0.0}, -far, kThumbDepth},
          {1, {-spacing, y, 0.0}, far, kFingerDepth},
          {2, {0.0, y, 0.0}, far, kFingerDepth},
          {3, {spacing, y, 0.0}, far, kFingerDepth}};
}

FingertipContact ball_contact(int finger, double azimuth, double depth) {
  constexpr double kRadius = 0.03;
  const double a = azimuth * M_PI / 180.0;
  const Vector3 normal(std::sin(a), std::cos(a), 0.0);
  return {finger, kRadius * normal, normal, depth};
}

struct GraspEntry {
  const char* name;  ///< of the object
  Grasp grasp;
};
const std::vector<GraspEntry>& shipped_grasps() {
  const Vector3 up = Vector3::UnitZ();
  static const std::vector<GraspEntry> all{
      {"cube",
       Grasp{hand_pose({0.0117, -0.0406, 0.1056}, {-0.122, 0.925, -0.359}, {-0.137, 0.342, 0.929}),
             opposed_contacts(0.05, 0.0175),
             posture_of_degrees(
                 {{25, 0, 0, 0, -4}, {0, 50, 50, 50, 55}, {15, 35, 38, 38, 45}, {30, 25, 25, 25, 30}, {30}}),
             0.018, Vector3::UnitZ()}},
      // All five fingertips on the equator, so that they cannot squeeze the ball out; the palm above.
      {"ball",
       Grasp{hand_pose({0.0372, -0.0292, 0.0985}, {-0.342, 0.848, -0.405}, {0.099, 0.462, 0.881}),
             {ball_contact(0, 180.0, kBallThumbDepth), ball_contact(1, -57.0, kBallFingerDepth),
              ball_contact(2, -17.0, kBallFingerDepth), ball_contact(3, 20.0, kBallFingerDepth),
              ball_contact(4, 54.0, kBallFingerDepth)},
             posture_of_degrees(
                 {{28, 4, 0, -2, -6}, {0, 40, 42, 42, 42}, {15, 40, 42, 42, 40}, {30, 28, 28, 28, 28}, {30}}),
             0.018,
             Vector3::UnitZ()}},
      {"long_cuboid",
       Grasp{hand_pose({0.0186, -0.0443, 0.1067}, {-0.296, 0.878, -0.377}, {-0.246, 0.311, 0.918}),
             opposed_contacts(0.02, 0.018),
             posture_of_degrees(
                 {{25, 0, 0, 0, -4}, {5, 50, 50, 50, 55}, {15, 38, 38, 38, 45}, {30, 25, 25, 25, 30}, {35}}),
             0.018, Vector3::UnitZ()}
           .turned(turn(90.0, Vector3::UnitY()))},
      {"flat_cuboid",
       Grasp{hand_pose({0.001, -0.0859, -0.0371}, {0.278, 0.774, -0.568}, {0.399, -0.631, -0.665}),
             {{0, {0.0, -0.010, 0.006}, up, kThumbDepth},
              {1, {0.018, -0.010, -0.006}, -up, kFingerDepth},
              {2, {0.0, -0.010, -0.006}, -up, kFingerDepth},
              {3, {-0.018, -0.010, -0.006}, -up, kFingerDepth}},
             posture_of_degrees(
                 {{30, 0, 0, 0, -2}, {5, 60, 60, 60, 55}, {15, 35, 38, 38, 40}, {25, 22, 22, 22, 22}, {30}}),
             0.015,
             -Vector3::UnitY()}}};
  return all;
}

}  // namespace

FingerSolution solve_finger(const FingerSkeleton& finger, const Vector3& target,
                            const FingerAngles& preferred, int iterations) {
  constexpr double kDamping = 2e-3;     // [m]
  constexpr double kLongestStep = 0.2;  // [rad]
  constexpr double kPreferenceGain = 0.2;
  FingerAngles angles = preferred.cwiseMax(finger.lower).cwiseMin(finger.upper);
  for (int i = 0; i < iterations; ++i) {
    const Vector3 error = target - tip(finger, angles);
    const Jacobian jacobian = tip_jacobian(finger, angles, error);
    const Matrix3 damped = jacobian * jacobian.transpose() + kDamping * kDamping * Matrix3::Identity();
    const Eigen::Matrix<double, kFingerJoints, 3> inverse = jacobian.transpose() * damped.inverse();
    // The pull to the preferred posture fades so that the last iterations are for the target alone.
    const double gain = i < iterations / 2 ? kPreferenceGain : 0.0;
    FingerAngles change =
        inverse * error + (JointMatrix::Identity() - inverse * jacobian) * (gain * (preferred - angles));
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > kLongestStep) change *= kLongestStep / largest;
    const FingerAngles next = (angles + change).cwiseMax(finger.lower).cwiseMin(finger.upper);
    // An iteration depends on the angles and the gain alone: what has converged to the bit stays so.
    if (next == angles) i = i < iterations / 2 ? iterations / 2 - 1 : iterations;
    angles = next;
  }
  return {angles, (target - tip(finger, angles)).norm()};
}

FingerSolution Grasp::solve_contact(const FingertipContact& contact, double gap, int iterations) const {
  const FingerSkeleton& finger = human_hand().fingers[contact.finger];
  const double height = finger.radius + (gap < 0.0 ? -contact.depth : gap);
  const Vector3 target = wrist.to_local(contact.point + height * contact.normal);
  return solve_finger(finger, target, preferred.col(contact.finger), iterations);
}

HandPosture Grasp::posture(double gap) const {
  HandPosture posture = within_limits(human_hand(), preferred);
  for (const FingertipContact& contact : contacts)
    posture.col(contact.finger) = solve_contact(contact, gap).angles;
  return posture;
}

Grasp Grasp::turned(const Quaternion& by) const {
  Grasp grasp = *this;
  grasp.wrist = Pose{Vector3::Zero(), by} * wrist;
  for (FingertipContact& contact : grasp.contacts) {
    contact.point = by * contact.point;
    contact.normal = by * contact.normal;
  }
  grasp.retreat = by * retreat;
  return grasp;
}

GraspPostures::GraspPostures(const Grasp& grasp) {
  double mean_depth = 0.0;
  for (const FingertipContact& contact : grasp.contacts) mean_depth += contact.depth;
  mean_depth /= static_cast<double>(grasp.contacts.size());
  open = grasp.posture(grasp.opening);
  near = posture_at(grasp, -kSlowClosingGap / mean_depth);
  touching = posture_at(grasp, 0.0);
  closed = posture_at(grasp, 1.0);
  touching_fraction = kSlowClosingGap / (kSlowClosingGap + mean_depth);
}

Grasp grasp_of(const Body& body) {
  const GraspEntry* const shipped = text::find_named(shipped_grasps(), body.name);
  return shipped != nullptr ? shipped->grasp : find_grasp(body);
}

Grasp shipped_grasp(const std::string& object) {
  if (const GraspEntry* const shipped = text::find_named(shipped_grasps(), object)) return shipped->grasp;
  throw std::invalid_argument("no grasp of '" + object + "' is known: use one of " +
                              text::joined(text::names_of(shipped_grasps())));
}

GripPostures::GripPostures(const Grasp& grasp, double deepest) : deepest_(deepest) {
  double mean_fraction = 0.0;
  for (const FingertipContact& contact : grasp.contacts)
    mean_fraction += contact.depth / static_cast<double>(grasp.contacts.size());
  near_depth = -kClosedGap / mean_fraction;
  open = grasp.posture(grasp.opening);
  near = posture_at(grasp, near_depth);
  for (int i = 0; i < kGripSteps; ++i) closed_.push_back(posture_at(grasp, deepest * i / (kGripSteps - 1)));
}

HandPosture GripPostures::at(double depth) const {
  if (depth < 0.0) {
    const double fraction = std::min(1.0, depth / near_depth);
    return closed_.front() + fraction * (near - closed_.front());
  }
  const double place = std::min(1.0, depth / deepest_) * (kGripSteps - 1);
  const auto below = static_cast<std::size_t>(std::min(kGripSteps - 2.0, place));
  return closed_[below] + (place - static_cast<double>(below)) * (closed_[below + 1] - closed_[below]);
}

std::vector<Quaternion> box_symmetries(const Body& body) {
  std::vector<Quaternion> turns{Quaternion::Identity()};
  const auto* box = body.shapes.size() == 1 ? std::get_if<Box>(&body.shapes[0].shape) : nullptr;
  if (box == nullptr) return turns;
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const auto& order : kOrders) {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3 axes = Matrix3::Zero();
      for (int i = 0; i < 3; ++i) axes(order[i], i) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
      const Vector3 image = axes.cwiseAbs() * box->half_extents;
      const bool identity = axes.isIdentity();
      if (axes.determinant() > 0.0 && image.isApprox(box->half_extents, 1e-9) && !identity)
        turns.emplace_back(axes);
    }
  }
  return turns;
}

}  // namespace mrhi
