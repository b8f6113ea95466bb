#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../world.h"

namespace mrhi::benchmark {

/// Minimum-jerk path from 0 to 1 within `duration` [s] (Flash & Hogan 1985).
inline double smooth(double t, double duration) {
  const double x = std::clamp(t / duration, 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

/// The pinching hand of scene (a): a thumb and four fingers, each of four capsules of radius 8 mm and segment
/// 25 mm, their distal ones along opposite faces of a 50 mm cube. Each finger is one part; all start 10 mm
/// away.
struct PinchHand {
  double overlap = 0.002;  ///< of the closed fingers and the cube's surface [m]
  double half = 0.025;     ///< of the cube [m]

  static constexpr int kParts = 5;
  static constexpr double kRadius = 0.008, kSpacing = 0.0125, kClosing = 0.2;

  static double side(int finger) { return finger == 0 ? -1.0 : 1.0; }

  std::vector<KinematicSpec> parts() const {
    std::vector<KinematicSpec> parts(kParts);
    for (int finger = 0; finger < kParts; ++finger) {
      Vector3 end(0, 0, 0.0125);
      for (int bone = 0; bone < 4; ++bone) {
        const Vector3 start =
            end - (bone == 0 ? Vector3(0, 0, 0.025) : Vector3(-side(finger) * 0.018, 0, 0.0173));
        parts[static_cast<std::size_t>(finger)].capsules.push_back({start, end, kRadius});
        end = start + Vector3(side(finger) * 0.004, 0, 0);
      }
    }
    return parts;
  }

  /// The finger's pose at time t while the hand is at `hand`.
  Pose finger(int finger, double t, const Vector3& hand) const {
    const double gap = 0.01 - (0.01 + overlap) * smooth(t, kClosing);
    const double across = finger == 0 ? 0.0 : (finger - 2.5) * kSpacing;
    return {hand + Vector3(side(finger) * (half + kRadius + gap), across, 0), Quaternion::Identity()};
  }
};

}  // namespace mrhi::benchmark
