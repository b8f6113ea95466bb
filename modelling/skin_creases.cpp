#include <algorithm>
#include <cmath>

#include "skin_parts.h"

namespace mrhi {
namespace {

constexpr double kHalfWidth = 0.0009;  // of a crease [m]

// A crease is a curve on the rest hand's skin: where `beyond` changes its sign, as deep as `depth` says, 0
// to 1.

/// Straight across a finger, on the side of the palm.
struct FingerCrease {
  const SkinBone& bone;
  double at;  // along the bone [m]

  Vector3 on_bone(const Vector3& vertex) const { return bone.axes.transpose() * (vertex - bone.start); }
  double beyond(const Vector3& vertex) const { return on_bone(vertex).x() - at; }
  double depth(const Vector3& vertex) const {
    const Vector3 place = on_bone(vertex);
    if (std::hypot(place.y(), place.z()) > 1.3 * bone.radius) return 0.0;
    return smooth_step(1.4, 0.6, std::abs(std::atan2(place.y(), -place.z())));
  }
};

/// In the palm, part of the circle through three places, x to the fingers, y to the thumb [m].
class PalmCrease {
 public:
  PalmCrease(const Eigen::Vector2d& begin, const Eigen::Vector2d& on_the_way, const Eigen::Vector2d& end) {
    // |c - p|^2 is the same for all three: 2 (p - q) . c = p^2 - q^2.
    Eigen::Matrix2d sides;
    sides << (begin - on_the_way).transpose(), (end - on_the_way).transpose();
    const Eigen::Vector2d squares(begin.squaredNorm() - on_the_way.squaredNorm(),
                                  end.squaredNorm() - on_the_way.squaredNorm());
    centre_ = 0.5 * sides.inverse() * squares;
    radius_ = (begin - centre_).norm();
    middle_ = (on_the_way - centre_) / radius_;
    reach_ = std::max(turned(begin), turned(end));
  }

  double beyond(const Vector3& vertex) const { return (vertex.head<2>() - centre_).norm() - radius_; }
  double depth(const Vector3& vertex) const {
    return smooth_step(reach_, 0.6 * reach_, turned(vertex.head<2>())) *
           smooth_step(0.002, -0.004, vertex.z());
  }

 private:
  /// About the centre, away from the place on the way [rad].
  double turned(const Eigen::Vector2d& place) const {
    return std::acos(std::clamp((place - centre_).normalized().dot(middle_), -1.0, 1.0));
  }
  Eigen::Vector2d centre_, middle_;
  double radius_ = 0.0, reach_ = 0.0;
};

struct Creases {
  std::vector<FingerCrease> fingers;
  std::vector<PalmCrease> palm;
};

Creases make_creases() {
  Creases creases;
  constexpr double kBase = 0.42;  // of a finger's first bone: where it leaves the palm
  for (int finger = 0; finger < kFingers; ++finger) {
    for (int b = finger == 0 ? 2 : 1; b < kBonesPerFinger; ++b) {
      const SkinBone& bone = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, b))];
      creases.fingers.push_back({bone, b == 1 ? kBase * bone.length : 0.0});
    }
  }
  creases.palm.push_back({{0.052, -0.038}, {0.060, -0.008}, {0.079, 0.015}});
  creases.palm.push_back({{0.056, 0.037}, {0.049, 0.008}, {0.033, -0.025}});
  creases.palm.push_back({{0.056, 0.037}, {0.036, 0.015}, {0.008, 0.006}});
  return creases;
}

const Creases& all_creases() {
  static const Creases creases = make_creases();
  return creases;
}

/// Calls `visit(beyond, depth)` for each crease that passes within `margin` of the vertex.
template <typename Visit>
void for_each_near(const Vector3& vertex, double margin, const Visit& visit) {
  const auto look = [&](const auto& crease) {
    const double beyond = crease.beyond(vertex);
    if (std::abs(beyond) >= margin) return;
    const double depth = crease.depth(vertex);
    if (depth > 0.0) visit(crease, beyond, depth);
  };
  for (const FingerCrease& crease : all_creases().fingers) look(crease);
  for (const PalmCrease& crease : all_creases().palm) look(crease);
}

}  // namespace

double skin_crease(const Vector3& vertex) {
  double deepest = 0.0;
  for_each_near(vertex, kHalfWidth, [&](const auto&, double beyond, double depth) {
    deepest = std::max(deepest, depth * smooth_step(kHalfWidth, 0.0, std::abs(beyond)));
  });
  return deepest;
}

Vector3 onto_crease(const Vector3& vertex, double margin) {
  Vector3 place = vertex;
  for_each_near(vertex, margin, [&](const auto& crease, double beyond, double) {
    place = vertex - beyond * gradient([&](const Vector3& p) { return crease.beyond(p); }, vertex);
  });
  return place;
}

}  // namespace mrhi
