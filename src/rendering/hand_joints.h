#pragma once

#include <array>
#include <vector>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// A hand's joints as points that its bones share: moving a joint moves every bone that ends there.
class JointNet {
 public:
  explicit JointNet(const Hand& hand);

  /// Moves a capsule by `shift` at its axis parameter s.
  void push(int capsule, double s, const Vector3& shift);
  /// Draws bones, and the joints across the palm, back towards their tracked lengths once.
  void restore_lengths();

  Capsule capsule(int index) const;
  /// `hand` with the joints as they are now.
  Hand apply(const Hand& hand) const;

 private:
  struct Link {
    int a, b;
    double length;  // [m]
  };
  int joint_at(const Vector3& point);
  void link(int a, int b);

  std::vector<Vector3> joints_;
  std::vector<Link> links_;
  std::array<int, kCapsules> start_{}, end_{};  // joint of each capsule's ends, -1: absent
  std::array<double, kCapsules> radius_{};
};

}  // namespace mrhi
