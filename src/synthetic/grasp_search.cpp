#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "../collision/scene_geometry.h"
#include "../scene/solid_mesh.h"
#include "../text/text.h"
#include "motions.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

/// Search for a grasp of any object: places where two opposite surfaces are near enough for thumb and
/// fingers, the hand's direction round each of them, and a wrist from which all fingertips reach.
namespace mrhi {
namespace {

constexpr double kMaxWidth = 0.09;         // between thumb and fingers [m]
constexpr double kFingerSpacing = 0.0175;  // between fingertips side by side [m]
constexpr double kMinFacing = 0.75;        // cosine of a surface's normal and the closing direction
/// What is higher above the fingertips than this is in the palm's way [m].
constexpr double kPalmHeight = 0.045;

/// Part of a line that is within the body: where it enters and leaves, with outward normals.
struct Chord {
  double begin, end;  ///< [m] along the line
  Vector3 begin_normal, end_normal;
};

/// A body's surface, body frame.
class Surface {
 public:
  explicit Surface(const Body& body) {
    TriangleMesh all;
    for (const PlacedShape& shape : body.shapes) {
      const TriangleMesh mesh = surface_of(shape);
      all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
      for (const auto& triangle : mesh.triangles) {
        const auto corner = [&](int i) { return mesh.vertices[triangle[i]]; };
        const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        if (normal.norm() > 0.0) triangles_.push_back({corner(0), corner(1), corner(2), normal});
      }
    }
    hull_ = convex_hull(all).vertices;
  }

  /// The parts of the line through `at` along the unit vector `direction` that are within the body, in order.
  std::vector<Chord> along(Vector3 at, const Vector3& direction) const {
    at += Vector3(1.3e-6, 0.7e-6, 1.1e-6);  // past the edges of symmetric meshes
    std::vector<Crossing> crossings;
    for (const Triangle& triangle : triangles_) {
      const double rate = triangle.normal.dot(direction);
      if (std::abs(rate) <= 1e-12 * triangle.normal.norm()) continue;
      const double distance = triangle.normal.dot(triangle.a - at) / rate;
      const Vector3 from_a = at + distance * direction - triangle.a;
      const double v = from_a.cross(triangle.c - triangle.a).dot(triangle.normal),
                   w = (triangle.b - triangle.a).cross(from_a).dot(triangle.normal);
      if (v >= 0.0 && w >= 0.0 && v + w <= triangle.normal.squaredNorm())
        crossings.push_back({distance, triangle.normal.normalized(), rate < 0.0 ? 1 : -1});
    }
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& one, const Crossing& other) { return one.distance < other.distance; });
    std::vector<Chord> chords;
    int depth = 0;  // of solids that overlap
    for (const Crossing& crossing : crossings) {
      const int before = depth;
      depth += crossing.step;
      if (before == 0 && depth == 1) chords.push_back({crossing.distance, 0.0, crossing.normal, {}});
      if (before == 1 && depth == 0)
        chords.back().end = crossing.distance, chords.back().end_normal = crossing.normal;
    }
    return depth == 0 ? chords : std::vector<Chord>();
  }

  struct Sample {
    Vector3 point, normal;
  };
  /// Points spread evenly over the surface: of equal area each, by the R2 sequence within their triangles.
  std::vector<Sample> samples(int number) const {
    double area = 0.0, passed = 0.0;
    for (const Triangle& triangle : triangles_) area += triangle.normal.norm();
    std::vector<Sample> all;
    for (const Triangle& triangle : triangles_) {
      passed += triangle.normal.norm();
      while (all.size() < std::size_t(number) && (double(all.size()) + 0.5) * area <= passed * number) {
        const double i = double(all.size());
        double u = std::fmod(0.5 + 0.7548776662 * i, 1.0), v = std::fmod(0.5 + 0.5698402910 * i, 1.0);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        all.push_back({triangle.a + u * (triangle.b - triangle.a) + v * (triangle.c - triangle.a),
                       triangle.normal.normalized()});
      }
    }
    return all;
  }

  /// How far the body extends from a point along a unit vector [m].
  double height(const Vector3& from, const Vector3& direction) const {
    double farthest = -1e300;
    for (const Vector3& corner : hull_) farthest = std::max(farthest, direction.dot(corner - from));
    return farthest;
  }

 private:
  struct Triangle {
    Vector3 a, b, c, normal;  ///< normal: not a unit vector
  };
  struct Crossing {
    double distance;
    Vector3 normal;
    int step;  ///< 1: into a solid, -1: out of it
  };
  std::vector<Triangle> triangles_;
  std::vector<Vector3> hull_;
};

