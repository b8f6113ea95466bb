#include "renderer.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Mass with half of the largest effect [kg]: 0.1 kg has 2 % of it, 20 kg have 80 %.
constexpr double kHalfMass = 5.0;
/// Rate at which the lag decays [1/s]: a movement of a second shows it, and it has decayed a second later.
constexpr double kReturnRate = 4.0;
/// Longest frame whose mean acceleration is meaningful [s].
constexpr double kMaxFrame = 0.25;

void shift(const Vector3& by, Hand& hand) {
  hand.palm.position += by;
  hand.wrist += by;
  for (Capsule& capsule : hand.capsules) capsule.start += by, capsule.end += by;
}

}  // namespace

MovedMass moved_mass(int slot, double seconds, const Scene& scene, const Vector3& gravity,
                     const FrameResult& result) {
  std::vector<std::size_t> moved;
  Vector3 force = Vector3::Zero();
  const auto add = [&](std::size_t body, const Vector3& by_hand) {
    if (scene.bodies[body].fixed || by_hand.isZero(0.0)) return;
    force += by_hand;
    if (std::find(moved.begin(), moved.end(), body) != moved.end()) return;
    if (scene.joints.empty()) {
      moved.push_back(body);
      return;
    }
    for (const std::size_t part : hanging_on(body, scene))
      if (!scene.bodies[part].fixed) moved.push_back(part);
  };
  for (const Contact& contact : result.contacts)
    if (contact.key.hand == slot) add(contact.key.body, contact.force + contact.impulse / seconds);
  for (const GraspSupport& assist : result.assists)
    if (assist.hand == slot) add(assist.body, assist.force);
  MovedMass all;
  for (const std::size_t body : moved) all.mass += scene.bodies[body].mass;
  if (all.mass <= 0.0) return {};
  const double pull = gravity.norm();
  if (pull > 0.0) {
    const Vector3 up = -gravity / pull;
    force -= std::clamp(force.dot(up), 0.0, all.mass * pull) * up;
  }
  all.acceleration = force / all.mass;
  return all;
}

double control_display_ratio(double largest, double mass) {
  return 1.0 + (largest - 1.0) * mass / (mass + kHalfMass);
}

// The acceleration of the frame is an impulse at its middle, so that the mass's displacement h^2 a / 2 is
// kept; before and after it the lag returns freely:  d(t) = (d + (d' + w d) t) exp(-w t).
void advance_mass_lag(double largest, const MovedMass& moved, Nanoseconds stamp, MassLag& lag) {
  const double seconds = lag.stamp == 0 ? 0.0 : to_seconds(stamp - lag.stamp);
  lag.stamp = stamp;
  if (seconds <= 0.0 || seconds > kMaxFrame) {
    lag.displacement.setZero(), lag.velocity.setZero();
    return;
  }
  const auto pass = [&](double t) {
    const Vector3 rate = lag.velocity + kReturnRate * lag.displacement;
    const double left = std::exp(-kReturnRate * t);
    lag.velocity = left * (lag.velocity - kReturnRate * t * rate);
    lag.displacement = left * (lag.displacement + t * rate);
  };
  pass(0.5 * seconds);
  const double lagging = 1.0 - 1.0 / control_display_ratio(largest, moved.mass);
  lag.velocity -= lagging * seconds * moved.acceleration;
  pass(0.5 * seconds);
  const double distance = lag.displacement.norm();
  if (distance <= kMaxMassLag) return;
  const Vector3 along = lag.displacement / distance;
  lag.displacement = kMaxMassLag * along;
  lag.velocity -= std::max(0.0, along.dot(lag.velocity)) * along;
}

void lag_behind(const MassLag& before, const MassLag& now, const HandTrack& track, HandTrack& lagging) {
  lagging.active = track.active, lagging.held = track.held;
  lagging.appeared = track.appeared, lagging.emerged = track.emerged;
  lagging.previous = track.previous, lagging.current = track.current;
  shift(before.displacement, lagging.previous);
  shift(now.displacement, lagging.current);
}

}  // namespace mrhi
