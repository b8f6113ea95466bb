#include <algorithm>
#include <cmath>

#include "motions.h"

namespace mrhi {
namespace {

/// A grasp: everything relative to the object's centre, right hand.
struct Grasp {
  Pose wrist;  ///< while the object is held
  std::vector<FingertipContact> contacts;
  HandPosture preferred;  ///< that the fingers are near to
  double opening;         ///< of each fingertip before closing and after [m]
  Vector3 retreat;        ///< unit: the way by which the open hand leaves the object

  Grasp turned(const Quaternion& by) const {
    Grasp grasp = *this;
    grasp.wrist = Pose{Vector3::Zero(), by} * wrist;
    for (FingertipContact& contact : grasp.contacts) {
      contact.point = by * contact.point;
      contact.normal = by * contact.normal;
    }
    grasp.retreat = by * retreat;
    return grasp;
  }
};

Quaternion turn(double degrees, const Vector3& axis) {
  return Quaternion(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
}

constexpr double kNearly =
    0.003;  // [m] mean gap from which the fingers close slowly, so that they touch gently

/// Postures of a hand round an object: open, nearly touching, just touching with all tips, pressing. From one
/// to the next but the first each tip moves in proportion to its depth, so that the springs of tips whose
/// depths balance stay in balance all the way: closing and opening do not push the object.
struct GraspPostures {
  HandPosture open, near, touching, pressing;
  double touching_share;  ///< of the way from near to pressing

  explicit GraspPostures(const Grasp& grasp) {
    double mean_depth = 0.0;
    for (const FingertipContact& contact : grasp.contacts) mean_depth += contact.depth;
    mean_depth /= static_cast<double>(grasp.contacts.size());
    open = place_fingertips(human_hand(), grasp.wrist, grasp.contacts, grasp.opening, grasp.preferred);
    near = pressed(grasp, -kNearly / mean_depth);
    touching = pressed(grasp, 0.0);
    pressing = pressed(grasp, 1.0);
    touching_share = kNearly / (kNearly + mean_depth);
  }

 private:
  /// All tips at `share` of their depths; below 0 they are off the surface.
  static HandPosture pressed(Grasp grasp, double share) {
    for (FingertipContact& contact : grasp.contacts) contact.depth *= share;
    return place_fingertips(human_hand(), grasp.wrist, grasp.contacts, -1.0, grasp.preferred);
  }
};

/// Builds a motion keyframe by keyframe.
class Script {
 public:
  explicit Script(const char* scene) { motion_.scene = scene; }

  Script& then(double duration, const Pose& wrist, const HandPosture& posture,
               const Vector3& velocity = Vector3::Zero()) {
    const double start = motion_.keyframes.empty() ? 0.0 : motion_.keyframes.back().time;
    motion_.keyframes.push_back({start + duration, wrist, posture, velocity, HandPosture::Zero(), 0.0});
    return *this;
  }
  Script& hold(double duration) {
    const Keyframe last = motion_.keyframes.back();
    return then(duration, last.wrist, last.posture);
  }
  /// The last keyframe's posture is reached by way of another.
  Script& by_way_of(const HandPosture& posture, double share) {
    motion_.keyframes.back().via = posture;
    motion_.keyframes.back().via_share = share;
    return *this;
  }
  Script& object_twist(const Twist& twist) {
    motion_.object_twist = twist;
    return *this;
  }
  ScriptedMotion motion() const { return motion_; }

 private:
  ScriptedMotion motion_;
};

Pose shifted(const Pose& pose, const Vector3& by) {
  return {pose.position + by, pose.orientation};
}

constexpr double kApproach = 0.10;  // [m] straight to the object with the hand open
constexpr double kAside = 0.16;     // [m] further away, where the hand comes from

/// Carries the object, held with its centre at `centre`, to another pose, holds it, lets go and withdraws.
void carry_and_release(Script& script, const Grasp& grasp, const GraspPostures& postures,
                       const Vector3& centre, const Pose& carried, const Vector3& aside) {
  const Pose target = Pose{centre, Quaternion::Identity()} * carried;
  const Pose wrist = target * grasp.wrist;
  const Vector3 retreat = carried.orientation * grasp.retreat;
  script.then(1.4, wrist, postures.pressing).hold(0.6);
  script.then(0.7, wrist, postures.near).by_way_of(postures.touching, 1.0 - postures.touching_share);
  script.then(0.5, wrist, postures.open);
  script.then(0.7, shifted(wrist, kApproach * retreat), postures.open, 0.1 * retreat);
  script.then(0.8, shifted(wrist, kApproach * retreat + aside), relaxed_posture());
}

/// Reaches for an object at rest, closes, carries and lets go.
ScriptedMotion reach_and_carry(const char* scene, const Grasp& grasp, const Vector3& aside) {
  const GraspPostures postures(grasp);
  const Pose at = Pose{scene_object(), Quaternion::Identity()} * grasp.wrist;
  const Pose before = shifted(at, kApproach * grasp.retreat);
  Script script(scene);
  script.then(0.0, shifted(before, aside), relaxed_posture());
  script.then(0.9, before, postures.open, -0.15 * grasp.retreat);
  script.then(0.8, at, postures.open);
  script.then(0.6, at, postures.near);
  script.then(0.7, at, postures.pressing).by_way_of(postures.touching, postures.touching_share);
  script.hold(0.4);
  carry_and_release(script, grasp, postures, scene_object(), {{0.0, 0.0, 0.08}, turn(25.0, Vector3::UnitZ())},
                    aside);
  return script.motion();
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

/// All five fingertips on the equator, so that they cannot squeeze the ball out; the palm above.
Grasp ball_grasp() {
  HandPosture preferred;
  preferred << 28, 4, 0, -2, -6,  //
      0, 40, 42, 42, 42,          //
      15, 40, 42, 42, 40,         //
      30, 28, 28, 28, 28,         //
      30, 0, 0, 0, 0;
  return {hand_pose({0.0372, -0.0292, 0.0985}, {-0.342, 0.848, -0.405}, {0.099, 0.462, 0.881}),
          {ball_contact(0, 180.0, kBallThumbDepth), ball_contact(1, -57.0, kBallFingerDepth),
           ball_contact(2, -17.0, kBallFingerDepth), ball_contact(3, 20.0, kBallFingerDepth),
           ball_contact(4, 54.0, kBallFingerDepth)},
          posture_of_degrees(preferred),
          0.018,
          Vector3::UnitZ()};
}

}  // namespace

ScriptedMotion grasp_cube() {
  HandPosture preferred;
  preferred << 25, 0, 0, 0, -4,  //
      0, 50, 50, 50, 55,         //
      15, 35, 38, 38, 45,        //
      30, 25, 25, 25, 30,        //
      30, 0, 0, 0, 0;
  const Grasp grasp{hand_pose({0.0117, -0.0406, 0.1056}, {-0.122, 0.925, -0.359}, {-0.137, 0.342, 0.929}),
                    opposed_contacts(0.05, 0.0175), posture_of_degrees(preferred), 0.018, Vector3::UnitZ()};
  return reach_and_carry("cube", grasp, {0.05, -kAside, 0.02});
}

ScriptedMotion grasp_ball() {
  return reach_and_carry("ball", ball_grasp(), {0.05, -kAside, 0.02});
}

ScriptedMotion catch_ball() {
  constexpr double kMeet = 0.7, kClose = 0.3, kPress = 0.4, kStop = 0.5, kStart = 0.4;  // [s]
  const Vector3 velocity(0.0, -0.3, 0.0);
  const Grasp grasp = ball_grasp().turned(turn(90.0, Vector3::UnitX()));
  const GraspPostures postures(grasp);
  const auto wrist_round = [&](const Vector3& ball) {
    return Pose{ball, Quaternion::Identity()} * grasp.wrist;
  };
  const Vector3 met = scene_object() + kMeet * velocity;
  const Vector3 near = met + kClose * velocity, closed = near + kPress * velocity;
  const Vector3 stopped = closed + 0.5 * kStop * velocity;
  Script script("ball");
  script.object_twist({velocity, Vector3::Zero()});
  script.then(0.0, wrist_round(met - 0.5 * kStart * velocity), postures.open).hold(kMeet - kStart);
  script.then(kStart, wrist_round(met), postures.open, velocity);
  script.then(kClose, wrist_round(near), postures.near, velocity);
  script.then(kPress, wrist_round(closed), postures.pressing, velocity);
  script.by_way_of(postures.touching, postures.touching_share);
  script.then(kStop, wrist_round(stopped), postures.pressing).hold(0.3);
  const Pose carried{{0.0, 0.08, 0.06}, turn(20.0, Vector3::UnitX())};
  carry_and_release(script, grasp, postures, stopped, carried, {0.08, 0.0, -0.05});
  return script.motion();
}

ScriptedMotion pinch_long() {
  HandPosture preferred;
  preferred << 25, 0, 0, 0, -4,  //
      5, 50, 50, 50, 55,         //
      15, 38, 38, 38, 45,        //
      30, 25, 25, 25, 30,        //
      35, 0, 0, 0, 0;
  const Grasp level{hand_pose({0.0186, -0.0443, 0.1067}, {-0.296, 0.878, -0.377}, {-0.246, 0.311, 0.918}),
                    opposed_contacts(0.02, 0.018), posture_of_degrees(preferred), 0.018, Vector3::UnitZ()};
  return reach_and_carry("long_cuboid", level.turned(turn(90.0, Vector3::UnitY())), {0.04, -kAside, 0.0});
}

ScriptedMotion lift_flat() {
  HandPosture preferred;
  preferred << 30, 0, 0, 0, -2,  //
      5, 60, 60, 60, 55,         //
      15, 35, 38, 38, 40,        //
      25, 22, 22, 22, 22,        //
      30, 0, 0, 0, 0;
  const Vector3 up = Vector3::UnitZ();
  const Grasp grasp{hand_pose({0.001, -0.0859, -0.0371}, {0.278, 0.774, -0.568}, {0.399, -0.631, -0.665}),
                    {{0, {0.0, -0.010, 0.006}, up, kThumbDepth},
                     {1, {0.018, -0.010, -0.006}, -up, kFingerDepth},
                     {2, {0.0, -0.010, -0.006}, -up, kFingerDepth},
                     {3, {-0.018, -0.010, -0.006}, -up, kFingerDepth}},
                    posture_of_degrees(preferred),
                    0.015,
                    -Vector3::UnitY()};
  return reach_and_carry("flat_cuboid", grasp, {0.04, -kAside + 0.08, -0.04});
}

}  // namespace mrhi