/// A place between two opposite surfaces.
struct Place {
  Vector3 centre, axis;  ///< midway; unit, from one surface to the other
  double width, cost;
};

/// Costs that differ by rounding alone are equal.
template <class Costly>
void sort_by_cost(std::vector<Costly>& all) {
  std::stable_sort(all.begin(), all.end(), [](const Costly& one, const Costly& other) {
    return std::llround(1e8 * one.cost) < std::llround(1e8 * other.cost);
  });
}

/// Directions across the centre: the body's axes and a Fibonacci lattice.
std::vector<Vector3> lattice() {
  constexpr int kOthers = 40;
  std::vector<Vector3> all{Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  for (int i = 0; i < kOthers; ++i) {
    const double z = (i + 0.5) / kOthers, across = std::sqrt(1.0 - z * z), angle = 2.39996 * i;
    all.push_back({across * std::cos(angle), across * std::sin(angle), z});
  }
  return all;
}

/// All different places on the body, the best first: narrow ones near the centre of mass. `narrowest` becomes
/// the least width of all pairs of opposite surfaces, also if that is more than kMaxWidth.
std::vector<Place> find_places(const Surface& surface, double& narrowest) {
  constexpr int kSamples = 400;
  constexpr double kLeverCost = 0.3, kObliqueCost = 0.003, kAlikeDistance = 0.012, kAlikeAxis = 0.95;
  std::vector<Place> all;
  const auto add = [&](const Vector3& at, const Vector3& axis, double extra, bool through_at) {
    const std::vector<Chord> chords = surface.along(at, axis);
    for (std::size_t i = 0; i < chords.size(); ++i)
      for (std::size_t j = i; j < chords.size(); ++j) {
        const double begin = chords[i].begin, end = chords[j].end, width = end - begin;
        const bool faces =
            -chords[i].begin_normal.dot(axis) > kMinFacing && chords[j].end_normal.dot(axis) > kMinFacing;
        if (!faces || (through_at && std::min(std::abs(begin), std::abs(end)) > 1e-4)) continue;
        narrowest = std::min(narrowest, width);
        if (width > kMaxWidth) continue;
        const Vector3 centre = at + 0.5 * (begin + end) * axis;
        const double lever = (centre - centre.dot(axis) * axis).norm();  // of the weight
        all.push_back({centre, axis, width, width + kLeverCost * lever + extra});
      }
  };
  int index = 0;
  for (const Vector3& axis : lattice()) add(Vector3::Zero(), axis, index++ < 3 ? 0.0 : kObliqueCost, false);
  for (const Surface::Sample& sample : surface.samples(kSamples))
    add(sample.point, sample.normal, kObliqueCost, true);
  sort_by_cost(all);
  std::vector<Place> different;
  for (const Place& place : all) {
    const auto is_alike = [&](const Place& other) {
      return (place.centre - other.centre).norm() < kAlikeDistance &&
             std::abs(place.axis.dot(other.axis)) > kAlikeAxis && std::abs(place.width - other.width) < 0.005;
    };
    if (std::none_of(different.begin(), different.end(), is_alike)) different.push_back(place);
  }
  return different;
}

/// The body as something in the hand's way, body frame.
class Obstacle {
 public:
  explicit Obstacle(const Body& body) : scene_(scene_of(body)), geometry_(scene_) {}

  /// Penetration of a capsule; negative if it does not touch [m].
  double depth(const Capsule& capsule) const {
    double deepest = -1e300;
    for (std::size_t s = 0; s < scene_.bodies[0].shapes.size(); ++s) {
      const Pose& pose = scene_.bodies[0].shapes[s].pose;
      const Capsule local{pose.to_local(capsule.start), pose.to_local(capsule.end), capsule.radius};
      const auto features = geometry_.colliders[0][s].closest(local, capsule.radius);
      if (features) deepest = std::max(deepest, -features->distance);
    }
    return deepest;
  }

 private:
  static Scene scene_of(const Body& body) {
    Scene scene;
    scene.bodies.push_back(body);
    return scene;
  }
  Scene scene_;
  SceneGeometry geometry_;
};

/// Whether the end of a slender finger on each side of a place has space in the palm's direction.
bool is_open(const Place& place, const Vector3& palm, const Obstacle& obstacle) {
  constexpr double kLength = 0.05, kRadius = 0.006, kGap = 0.002;  // [m]
  for (const double side : {-1.0, 1.0}) {
    const Vector3 tip = place.centre + side * (0.5 * place.width + kRadius + kGap) * place.axis;
    if (obstacle.depth({tip, tip + kLength * palm, kRadius}) > 0.0) return false;
  }
  return true;
}

/// A place and where the palm is then, as a unit vector from it.
struct Option {
  std::size_t place;
  Vector3 palm;
  double cost;
};

/// All that are open, the best first: little rises from the place to the palm, and a hand that comes from
/// above is worth 5 mm.
std::vector<Option> find_options(const Surface& surface, const std::vector<Place>& places, const Vector3& up,
                                 const Obstacle& obstacle) {
  constexpr int kTurns = 12;
  constexpr double kHeightCost = 0.4, kPalmCost = 0.5, kAbove = 0.005;
  std::vector<Option> all;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Place& place = places[p];
    const Vector3 first = std::abs(place.axis.dot(up)) < 0.9
                              ? Vector3((up - place.axis.dot(up) * place.axis).normalized())
                              : place.axis.unitOrthogonal();
    for (int i = 0; i < kTurns; ++i) {
      const Vector3 palm = Eigen::AngleAxisd(2.0 * M_PI * i / kTurns, place.axis) * first;
      if (!is_open(place, palm, obstacle)) continue;
      const double height = surface.height(place.centre, palm);
      all.push_back({p, palm,
                     place.cost + kHeightCost * height + kPalmCost * std::max(0.0, height - kPalmHeight) -
                         kAbove * palm.dot(up)});
    }
  }
  sort_by_cost(all);
  return all;
}

