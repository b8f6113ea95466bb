#include "motions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>

#include "../collision/scene_geometry.h"
#include "../scene/solid_mesh.h"
#include "../text/text.h"

namespace mrhi {
namespace {

using Jacobian = Eigen::Matrix<double, 3, kFingerJoints>;
using JointMatrix = Eigen::Matrix<double, kFingerJoints, kFingerJoints>;

Vector3 tip(const FingerSkeleton& finger, const FingerAngles& angles) {
  return finger_joints(finger, angles)[4];
}

/// Central differences; a joint that cannot move (no range, or pressed against its limit) has no column.
Jacobian tip_jacobian(const FingerSkeleton& finger, const FingerAngles& angles, const Vector3& error) {
  constexpr double kStep = 1e-5;
  Jacobian jacobian = Jacobian::Zero();
  for (int joint = 0; joint < kFingerJoints; ++joint) {
    if (finger.lower[joint] == finger.upper[joint]) continue;
    FingerAngles ahead = angles, behind = angles;
    ahead[joint] += kStep;
    behind[joint] -= kStep;
    const Vector3 column = (tip(finger, ahead) - tip(finger, behind)) / (2.0 * kStep);
    const double wish = column.dot(error);
    const bool stuck = (angles[joint] >= finger.upper[joint] && wish > 0.0) ||
                       (angles[joint] <= finger.lower[joint] && wish < 0.0);
    if (!stuck) jacobian.col(joint) = column;
  }
  return jacobian;
}

constexpr double kNearly =
    0.003;  // mean gap from which the fingers close slowly, so that they touch gently [m]
constexpr double kArrived = 0.0015;  // mean gap at which the fingers of a grip have arrived [m]
constexpr int kSteps = 5;            // of a grip's depth

/// All tips at `share` of their depths; below 0 they are off the surface.
HandPosture pressed(Grasp grasp, double share) {
  for (FingertipContact& contact : grasp.contacts) contact.depth *= share;
  return place_fingertips(human_hand(), grasp.wrist, grasp.contacts, -1.0, grasp.preferred);
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
  Grasp (*make)();
};
const GraspEntry kGrasps[] = {
    {"cube",
     [] {
       return Grasp{
           hand_pose({0.0117, -0.0406, 0.1056}, {-0.122, 0.925, -0.359}, {-0.137, 0.342, 0.929}),
           opposed_contacts(0.05, 0.0175),
           posture_of_degrees(
               {{25, 0, 0, 0, -4}, {0, 50, 50, 50, 55}, {15, 35, 38, 38, 45}, {30, 25, 25, 25, 30}, {30}}),
           0.018, Vector3::UnitZ()};
     }},
    // All five fingertips on the equator, so that they cannot squeeze the ball out; the palm above.
    {"ball",
     [] {
       return Grasp{
           hand_pose({0.0372, -0.0292, 0.0985}, {-0.342, 0.848, -0.405}, {0.099, 0.462, 0.881}),
           {ball_contact(0, 180.0, kBallThumbDepth), ball_contact(1, -57.0, kBallFingerDepth),
            ball_contact(2, -17.0, kBallFingerDepth), ball_contact(3, 20.0, kBallFingerDepth),
            ball_contact(4, 54.0, kBallFingerDepth)},
           posture_of_degrees(
               {{28, 4, 0, -2, -6}, {0, 40, 42, 42, 42}, {15, 40, 42, 42, 40}, {30, 28, 28, 28, 28}, {30}}),
           0.018,
           Vector3::UnitZ()};
     }},
    {"long_cuboid",
     [] {
       return Grasp{
           hand_pose({0.0186, -0.0443, 0.1067}, {-0.296, 0.878, -0.377}, {-0.246, 0.311, 0.918}),
           opposed_contacts(0.02, 0.018),
           posture_of_degrees(
               {{25, 0, 0, 0, -4}, {5, 50, 50, 50, 55}, {15, 38, 38, 38, 45}, {30, 25, 25, 25, 30}, {35}}),
           0.018, Vector3::UnitZ()}
           .turned(turn(90.0, Vector3::UnitY()));
     }},
    {"flat_cuboid", [] {
       const Vector3 up = Vector3::UnitZ();
       return Grasp{
           hand_pose({0.001, -0.0859, -0.0371}, {0.278, 0.774, -0.568}, {0.399, -0.631, -0.665}),
           {{0, {0.0, -0.010, 0.006}, up, kThumbDepth},
            {1, {0.018, -0.010, -0.006}, -up, kFingerDepth},
            {2, {0.0, -0.010, -0.006}, -up, kFingerDepth},
            {3, {-0.018, -0.010, -0.006}, -up, kFingerDepth}},
           posture_of_degrees(
               {{30, 0, 0, 0, -2}, {5, 60, 60, 60, 55}, {15, 35, 38, 38, 40}, {25, 22, 22, 22, 22}, {30}}),
           0.015,
           -Vector3::UnitY()};
     }}};

constexpr double kWidest = 0.09;  // that thumb and fingers close on [m]
constexpr double kSpacing = 0.0175;
constexpr double kReached = 0.004;  // what a fingertip may be off its place [m]
/// What is higher above the fingertips than this is in the palm's way [m]: they close nearer to the palm
/// then.
constexpr double kUnderPalm = 0.045;

/// A body's surface, body frame.
class Surface {
 public:
  explicit Surface(const Body& body) {
    for (const PlacedShape& shape : body.shapes) meshes_.push_back(surface_of(shape));
    for (const TriangleMesh& mesh : meshes_)
      for (const auto& t : mesh.triangles)
        for (const int v : t) corners_.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  }

