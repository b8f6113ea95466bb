#include "skin_shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rendering/skin.h"
#include "skin_parts.h"

namespace mrhi {
namespace {

constexpr double kWeb = 0.005;         // how far two fingers' skins are rounded into each other [m]
constexpr double kFlesh = 0.010;       // two parts of the palm [m]
constexpr double kForearm = 0.005;     // the palm and the forearm [m]
constexpr double kBetweenWebs = 0.92;  // of a finger's width
constexpr double kCreaseDepth = 0.0003, kNailFoldDepth = 0.0003;  // [m]
constexpr double kReliefZone = 0.003;                             // about the skin, in which folds count [m]
constexpr double kForearmWidth = 0.0250, kForearmThickness = 0.0138;  // half of each [m]
constexpr double kWristLength = 0.036;                                // of the forearm in the palm [m]
constexpr double kForearmEnd = -0.030;                                // x of the rest hand, in the sleeve [m]
constexpr double kSleeveEnd = -0.0438;                                // x of its end [m]
constexpr double kSleeveThickness = 0.0034;                           // [m]
constexpr double kHemRound = 0.0016, kEndRound = 0.008;               // over which its edges are round [m]
constexpr double kBare = 0.0008;  // above the hand, up to which the sleeve's hem has the skin's colour [m]

/// min - w h^2 / 4 with h = 1 - |a - b| / w, where that is > 0: smooth where the two meet, deepest there by w
/// / 4, and the lesser of both beyond w. Unlike a minimum it is not associative: the order of the parts is
/// part of the shape.
double smooth_min(double a, double b, double width) {
  const double overlap = std::max(0.0, 1.0 - std::abs(a - b) / width);
  return std::min(a, b) - 0.25 * width * overlap * overlap;
}

/// A cone with round ends.
struct Cone {
  Vector3 a, b;
  double at_a, at_b;  // radii [m]

  /// To the ball about the axis's nearest place. The true distance is the least for any place on the axis,
  /// and a little less on a slope.
  double distance(const Vector3& p) const {
    const Vector3 along = b - a;
    const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (p - a - t * along).norm() - (at_a + t * (at_b - at_a));
  }
};

const SkinBone& bone(int finger, int index) {
  return rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, index))];
}
Vector3 on(int finger, int index, double share) {
  const SkinBone& b = bone(finger, index);
  return b.start + share * b.length * b.axes.col(0);
}

/// A finger from its knuckle on, straight. The half on the palm's side, tip included, is the capsules'
/// surface but for the webs, between which a finger is narrower; the other half is flatter, thickest at the
/// joints. Not a true distance: y and z are drawn out to a capsule of the one radius, so that it is right in
/// sign and at 0, and roughly in between.
class Finger {
 public:
  explicit Finger(int finger) : frame_(bone(finger, 1)) {
    const double joint[] = {1.0, 0.98, 0.92}, middle[] = {0.93, 0.87, 0.86};
    double begin = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = bone(finger, static_cast<int>(i) + 1).length;
      const double narrow = i == 0 && finger > 0 ? kBetweenWebs : 1.0;
      stations_[2 * i] = {begin, joint[i], narrow};
      stations_[2 * i + 1] = {begin + 0.5 * length, middle[i], narrow};
      begin += length;
    }
    stations_[6] = {begin, 0.72, 1.0};
  }

  double distance(const Vector3& p) const {
    Vector3 q = frame_.axes.transpose() * (p - frame_.start);
    const double s = std::clamp(q.x(), 0.0, stations_[6].s);
    q.x() -= s;
    const Station here = at(s);
    q.y() /= here.side;
    if (q.z() > 0.0) q.z() /= here.back;
    return q.norm() - frame_.radius;
  }

 private:
  struct Station {
    double s;           // from the knuckle [m]
    double back, side;  // height over the bone, and half the width, of the capsule's radius
  };
  Station at(double s) const {
    std::size_t i = 1;
    while (i < 6 && s > stations_[i].s) ++i;
    const Station &a = stations_[i - 1], &b = stations_[i];
    const double t = 0.5 * (1.0 - std::cos(M_PI * (s - a.s) / (b.s - a.s)));
    return {s, a.back + t * (b.back - a.back), a.side + t * (b.side - a.side)};
  }

  SkinBone frame_;
  std::array<Station, 7> stations_;
};