/// Where the fingertips of a hand that closes on a place are, in the hand's axes about the place's centre:
/// y from thumb to fingers, z to the palm.
struct Closing {
  Vector3 centre;
  Matrix3 axes;
  std::vector<FingertipContact> contacts;
};

/// The thumb opposes as many of three fingers as find a surface on its other side; they share its depth. The
/// little finger only touches: it has no thumb opposite it.
std::optional<Closing> make_closing(const Surface& surface, const Place& place, const Vector3& palm,
                                    double sign) {
  constexpr double kThumbDepth = 0.006, kLevel = 0.01;  // [m]; level: of fingertips side by side
  Matrix3 axes;
  axes.col(1) = sign * place.axis;
  axes.col(2) = palm;
  axes.col(0) = axes.col(1).cross(axes.col(2));
  const Vector3 y = axes.col(1);
  const auto contact = [&](int finger, double along, double depth, const Vector3& normal) {
    return FingertipContact{finger,
                            {(finger == 0 ? 0 : finger - 2) * kFingerSpacing, along, 0.0},
                            axes.transpose() * normal,
                            depth};
  };
  Closing closing{place.centre, axes, {}};
  std::vector<FingertipContact> touching;
  for (int finger = 0; finger <= 4; ++finger) {
    const double side = finger == 0 ? -1.0 : 1.0, level = 0.5 * place.width;
    const double x = finger == 0 ? 0.0 : (finger - 2) * kFingerSpacing;
    for (const Chord& chord : surface.along(place.centre + x * axes.col(0), y)) {
      const double along = finger == 0 ? chord.begin : chord.end;
      const Vector3& normal = finger == 0 ? chord.begin_normal : chord.end_normal;
      if (std::abs(side * along - level) > kLevel) continue;
      const bool opposes = side * normal.dot(y) > kMinFacing && finger < 4;
      (opposes ? closing.contacts : touching).push_back(contact(finger, along, kThumbDepth, normal));
      break;
    }
  }
  const auto is_middle = [](const FingertipContact& at) { return at.finger == 2; };
  const auto middle = std::find_if(closing.contacts.begin(), closing.contacts.end(), is_middle);
  if (middle == closing.contacts.end() || closing.contacts[0].finger != 0) return std::nullopt;
  std::rotate(closing.contacts.begin() + 1, middle, middle + 1);  // the first two make up a grip
  const double fingers = double(closing.contacts.size()) - 1.0;
  for (FingertipContact& at : closing.contacts)
    if (at.finger != 0) at.depth = kThumbDepth / fingers;
  for (FingertipContact& at : touching) at.depth = 0.0, closing.contacts.push_back(at);
  return closing;
}

/// How far fingertips stay from their contacts [m].
struct Misses {
  double loaded, any;
};