  struct Hit {
    Vector3 point, normal;
  };
  /// The outermost place on the line through `at` along `out`, seen from there.
  std::optional<Hit> outermost(const Vector3& at, const Vector3& out) const {
    std::optional<Hit> found;
    double farthest = 0.0;
    for (std::size_t i = 0; i < corners_.size(); i += 3) {
      const Vector3 &a = corners_[i], ab = corners_[i + 1] - a, ac = corners_[i + 2] - a;
      const Vector3 normal = ab.cross(ac);
      const double rise = normal.dot(out);
      if (!(rise > 1e-12 * normal.norm())) continue;  // it faces away
      const double s = normal.dot(a - at) / rise;
      const Vector3 from_a = at + s * out - a;
      const double v = from_a.cross(ac).dot(normal), w = ab.cross(from_a).dot(normal);
      if (v < 0.0 || w < 0.0 || v + w > normal.squaredNorm() || (found && s <= farthest)) continue;
      farthest = s;
      found = Hit{at + s * out, normal.normalized()};
    }
    return found;
  }
  double reach(const Vector3& n) const {
    double most = -1e300;
    for (const Vector3& corner : corners_) most = std::max(most, n.dot(corner));
    return most;
  }

 private:
  std::vector<TriangleMesh> meshes_;
  std::vector<Vector3> corners_;
};

/// Across which a hand may close: the body's axes, and those of a Fibonacci lattice.
std::vector<Vector3> directions() {
  constexpr int kOthers = 40;
  std::vector<Vector3> all{Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  for (int i = 0; i < kOthers; ++i) {
    const double z = (i + 0.5) / kOthers, across = std::sqrt(1.0 - z * z), turn = 2.39996 * i;
    all.push_back({across * std::cos(turn), across * std::sin(turn), z});
  }
  return all;
}

/// The hand's frame in the body's: y from thumb to fingers, z to where the palm is.
struct Closing {
  Matrix3 axes;
  std::vector<FingertipContact> contacts;
  double width, cost;
  double height = 0.0;  // of the fingertips above the body's centre, along z [m]
};

/// Thumb against as many of three fingers as find a surface that faces them; they press alike. Other fingers
/// that would be in the body only touch: the little one has no finger against it on the thumb's other side.
std::optional<Closing> closing(const Surface& surface, const Matrix3& axes) {
  constexpr double kFacing = 0.75;  // the least cosine of a normal and the way of closing
  const double height = std::max(0.0, surface.reach(axes.col(2)) - kUnderPalm);
  const auto hit = [&](double x, double way) {
    return surface.outermost(x * axes.col(0) + height * axes.col(2), way * axes.col(1));
  };
  const auto faces = [&](const Surface::Hit& at, double way) {
    return way * at.normal.dot(axes.col(1)) > kFacing;
  };
  const auto in_hand = [&](int finger, const Surface::Hit& at) {
    return FingertipContact{finger, axes.transpose() * at.point, axes.transpose() * at.normal, 0.0};
  };
  const auto thumb = hit(0.0, -1.0), middle = hit(0.0, 1.0);
  if (!thumb || !middle || !faces(*thumb, -1.0) || !faces(*middle, 1.0)) return std::nullopt;
  Closing found{axes, {in_hand(0, *thumb)}, axes.col(1).dot(middle->point - thumb->point), 0.0};
  if (!(found.width > 0.0)) return std::nullopt;
  std::vector<std::size_t> pressing;
  for (int finger = 1; finger <= 4; ++finger) {
    const auto at = finger == 2 ? middle : hit((finger - 2) * kSpacing, 1.0);
    if (!at) continue;
    const bool level = std::abs(axes.col(1).dot(at->point - middle->point)) < 0.01;
    if (finger < 4 && level && faces(*at, 1.0)) pressing.push_back(found.contacts.size());
    found.contacts.push_back(in_hand(finger, *at));
  }
  // The first that presses stands behind the thumb: depths of these two make up a grip.
  std::swap(found.contacts[1], found.contacts[pressing.front()]);
  pressing.front() = 1;
  const auto fingers = static_cast<double>(pressing.size());
  found.contacts[0].depth = kThumbDepth;
  for (const std::size_t contact : pressing) found.contacts[contact].depth = kThumbDepth / fingers;
  found.height = height;
  // A grip of the centre is worth more, and so is a side on which little sticks out.
  found.cost = found.width + 0.01 * (3.0 - fingers) + 0.5 * height + 0.2 * surface.reach(axes.col(2));
  return found;
}

/// All that a hand could close on, the best first: the narrowest that the palm has room for; a hand that
/// comes from above is worth 5 mm, a way along one of the body's own axes 3 mm.
std::vector<Closing> closings(const Body& body, const Surface& surface) {
  constexpr int kTurns = 12;
  const Vector3 up = body.start.orientation.conjugate() * Vector3::UnitZ();
  std::vector<Closing> all;
  int index = 0;
  for (const Vector3& along : directions()) {
    const double own = index++ < 3 ? 0.0 : 0.003;
    const Vector3 side = std::abs(along.dot(up)) < 0.9 ? Vector3((up - along.dot(up) * along).normalized())
                                                       : along.unitOrthogonal();
    for (int i = 0; i < 2 * kTurns; ++i) {
      Matrix3 axes;
      axes.col(1) = i % 2 == 0 ? along : Vector3(-along);
      const int turn = i / 2;
      axes.col(2) = Eigen::AngleAxisd(2.0 * M_PI * turn / kTurns, along) * side;
      axes.col(0) = axes.col(1).cross(axes.col(2));
      auto found = closing(surface, axes);
      if (!found) continue;
      found->cost += own - 0.005 * axes.col(2).dot(up);
      all.push_back(*found);
    }
  }
  // Costs that rounding alone tells apart are the same.
  std::stable_sort(all.begin(), all.end(), [](const Closing& one, const Closing& other) {
    return std::llround(1e8 * one.cost) < std::llround(1e8 * other.cost);
  });
  const bool any = !all.empty();
  const double narrowest = any ? all.front().width : 0.0;
  all.erase(std::remove_if(all.begin(), all.end(), [](const Closing& one) { return one.width > kWidest; }),
            all.end());
  if (!all.empty()) return all;
  throw std::invalid_argument("object '" + body.name + "' " +
                              (any ? "is " + text::number(narrowest) + " m wide on its narrowest side"
                                   : std::string("has no two sides that face away from each other")) +
                              "; allowed: an object that a hand closes on, up to " + text::number(kWidest) +
                              " m");
}

/// Whether they are much the same to a hand.
bool are_alike(const Closing& one, const Closing& other) {
  constexpr double kAlike = 0.95;  // cosine
  return one.axes.col(1).dot(other.axes.col(1)) > kAlike && one.axes.col(2).dot(other.axes.col(2)) > kAlike;
}

/// A grasp with fingertips that miss their places by `error`, in the frame of a Closing [m].
struct Fit {
  Grasp grasp;
  double error;
};

/// The wrist of a shipped grasp, moved to where all fingertips come nearest to their places. They open by
/// `share` of what the shipped one does.
Fit fit(const Closing& closing, double share) {
  std::vector<FingertipContact> pressing = closing.contacts;  // those that have to reach their places
  pressing.erase(std::remove_if(pressing.begin(), pressing.end(),
                                [](const auto& contact) { return contact.depth == 0.0; }),
                 pressing.end());
  std::optional<Fit> best;
  for (const char* like : {"cube", "long_cuboid"}) {
    Grasp grasp = shipped_grasp(like);
    if (std::string(like) == "long_cuboid") grasp = grasp.turned(turn(-90.0, Vector3::UnitY()));
    const Vector3 wrist = grasp.wrist.position + closing.height * Vector3::UnitZ();
    grasp.contacts = closing.contacts;
    grasp.opening *= share;
    for (int y = -8; y <= 8; ++y)
      for (int z = -4; z <= 8; ++z) {
        grasp.wrist.position = wrist + 0.005 * Vector3(0.0, y, z);
        double error = 0.0, of_all = 0.0, of_open = 0.0;
        const double moved = 1e-4 * std::hypot(y, z);
        if (best && moved >= best->error) continue;  // each further term adds to this one
        place_fingertips(human_hand(), grasp.wrist, pressing, -1.0, grasp.preferred, &error);
        if (best && error + moved >= best->error) continue;
        place_fingertips(human_hand(), grasp.wrist, grasp.contacts, -1.0, grasp.preferred, &of_all);
        place_fingertips(human_hand(), grasp.wrist, pressing, grasp.opening, grasp.preferred, &of_open);
        error += 0.3 * of_all + 0.2 * of_open;
        error += moved;
        if (!best || error < best->error) best = Fit{grasp, error};
      }
  }
  return *best;
}

/// A body that is in a hand's way, in its own frame.
class Obstacle {
 public:
  explicit Obstacle(const Body& body) : scene_(of(body)), geometry_(scene_) {}

  /// How far a capsule is in it; below 0: outside [m].
  double depth(const Capsule& capsule) const {
    double deepest = -1e300;
    for (std::size_t s = 0; s < scene_.bodies[0].shapes.size(); ++s) {
      const Pose& pose = scene_.bodies[0].shapes[s].pose;
      const Capsule local{pose.to_local(capsule.start), pose.to_local(capsule.end), capsule.radius};
      const ManifoldShape& shape = geometry_.shapes[0][s];
      deepest = std::max(deepest, -closest_on(shape.shape, shape.mesh, local, capsule.radius).distance);
    }
    return deepest;
  }

 private:
  static Scene of(const Body& body) {
    Scene scene;
    scene.bodies.push_back(body);
    return scene;
  }
  Scene scene_;
  SceneGeometry geometry_;
};

/// Whether fingers have room from where the palm is to where they press: not from outside of a cup to within.
bool is_open(const Closing& closing, const Obstacle& obstacle) {
  constexpr double kLength = 0.05, kRadius = 0.006, kGap = 0.002;  // of a slender finger's end [m]
  return std::none_of(closing.contacts.begin(), closing.contacts.end(), [&](const FingertipContact& contact) {
    if (contact.depth == 0.0) return false;
    const Vector3 tip = closing.axes * (contact.point + (kRadius + kGap) * contact.normal);
    return obstacle.depth({tip, tip + kLength * closing.axes.col(2), kRadius}) > 0.0;
  });
}

/// How far the hand would be in the body while it comes with open fingers, and then with more than its
/// fingertips while they touch [m]; grasp in the body's frame.
double depth_on_the_way(const Obstacle& obstacle, const Grasp& grasp) {
  constexpr double kWay = 0.15, kStep = 0.01;
  double deepest = 0.0;
  const auto look = [&](const HandPosture& posture, double off, bool tips) {
    const Pose wrist{grasp.wrist.position + off * grasp.retreat, grasp.wrist.orientation};
    const Hand hand = complete_hand(hand_joints(human_hand(), Side::right, wrist, posture), Pose{});
    for (std::size_t c = 0; c < hand.capsules.size(); ++c) {
      const bool is_tip = c % kBonesPerFinger == kBonesPerFinger - 1;
      if (hand.capsules[c].radius <= 0.0 || (is_tip && !tips)) continue;
      deepest = std::max(deepest, obstacle.depth(hand.capsules[c]));
    }
  };
  const GraspPostures postures(grasp);
  for (double off = 0.0; off <= kWay; off += kStep) look(postures.open, off, true);
  look(postures.touching, 0.0, false);
  return deepest;
}

const Body& only_free_body(const Scene& scene) {
  const Body* found = nullptr;
  int free = 0;
  for (const Body& body : scene.bodies)
    if (body.flies && !body.is_operator) found = &body, ++free;
  if (free != 1)
    throw std::invalid_argument("scene '" + scene.name + "' has " + std::to_string(free) +
                                " free objects; allowed: one, for a hand to grasp");
  return *found;
}

}  // namespace

Reach reach(const FingerSkeleton& finger, const Vector3& target, const FingerAngles& preferred) {
  constexpr int kIterations = 200;
  constexpr double kDamping = 2e-3;     // [m]
  constexpr double kLongestStep = 0.2;  // [rad]
  constexpr double kPreferenceGain = 0.2;
  FingerAngles angles = preferred.cwiseMax(finger.lower).cwiseMin(finger.upper);
  for (int i = 0; i < kIterations; ++i) {
    const Vector3 error = target - tip(finger, angles);
    const Jacobian jacobian = tip_jacobian(finger, angles, error);
    const Matrix3 damped = jacobian * jacobian.transpose() + kDamping * kDamping * Matrix3::Identity();
    const Eigen::Matrix<double, kFingerJoints, 3> inverse = jacobian.transpose() * damped.inverse();
    // The wish for the preferred posture fades so that the last iterations are for the target alone.
    const double gain = i < kIterations / 2 ? kPreferenceGain : 0.0;
    FingerAngles change =
        inverse * error + (JointMatrix::Identity() - inverse * jacobian) * (gain * (preferred - angles));
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > kLongestStep) change *= kLongestStep / largest;
    const FingerAngles next = (angles + change).cwiseMax(finger.lower).cwiseMin(finger.upper);
    // An iteration depends on the angles and the gain alone: what has converged to the bit stays so.
    if (next == angles) i = i < kIterations / 2 ? kIterations / 2 - 1 : kIterations;
    angles = next;
  }
  return {angles, (target - tip(finger, angles)).norm()};
}

HandPosture place_fingertips(const HandSkeleton& skeleton, const Pose& wrist,
                             const std::vector<FingertipContact>& contacts, double gap,
                             const HandPosture& preferred, double* worst_error) {
  HandPosture posture = within_limits(skeleton, preferred);
  double worst = 0.0;
  for (const FingertipContact& contact : contacts) {
    const FingerSkeleton& finger = skeleton.fingers[static_cast<std::size_t>(contact.finger)];
    const double height = finger.radius + (gap < 0.0 ? -contact.depth : gap);
    const Vector3 target = wrist.to_local(contact.point + height * contact.normal);
    const Reach result = reach(finger, target, preferred.col(contact.finger));
    posture.col(contact.finger) = result.angles;
    worst = std::max(worst, result.error);
  }
  if (worst_error != nullptr) *worst_error = worst;
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
  open = place_fingertips(human_hand(), grasp.wrist, grasp.contacts, grasp.opening, grasp.preferred);
  near = pressed(grasp, -kNearly / mean_depth);
  touching = pressed(grasp, 0.0);
  pressing = pressed(grasp, 1.0);
  touching_share = kNearly / (kNearly + mean_depth);
}

Grasp grasp_of(const Body& body) {
  for (const GraspEntry& entry : kGrasps)
    if (body.name == entry.name) return entry.make();
  return narrowest_grasp(body);
}

Grasp shipped_grasp(const std::string& object) {
  for (const GraspEntry& entry : kGrasps)
    if (object == entry.name) return entry.make();
  throw std::invalid_argument("no grasp of '" + object + "' is known: use one of " +
                              text::joined(text::names_of(kGrasps)));
}

GripPostures::GripPostures(const Grasp& grasp, double deepest) : deepest_(deepest) {
  double mean_share = 0.0;
  for (const FingertipContact& contact : grasp.contacts)
    mean_share += contact.depth / static_cast<double>(grasp.contacts.size());
  near_depth = -kArrived / mean_share;
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

/// The first closing whose places a hand reaches and comes to without passing through the body; of those that
/// it has to pass through, if there are no others, the one with the least of it.
Grasp narrowest_grasp(const Body& body) {
  constexpr std::size_t kMaxTried = 8;
  constexpr double kGrazes = 0.0005;  // on the way [m]
  const Obstacle obstacle(body);
  std::vector<Closing> tried;
  std::optional<Grasp> best;
  double least_error = 1e300, least_depth = 1e300;
  for (const Closing& closing : closings(body, Surface(body))) {
    const auto like_this = [&](const Closing& other) { return are_alike(closing, other); };
    if (!is_open(closing, obstacle) || std::any_of(tried.begin(), tried.end(), like_this)) continue;
    for (const double share : {1.0, 0.6, 0.3}) {
      const Fit found = fit(closing, share);
      least_error = std::min(least_error, found.error);
      if (found.error > kReached) continue;
      const Grasp grasp = found.grasp.turned(Quaternion(closing.axes));
      const double depth = depth_on_the_way(obstacle, grasp);
      if (depth < least_depth) least_depth = depth, best = grasp;
      if (depth <= kGrazes) return grasp;
    }
    tried.push_back(closing);
    if (tried.size() == kMaxTried) break;
  }
  if (best) return *best;
  throw std::invalid_argument("object '" + body.name + "': no hand reaches round it, by " +
                              text::number(least_error) + " m; allowed: an object that a hand closes on");
}

ScriptedMotion grasp_object(const Scene& scene) {
  const Body& body = only_free_body(scene);
  const Grasp grasp = narrowest_grasp(body).turned(body.start.orientation);
  constexpr double kAside = 0.15;  // further away, so that the hand passes nothing of the object [m]
  ScriptedMotion motion =
      reach_and_carry(scene.name.c_str(), grasp, body.start.position, kAside * grasp.retreat);
  motion.name = "grasp_object";
  return motion;
}

}  // namespace mrhi
