#pragma once

#include <algorithm>
#include <map>

#include "collision/neighbours.h"
#include "support/finger_angles.h"
#include "support/fixtures.h"

namespace mrhi::testing {

/// The largest of a kind, and when it was.
struct Worst {
  double value = 0.0;
  double time = 0.0;  // stamp [s]

  void note(double seen, Nanoseconds stamp) {
    if (seen > value) value = seen, time = to_seconds(stamp);
  }
};

/// Looks at the rendered hands after each frame, by other means than they are made by, and keeps the worst.
class RenderedCheck {
 public:
  explicit RenderedCheck(const Scene& scene) : scene_(scene) {}

  void see(const Simulation& simulation) {
    const FrameResult& result = simulation.result();
    const std::vector<BodyState>& bodies = simulation.state().bodies;
    std::map<std::uint32_t, Before> now;
    std::size_t i = 0;
    for (std::size_t slot = 0; slot < simulation.state().hands.size(); ++slot) {
      const HandTrack& track = simulation.state().hands[slot];
      if (!track.active || i >= result.tracked.size()) continue;
      const Hand &tracked = result.tracked[i], &shown = result.rendered[i].hand;
      const auto& touching = result.rendered[i].touching;
      ++i;
      ++frames;
      for (std::size_t b = 0; b < bodies.size(); ++b)
        shown_in += simulation.state().interactions[slot * bodies.size() + b].shown_in;
      touched += std::count(touching.begin(), touching.end(), true) > 0;
      see_bones(tracked, shown, result.stamp);
      away.note(farthest_joint(tracked, shown), result.stamp);
      moved_aside += farthest_joint(tracked, shown) > 0.0;
      const auto before = before_.find(tracked.id);
      Before entry{result.stamp, tracked, shown};
      const bool near = near_anything(tracked, bodies);
      if (!near && before != before_.end() && !track.appeared) entry.near_last = before->second.near_last;
      if (to_seconds(result.stamp - entry.near_last) > kReturns)
        late.note(farthest_joint(tracked, shown), result.stamp);
      if (before != before_.end() && !track.appeared)
        see_way(before->second, tracked, shown, bodies, result.stamp);
      now[tracked.id] = entry;
    }
    depth.note(simulation.deepest_rendered(), result.stamp);
    before_.swap(now);
    bodies_before_ = bodies;
  }

  int frames = 0;                // hands seen
  int touched = 0;               // of them with a phalanx that touches
  int moved_aside = 0;           // of them not where they were tracked
  int shown_in = 0;              // of them in a body that appeared in them, or not clear of it yet
  int jumps = 0;                 // of them that jumped
  std::vector<Worst> all_jumps;  // [m]
  Worst length;                  // of a bone, against the tracked one [m]
  Worst apart;                   // ends of bones that are one joint in the tracked hand [m]
  Worst angle;                   // of a joint beyond its limit and beyond where it was tracked [rad]
  Worst thumb_angle;             // the same of the thumb, whose whole bend is measured, sideways too [rad]
  Worst depth;                   // in any body [m]
  Worst jump;  // of a joint in a frame beyond what the farthest tracked one and bodies moved [m]
  Worst away;  // of a joint from where it was tracked [m]
  Worst late;  // the same though nothing has been near for long [m]

 private:
  static constexpr double kReturns = 1.5;  // [s]
  static constexpr double kJump = 0.002;   // [m]
  static constexpr double kPutBack = 1.0;  // no body flies as far in a frame: it was put there [m]
  struct Before {
    Nanoseconds stamp;
    Hand tracked, shown;
    Nanoseconds near_last = stamp;
  };

  bool near_anything(const Hand& hand, const std::vector<BodyState>& bodies) const {
    return !near_bodies(hand, scene_, bodies, 0.01).empty();
  }

  void see_bones(const Hand& tracked, const Hand& shown, Nanoseconds stamp) {
    for (std::size_t c = 0; c < kCapsules; ++c) {
      const Capsule &from = tracked.capsules[c], &to = shown.capsules[c];
      if (from.radius <= 0.0) continue;
      length.note(std::abs((to.end - to.start).norm() - (from.end - from.start).norm()), stamp);
      length.note(std::abs(to.radius - from.radius), stamp);
      for (std::size_t other = c + 1; other < kPalm; ++other) {
        if (tracked.capsules[other].radius <= 0.0) continue;
        if (tracked.capsules[other].start == from.end)
          apart.note((shown.capsules[other].start - to.end).norm(), stamp);
        if (tracked.capsules[other].start == from.start)
          apart.note((shown.capsules[other].start - to.start).norm(), stamp);
      }
    }
    thumb_angle.note(beyond_limits(tracked, shown, 0), stamp);
    for (int finger = 1; finger < kFingers; ++finger)
      angle.note(beyond_limits(tracked, shown, finger), stamp);
  }

  void see_way(const Before& before, const Hand& tracked, const Hand& shown,
               const std::vector<BodyState>& bodies, Nanoseconds stamp) {
    const double elapsed = to_seconds(stamp - before.stamp);
    const double beyond =
        farthest_joint(before.shown, shown) - farthest_joint(before.tracked, tracked) -
        std::max(fastest_body(before.shown, bodies, elapsed), fastest_body(shown, bodies, elapsed));
    if (beyond > kJump) {
      all_jumps.emplace_back();
      all_jumps.back().note(beyond, stamp);
    }
    jump.note(beyond, stamp);
    jumps += beyond > kJump;
  }

  /// Longest way of a surface of the bodies near the hand since the frame before, or at their speed of now: a
  /// body that was hit within the frame has moved less, and the renderer knows velocities alone.
  double fastest_body(const Hand& hand, const std::vector<BodyState>& bodies, double elapsed) const {
    double fastest = 0.0;
    for (const int body : near_bodies(hand, scene_, bodies, 0.02)) {
      const auto b = static_cast<std::size_t>(body);
      const Pose &from = bodies_before_[b].pose, &to = bodies[b].pose;
      if ((to.position - from.position).norm() > kPutBack) continue;
      const double radius = scene_.bodies[b].bounding_radius;
      const Twist twist = twist_of(scene_.bodies[b], bodies[b]);
      fastest = std::max(
          {fastest, elapsed * (twist.linear.norm() + radius * twist.angular.norm()),
           (to.position - from.position).norm() + radius * to.orientation.angularDistance(from.orientation)});
    }
    return fastest;
  }

  const Scene& scene_;
  std::map<std::uint32_t, Before> before_;
  std::vector<BodyState> bodies_before_;
};

}  // namespace mrhi::testing