Misses misses(Grasp grasp, double gap) {
  constexpr int kIterations = 24;  // a tenth of what places them: the error alone matters
  grasp.preferred = within_limits(human_hand(), grasp.preferred);
  Misses worst{0.0, 0.0};
  for (const FingertipContact& contact : grasp.contacts) {
    const double error = grasp.solve_contact(contact, gap, kIterations).error;
    worst.any = std::max(worst.any, error);
    if (contact.depth > 0.0) worst.loaded = std::max(worst.loaded, error);
  }
  return worst;
}

/// A grasp in the axes of a Closing, and how much its fingertips miss their contacts [m].
struct GraspFit {
  Grasp grasp;
  double error;
};

/// The wrist of a shipped grasp, moved to where the fingertips come nearest to their contacts.
GraspFit fit(const Closing& closing) {
  constexpr double kFirstStep = 0.02, kLastStep = 0.0025, kMoveCost = 0.02;
  std::optional<GraspFit> best;
  for (const char* like : {"cube", "long_cuboid"}) {
    Grasp grasp = shipped_grasp(like);
    if (std::string(like) == "long_cuboid") grasp = grasp.turned(turn(-90.0, Vector3::UnitY()));
    const Vector3 wrist = grasp.wrist.position;
    grasp.contacts = closing.contacts;
    const auto error_at = [&](double y, double z) {
      grasp.wrist.position = wrist + Vector3(0.0, y, z);
      const Misses closed = misses(grasp, -1.0), open = misses(grasp, 0.5 * grasp.opening);
      return closed.loaded + 0.3 * closed.any + 0.2 * open.loaded + kMoveCost * std::hypot(y, z);
    };
    double y = 0.0, z = 0.0, least = error_at(y, z);
    for (double step = kFirstStep; step >= kLastStep;) {
      const double from_y = y, from_z = z;
      for (const int dy : {-1, 0, 1})
        for (const int dz : {-1, 0, 1}) {
          const double error = dy == 0 && dz == 0 ? least : error_at(from_y + dy * step, from_z + dz * step);
          if (error < least) least = error, y = from_y + dy * step, z = from_z + dz * step;
        }
      if (y == from_y && z == from_z) step *= 0.5;
    }
    grasp.wrist.position = wrist + Vector3(0.0, y, z);
    if (!best || least < best->error) best = GraspFit{grasp, least};
  }
  return *best;
}

/// Largest penetration of the hand on its way to the object with open fingers, and of all but its fingertips
/// while they touch [m]; grasp in the body's frame.
double approach_depth(const Obstacle& obstacle, const Grasp& grasp) {
  constexpr double kDistance = 0.15, kStep = 0.01;
  double deepest = 0.0;
  const auto add = [&](const HandPosture& posture, double distance, bool tips) {
    const Pose wrist{grasp.wrist.position + distance * grasp.retreat, grasp.wrist.orientation};
    const Hand hand = complete_hand(hand_joints(human_hand(), Side::right, wrist, posture), Pose{});
    for (std::size_t c = 0; c < hand.capsules.size(); ++c) {
      const bool is_tip = c % kBonesPerFinger == kBonesPerFinger - 1;
      if (hand.capsules[c].radius <= 0.0 || (is_tip && !tips)) continue;
      deepest = std::max(deepest, obstacle.depth(hand.capsules[c]));
    }
  };
  const GraspPostures postures(grasp);
  for (double distance = 0.0; distance <= kDistance; distance += kStep) add(postures.open, distance, true);
  add(postures.touching, 0.0, false);
  return deepest;
}

/// In the body's frame.
Grasp placed(Grasp grasp, const Closing& closing) {
  grasp = grasp.turned(Quaternion(closing.axes));
  grasp.wrist.position += closing.centre;
  for (FingertipContact& contact : grasp.contacts) contact.point += closing.centre;
  return grasp;
}