/// Palm, balls of the thumb and of the little finger, knuckles and wrist, in the rest hand's frame.
std::vector<Cone> palm_cones() {
  std::vector<Cone> cones;
  const Vector3 up = Vector3::UnitZ();
  for (int f = 1; f < kFingers; ++f) {
    const double r = bone(f, 0).radius;
    cones.push_back({on(f, 0, 0.0), on(f, 0, 1.0), 0.9 * r, r});
    cones.push_back({on(f, 0, 0.35) - 0.003 * up, on(f, 0, 1.0) - 0.0025 * up, 1.05 * r, 0.97 * r});
    cones.push_back({on(f, 0, 0.97) + 0.1 * r * up, on(f, 1, 0.06) + 0.1 * r * up, 0.98 * r, 0.85 * r});
  }
  const double ball = bone(0, 1).radius;
  cones.push_back({on(0, 1, 0.1) - 0.001 * up, on(0, 1, 0.6), 1.3 * ball, 1.22 * ball});
  cones.push_back({on(0, 1, 0.25), on(1, 0, 0.45) - 0.004 * up, 1.0 * ball, 0.9 * ball});
  cones.push_back({on(0, 1, 0.6), on(1, 0, 0.7), 0.75 * ball, 0.7 * ball});
  cones.push_back({on(0, 1, 0.85), on(1, 0, 0.8), 0.5 * ball, 0.5 * ball});
  const double edge = bone(4, 0).radius;
  cones.push_back({on(4, 0, 0.1) - 0.006 * up, on(4, 0, 0.75) - 0.004 * up, 1.35 * edge, 1.15 * edge});
  return cones;
}

std::vector<Cone> web_cones() {
  std::vector<Cone> cones;
  for (int f = 1; f + 1 < kFingers; ++f) {
    const double r = bone(f, 0).radius;
    cones.push_back({on(f, 1, 0.15) - Vector3(0, 0, 0.001),
                     on(f + 1, 1, f == 3 ? 0.25 : 0.18) - Vector3(0, 0, 0.001), 0.62 * r, 0.62 * r});
  }
  return cones;
}

/// An elliptic cylinder about x that is wider than the forearm by `out`, and ends in half an ellipsoid from x
/// = `end` on.
double forearm_distance(const Vector3& p, double end, double out) {
  const double half_width = kForearmWidth + out, half_thickness = kForearmThickness + out;
  const Vector3 q(std::max(0.0, p.x() - end) * half_thickness / kWristLength,
                  p.y() * half_thickness / half_width, p.z() - 0.001);
  return q.norm() - half_thickness;
}

/// Intersection: the negative of a union of negatives.
double smooth_max(double a, double b, double width) {
  return -smooth_min(-a, -b, width);
}

/// An elliptic cylinder about the forearm.
double sleeve_distance(const Vector3& p) {
  constexpr double kUncut = 1.0;  // x of an end that is cut off [m]
  const double side = forearm_distance(p, kUncut, kSleeveThickness);
  return smooth_max(smooth_max(side, p.x() - kSleeveHem, kHemRound), kSleeveEnd - p.x(), kEndRound);
}

/// Parts are united in a fixed order.
double hand_distance(const Vector3& point) {
  static const std::vector<Cone> palm = palm_cones(), webs = web_cones();
  static const std::array<Finger, kFingers> fingers{{Finger(0), Finger(1), Finger(2), Finger(3), Finger(4)}};
  double distance = palm[0].distance(point);
  for (const Cone& cone : palm) distance = smooth_min(distance, cone.distance(point), kFlesh);
  for (const Finger& finger : fingers) distance = smooth_min(distance, finger.distance(point), kWeb);
  for (const Cone& cone : webs) distance = smooth_min(distance, cone.distance(point), kWeb);
  distance = smooth_min(distance, forearm_distance(point, 0.0, 0.0), kForearm);
  return std::max(distance, kForearmEnd - point.x());
}

}  // namespace

SkinSleeve skin_sleeve(const Vector3& point) {
  constexpr double kShade = 0.008;  // width of the sleeve's shade on the skin [m]
  if (hand_distance(point) < kBare) return {false, smooth_step(kShade, 0.0, sleeve_distance(point))};
  return {true, 0.0};
}

Vector3 onto_hem(const Vector3& point, double margin) {
  constexpr double kClear = 0.0001;  // below kBare, so that rounding does not decide what it is [m]
  const double hand = hand_distance(point), off = hand - (kBare - kClear);
  if (sleeve_distance(point) > hand || std::abs(off) >= margin) return point;
  return point - off * gradient(hand_distance, point).normalized();
}

double skin_distance(const Vector3& point) {
  return std::min(hand_distance(point), sleeve_distance(point));
}

double detailed_skin_distance(const Vector3& point) {
  const double distance = skin_distance(point);
  if (std::abs(distance) > kReliefZone) return distance;
  return distance + kCreaseDepth * skin_crease(point) + kNailFoldDepth * skin_nail(point).edge;
}

SkinBox skin_box() {
  SkinBox box{Vector3::Constant(1.0), Vector3::Constant(-1.0)};
  for (const Capsule& capsule : rest_hand().hand.capsules) {
    if (capsule.radius == 0.0) continue;
    for (const Vector3& end : {capsule.start, capsule.end}) {
      box.lowest = box.lowest.cwiseMin(end);
      box.highest = box.highest.cwiseMax(end);
    }
  }
  constexpr double kMargin = 0.022;  // thicker than any part
  box.lowest -= Vector3::Constant(kMargin);
  box.highest += Vector3::Constant(kMargin);
  box.lowest.x() = kSleeveEnd - kMargin;
  return box;
}

}  // namespace mrhi
