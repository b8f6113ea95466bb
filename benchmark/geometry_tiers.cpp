// Geometry that finger contact needs: spheres, capsules, tapered capsules and the skin itself against a box.
// A box is placed to just touch the skin of a relaxed hand; the gap of another geometry is then its error.
// Geometries alternate in one run, so that their times can be compared.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "collision/closest_features.h"
#include "modelling/skin_model.h"
#include "modelling/skin_parts.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "rendering/skin.h"

namespace mrhi {
namespace {

constexpr int kPoses = 2000, kRounds = 20;
constexpr double kTouch = 1e-6;  // largest gap that counts as contact [m]
const Box kBox{Vector3(0.025, 0.02, 0.015)};

/// Distance of a point from the box, negative inside [m].
double distance(const Vector3& point) {
  const Vector3 beyond = point.cwiseAbs() - kBox.half_extents;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

/// A capsule whose radius varies linearly between its ends.
struct TaperedCapsule {
  Vector3 start, end;
  double start_radius, end_radius;

  /// The gap is convex in s: golden-section search to 1e-6 of the length.
  double gap() const {
    constexpr double kGolden = 0.6180339887498949;
    const auto at = [this](double s) {
      return distance(start + s * (end - start)) - (start_radius + s * (end_radius - start_radius));
    };
    double low = 0.0, high = 1.0, a = 1.0 - kGolden, b = kGolden, at_a = at(a), at_b = at(b);
    while (high - low > 1e-6) {
      if (at_a < at_b) {
        high = b, b = a, at_b = at_a, a = high - kGolden * (high - low), at_a = at(a);
      } else {
        low = a, a = b, at_a = at_b, b = low + kGolden * (high - low), at_b = at(b);
      }
    }
    return std::min({at_a, at_b, at(0.0), at(1.0)});
  }
};

/// One hand in every geometry, moved into the box's frame by `place`.
struct Geometries {
  Hand hand;
  std::vector<Vector3> skin;
  std::vector<std::pair<Vector3, double>> spheres;
  std::vector<TaperedCapsule> tapered;
};

/// Mean distance from the bone's axis of the skin's vertices over one half of the bone; the tracker's radius
/// if there are none.
double skin_radius(const Capsule& bone, int capsule, bool first_half, const Skin& skin,
                   const std::vector<Vector3>& vertices) {
  const Vector3 along = bone.end - bone.start;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (capsule_shares(skin.rest()[i])[static_cast<std::size_t>(capsule)] < 0.5) continue;
    const double s = along.dot(vertices[i] - bone.start) / along.squaredNorm();
    if (s < 0.0 || s > 1.0 || (s < 0.5) != first_half) continue;
    sum += (vertices[i] - bone.axis_point(s)).norm();
    ++count;
  }
  return count > 0 ? sum / count : bone.radius;
}

Geometries resting_hand(const Skin& skin) {
  Geometries all;
  all.hand = complete_hand(hand_joints(human_hand(), Side::right, Pose{}, relaxed_posture()), Pose{});
  SkinSurface surface;
  skin.pose(all.hand, surface);
  all.skin = surface.vertices;
  for (int c = 0; c < kPhalanges; ++c) {
    if (!all.hand.has(c)) continue;
    const Capsule& bone = all.hand.capsules[static_cast<std::size_t>(c)];
    for (const double s : {0.0, 0.5, 1.0}) all.spheres.emplace_back(bone.axis_point(s), bone.radius);
    // The means over two halves belong to points a quarter from the ends.
    const double near = skin_radius(bone, c, true, skin, all.skin),
                 far = skin_radius(bone, c, false, skin, all.skin), taper = far - near;
    all.tapered.push_back({bone.start, bone.end, near - 0.5 * taper, far + 0.5 * taper});
  }
  return all;
}

/// Transforms `from` into the frame of `box`, into `to` of the same sizes.
void place(const Geometries& from, const Pose& box, Geometries& to) {
  const auto moved = [&box](const Vector3& point) { return box.to_local(point); };
  std::transform(from.skin.begin(), from.skin.end(), to.skin.begin(), moved);
  for (std::size_t i = 0; i < from.spheres.size(); ++i) to.spheres[i].first = moved(from.spheres[i].first);
  for (std::size_t i = 0; i < from.tapered.size(); ++i)
    to.tapered[i].start = moved(from.tapered[i].start), to.tapered[i].end = moved(from.tapered[i].end);
  for (std::size_t i = 0; i < kCapsules; ++i) {
    to.hand.capsules[i].start = moved(from.hand.capsules[i].start);
    to.hand.capsules[i].end = moved(from.hand.capsules[i].end);
  }
}

struct Tier {
  const char* name;
  double (*gap)(const Geometries&);
  std::vector<double> errors{};  // [m]
  double seconds = std::numeric_limits<double>::max();
};

std::vector<Tier> tiers() {
  constexpr double kFar = std::numeric_limits<double>::max();
  return {{"spheres",
           [](const Geometries& g) {
             double gap = kFar;
             for (const auto& [centre, radius] : g.spheres) gap = std::min(gap, distance(centre) - radius);
             return gap;
           }},
          {"capsules",
           [](const Geometries& g) {
             double gap = kFar;
             for (std::size_t c = 0; c < kPhalanges; ++c)
               if (g.hand.capsules[c].radius > 0.0)
                 gap = std::min(gap, capsule_box(g.hand.capsules[c], kBox).distance);
             return gap;
           }},
          {"fitted capsules",
           [](const Geometries& g) {
             double gap = kFar;
             for (const TaperedCapsule& t : g.tapered) {
               const Capsule capsule{t.start, t.end, 0.5 * (t.start_radius + t.end_radius)};
               gap = std::min(gap, capsule_box(capsule, kBox).distance);
             }
             return gap;
           }},
          {"tapered capsules",
           [](const Geometries& g) {
             double gap = kFar;
             for (const TaperedCapsule& capsule : g.tapered) gap = std::min(gap, capsule.gap());
             return gap;
           }},
          {"skin", [](const Geometries& g) {
             double gap = kFar;
             for (const Vector3& vertex : g.skin) gap = std::min(gap, distance(vertex));
             return gap;
           }}};
}

struct Touch {
  double gap;  // [m]
  std::size_t vertex;
};

Touch nearest(const std::vector<Vector3>& skin) {
  Touch touch{std::numeric_limits<double>::max(), 0};
  for (std::size_t i = 0; i < skin.size(); ++i) {
    const double gap = distance(skin[i]);
    if (gap < touch.gap) touch = {gap, i};
  }
  return touch;
}

/// Random poses of the box, at which it just touches the skin of a finger's two distal bones: on the palm's
/// side if `inside`.
std::vector<Pose> touching_poses(const Geometries& rest, const Skin& skin, bool inside) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto part = [&] { return uniform(random); };
  std::vector<Pose> poses;
  Geometries placed = rest;
  while (poses.size() < kPoses) {
    const int finger = static_cast<int>(poses.size() % kFingers), bone = part() < 0.0 ? 2 : 3;
    const int capsule = capsule_index(finger, bone);
    const Vector3 from = Vector3(part(), part(), part()).normalized();
    if ((from.z() < 0.0) != inside) continue;
    const Capsule& aim = rest.hand.capsules[static_cast<std::size_t>(capsule)];
    Pose pose{aim.axis_point(0.5 + 0.5 * part()) + 0.15 * from,
              Quaternion(part(), part(), part(), part()).normalized()};
    Touch touch{1.0, 0};
    for (int i = 0; i < 100 && touch.gap > kTouch; ++i) {
      place(rest, pose, placed);
      touch = nearest(placed.skin);
      pose.position -= touch.gap * from;  // never beyond first touch
    }
    if (std::abs(touch.gap) <= kTouch &&
        capsule_shares(skin.rest()[touch.vertex])[static_cast<std::size_t>(capsule)] > 0.5)
      poses.push_back(pose);
  }
  return poses;
}

void compare(const Geometries& rest, const Skin& skin, bool inside) {
  std::vector<Tier> all = tiers();
  Geometries placed = rest;
  for (const Pose& pose : touching_poses(rest, skin, inside)) {
    place(rest, pose, placed);
    for (Tier& tier : all) {
      tier.errors.push_back(tier.gap(placed));
      for (int round = 0; round < kRounds; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        volatile double gap = tier.gap(placed);
        (void)gap;
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        tier.seconds = std::min(tier.seconds, took.count());
      }
    }
  }
  std::printf("\nbox from the %s\n%-18s %9s %9s %9s %9s\n", inside ? "palm's side" : "back", "geometry",
              "rms mm", "mean mm", "max mm", "us");
  for (const Tier& tier : all) {
    double squares = 0.0, sum = 0.0, largest = 0.0;
    for (const double error : tier.errors)
      squares += error * error, sum += error, largest = std::max(largest, std::abs(error));
    const auto n = static_cast<double>(tier.errors.size());
    std::printf("%-18s %9.3f %9.3f %9.3f %9.3f\n", tier.name, 1e3 * std::sqrt(squares / n), 1e3 * sum / n,
                1e3 * largest, 1e6 * tier.seconds);
  }
}

}  // namespace
}  // namespace mrhi

int main() {
  const mrhi::Skin skin(mrhi::skinned(mrhi::finest_skin(false), false));  // finer than the rendered one
  const mrhi::Geometries rest = mrhi::resting_hand(skin);
  std::printf(
      "%d poses each; all fingers against one box; smallest of %d times, all geometries by turns; "
      "a skin of %zu vertices\n",
      mrhi::kPoses, mrhi::kRounds, skin.size());
  for (const bool inside : {true, false}) mrhi::compare(rest, skin, inside);
  return 0;
}
