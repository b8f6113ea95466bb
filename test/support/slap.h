#pragma once

#include "support/fixtures.h"

namespace mrhi::testing {

constexpr double kHitterRadius = 0.008;

inline Body slab(const Vector3& size, double restitution) {
  Body body = box_body(size, 0.05);
  body.material.restitution = restitution;
  body.material.stiffness = 2000.0;
  return body;
}

/// A capsule across the face that goes along +x at `speed` for good and meets the face x = -half at t =
/// `hit`.
inline std::function<Hand(double)> hitter(double speed, double half, double hit, const Vector3& offset) {
  return [=](double t) {
    const Vector3 centre = offset + Vector3(speed * (t - hit) - half - kHitterRadius, 0, 0);
    return finger(centre - Vector3(0, 0.0125, 0), centre + Vector3(0, 0.0125, 0), kHitterRadius);
  };
}

/// Velocity after a blow along +x at r: normal impulse by Newton's law, tangential by sticking or, if that
/// asks for more than mu j, by sliding (two-dimensional, about y).
inline Twist blow(const Body& body, double speed, double restitution, double half, double lever) {
  const double inertia = body.inertia(1, 1), m = body.mass, mu = body.material.static_friction;
  // Contact at (-half, 0, lever); K in (x, z).
  const double kxx = 1.0 / m + lever * lever / inertia, kzz = 1.0 / m + half * half / inertia;
  const double kxz = half * lever / inertia;
  const double u = (1.0 + restitution) * speed;
  // Sticking: K (jx, jz) = (u, 0).
  double jx = u * kzz / (kxx * kzz - kxz * kxz), jz = -jx * kxz / kzz;
  if (std::abs(jz) > mu * jx) {
    const double sign = jz < 0.0 ? -1.0 : 1.0;
    jx = u / (kxx + sign * mu * kxz);
    jz = sign * mu * jx;
  }
  return {Vector3(jx, 0, jz) / m, Vector3(0, (lever * jx + half * jz) / inertia, 0)};
}

/// Of 25 phases of scene (c)'s 5 mm plate at one step per frame [1/s]: how many get the speed [m/s].
inline int plates_hit(double speed, double rate, const Configuration& configuration) {
  int hit = 0;
  for (int phase = 0; phase < 25; ++phase) {
    Simulation simulation(scene_of(slab(Vector3(0.005, 0.1, 0.1), 0.0)), configuration);
    const double time = (5.0 + phase / 25.0) / rate;
    play(simulation, 0.0, 12.0 / rate, rate, hitter(speed, 0.0025, time, Vector3::Zero()));
    const double reached = object_twist(simulation).linear.x() / speed;
    hit += std::abs(reached - 1.0) <= 0.1;
  }
  return hit;
}

}  // namespace mrhi::testing