/// The first grasp that a hand reaches without passing through the body and that `holds`; if there is none,
/// the first that holds of those with the least penetration on the way.
std::optional<Grasp> find_grasp(const Surface& surface, const std::vector<Place>& places,
                                const std::vector<Option>& options, const Obstacle& obstacle,
                                const std::function<bool(const Grasp&)>& holds) {
  constexpr std::size_t kMaxTried = 40;
  constexpr double kMaxError = 0.006, kMaxGrazeDepth = 0.0005, kMaxDepth = 0.006;  // [m]
  constexpr double kSimilarPalm = 0.8;            // cosine of two palm directions
  std::vector<std::pair<double, Grasp>> grazing;  // by depth
  std::vector<Option> tried;
  for (const Option& option : options) {
    const auto is_alike = [&](const Option& other) {
      return option.place == other.place && option.palm.dot(other.palm) > kSimilarPalm;
    };
    if (std::any_of(tried.begin(), tried.end(), is_alike)) continue;
    tried.push_back(option);
    if (tried.size() > kMaxTried) break;
    for (const double sign : {1.0, -1.0}) {
      const auto closing = make_closing(surface, places[option.place], option.palm, sign);
      if (!closing) continue;
      const GraspFit found = fit(*closing);
      if (found.error > kMaxError) continue;
      for (const double opening : {1.0, 0.6, 0.3}) {
        Grasp grasp = placed(found.grasp, *closing);
        grasp.opening *= opening;
        const double depth = approach_depth(obstacle, grasp);
        if (depth <= kMaxDepth && depth > kMaxGrazeDepth) grazing.emplace_back(depth, grasp);
        if (depth > kMaxGrazeDepth) continue;
        if (holds(grasp)) return grasp;
        break;
      }
    }
  }
  std::stable_sort(grazing.begin(), grazing.end(),
                   [](const auto& one, const auto& other) { return one.first < other.first; });
  for (const auto& [depth, grasp] : grazing)
    if (holds(grasp)) return grasp;
  return std::nullopt;
}

Grasp find_grasp(const Body& body, const std::function<bool(const Grasp&)>& holds) {
  const Surface surface(body);
  double narrowest = 1e300;
  const std::vector<Place> places = find_places(surface, narrowest);
  const std::string object = "object '" + body.name + "'",
                    allowed = "; allowed: an object with two opposite sides up to " +
                              text::number(kMaxWidth) + " m apart that a hand reaches";
  if (places.empty())
    throw std::invalid_argument(object +
                                (narrowest < 1e300
                                     ? " is " + text::number(narrowest) + " m wide on its narrowest side"
                                     : std::string(" has no two opposite sides")) +
                                allowed);
  const Obstacle obstacle(body);
  const Vector3 up = body.start.orientation.conjugate() * Vector3::UnitZ();
  const std::vector<Option> options = find_options(surface, places, up, obstacle);
  if (const auto grasp = find_grasp(surface, places, options, obstacle, holds)) return *grasp;
  throw std::invalid_argument(object + ": no grasp of the scripted hand holds it" + allowed);
}

std::size_t only_free_body(const Scene& scene) {
  std::vector<std::size_t> found;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].flies && !scene.bodies[b].is_operator) found.push_back(b);
  if (found.size() != 1)
    throw std::invalid_argument("scene '" + scene.name + "' has " + std::to_string(found.size()) +
                                " free objects; allowed: one, for a hand to grasp");
  return found[0];
}

ScriptedMotion motion_of(const Scene& scene, const Body& body, const Grasp& in_body) {
  const Grasp grasp = in_body.turned(body.start.orientation);
  constexpr double kStartOffset = 0.15;  // farther away, so that the hand does not pass the object [m]
  ScriptedMotion motion =
      reach_and_carry(scene.name.c_str(), grasp, body.start.position, kStartOffset * grasp.retreat);
  motion.name = "grasp_object";
  return motion;
}

/// Whether a simulated hand holds the object when the motion opens the hand again, having carried it.
bool holds(const Scene& scene, std::size_t body, const ScriptedMotion& motion) {
  constexpr double kMinCarried = 0.06;  // of 0.08 [m]
  const double opens = motion.keyframes.at(motion.keyframes.size() - 5).time;
  Simulation simulation(scene, Configuration());
  for (const JointsFrame& joints : record_motion({}, motion)) {
    if (to_seconds(joints.stamp) > opens) break;
    HandFrame frame{joints.stamp, {}};
    for (const HandJoints& hand : joints.hands)
      frame.hands.push_back(complete_hand(hand, default_device_mount()));
    simulation.advance(frame);
  }
  const SimulationState& state = simulation.state();
  return is_held(body, state) &&
         (state.bodies[body].pose.position - scene.bodies[body].start.position).norm() > kMinCarried;
}

}  // namespace

Grasp find_grasp(const Body& body) {
  return find_grasp(body, [](const Grasp&) { return true; });
}

ScriptedMotion grasp_object(const Scene& scene) {
  const std::size_t index = only_free_body(scene);
  const Body& body = scene.bodies[index];
  return motion_of(scene, body, find_grasp(body, [&](const Grasp& grasp) {
                     return holds(scene, index, motion_of(scene, body, grasp));
                   }));
}

}  // namespace mrhi
