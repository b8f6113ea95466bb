#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/hand_track.h"
#include "step_motion.h"

namespace mrhi {

/// Box along the body's axes around all its shapes, body frame [m].
Eigen::AlignedBox3d box_around(const Body& body);

/// Axis-aligned box around a hand in world; empty without capsules [m].
Eigen::AlignedBox3d box_around(const Hand& hand);

/// True if a ball may touch the box.
inline bool is_near(const Eigen::AlignedBox3d& box, const Vector3& centre, double radius) {
  return box.squaredExteriorDistance(centre) <= radius * radius;
}

/// Indices, ascending, of all bodies, fixtures too, that may be nearer to the hand than `margin` [m].
std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin);

/// Tree of the axis-aligned boxes of bodies' spheres; finds those that a box touches. A cache of the state,
/// not part of it.
class BroadPhase {
 public:
  explicit BroadPhase(std::size_t bodies);
  ~BroadPhase();
  BroadPhase(BroadPhase&&) noexcept;

  /// Places body `index` as a sphere about `centre` [m]. A body never placed is never found. Allocates the
  /// first time only.
  void update(int index, const Vector3& centre, double radius);
  /// Indices, ascending, of bodies whose box touches min..max. Valid until the next call.
  const std::vector<int>& query(const Vector3& min, const Vector3& max);
  /// All pairs whose spheres touch, the smaller index first, in no order. Valid until the next call.
  const std::vector<std::pair<int, int>>& pairs();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A body and the capsules of a hand that may come near it in this frame, ascending.
struct NearBody {
  int body;
  int count = 0;
  Pose pose;  ///< of the body as they were listed
  std::array<std::uint8_t, kCapsules> capsules;
  /// Lower bound of each capsule's distance from the body in this frame, at that pose; < 0: may touch [m].
  std::array<double, kCapsules> clearances;

  void add(int capsule, double clearance) {
    capsules[count] = static_cast<std::uint8_t>(capsule);
    clearances[count++] = clearance;
  }
  /// Upper bound of the displacement of the body's points within `radius` of its origin [m]. A rotation by
  /// theta moves them by 2 radius sin(theta / 2); the quaternions are 2 sin(theta / 4) >= sin(theta / 2)
  /// apart, or more.
  double moved(const Pose& now, double radius) const {
    return (now.position - pose.position).norm() +
           2.0 * radius * (now.orientation.coeffs() - pose.orientation.coeffs()).norm();
  }
  const std::uint8_t* begin() const { return capsules.data(); }
  const std::uint8_t* end() const { return capsules.data() + count; }
};

/// The frame in which a hand is tracked, halfway through a frame of input.
struct CarriedFrame {
  CarrierMotion motion;  ///< at the start, but with the origin halfway
  double seconds;        ///< of the frame of input
  double margin;         ///< largest distance of what the carrier does from that [m]
};

/// Broad phase: lists the pairs of bodies, and of hands and bodies, that may touch. Each body has a sphere
/// with a margin (Verlet list: Verlet 1967); the lists are updated when a body is about to leave its sphere.
/// A cache of the state, not part of it: it may list more pairs than needed, never fewer.
class Neighbours {
 public:
  explicit Neighbours(const Scene& scene);  ///< keeps a reference

  /// Call once a frame, with the hands' paths in it. `carried`: by slot, null for a hand tracked in world.
  using Carried = std::array<const CarriedFrame*, kMaxHands>;
  void begin_frame(const std::vector<HandTrack>& hands, const std::vector<BodyState>& bodies,
                   const Carried& carried = {});
  /// Call for every step of `step` seconds.
  void begin_step(const std::vector<BodyState>& bodies, double step);

  /// True if a body may come near a hand of this frame, or two bodies near each other, within `seconds`.
  bool may_meet_hand(std::size_t body, const BodyState& state, double seconds) const;
  bool may_meet(std::size_t a, std::size_t b, const std::vector<BodyState>& bodies, double seconds) const;

  /// Bodies near the hand in `slot`, ascending.
  const std::vector<NearBody>& near_hand(int slot) const { return near_hand_[slot]; }
  /// Pairs of bodies near each other, sorted. The first is a fixture or precedes the second, which is free.
  const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }
  /// Bodies that are in any of the pairs.
  const std::vector<int>& paired() const { return paired_; }

 private:
  struct PaddedSphere {
    Vector3 centre = Vector3::Zero();
    double padding_squared = -1.0;  // of the distance that the body may move from there [m^2]
    double radius = 0.0;            // of the sphere that holds the body and the gap that is followed [m]
  };
  /// A capsule's axis halfway through the frame, and how far from it the capsule reaches in the frame.
  struct CapsulePath {
    bool comes_near(const Vector3& centre, double radius) const;
    double clearance(const Eigen::AlignedBox3d& box, const Pose& pose, const Matrix3& rotation) const;

    int capsule;
    Vector3 start, along;
    double reach;
  };
  struct HandPaths {
    Eigen::AlignedBox3d box;  // of a hand in this frame; empty without a hand
    std::vector<CapsulePath> paths;
  };
  static void measure(const HandTrack& hand, const CarriedFrame* carried, HandPaths& reach);
  /// Radius that the body and the followed gap do not leave within `seconds`, about its position now.
  double reach_of(std::size_t body, const BodyState& state, double seconds) const;
  bool place_those_leaving(const std::vector<BodyState>& bodies, double step);
  void list_near_hands(const std::vector<BodyState>& bodies);
  void list_pairs();

  const Scene& scene_;
  BroadPhase broad_phase_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<PaddedSphere> padded_;
  std::vector<HandPaths> hand_paths_;
  std::vector<std::vector<NearBody>> near_hand_;
  std::vector<std::pair<int, int>> pairs_, untouching_;  // sorted
  std::vector<char> is_paired_;                          // by body
  std::vector<int> paired_;
};

}  // namespace mrhi
