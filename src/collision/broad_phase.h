#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Axis-aligned boxes of bodies; finds those that a box touches. A cache of the state, not part of it. Of
/// spheres' boxes: sound (a body is within its sphere, a sphere within its box), never exact.
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
  /// All pairs whose boxes touch, the smaller index first, in no order. Valid until the next call.
  const std::vector<std::pair<int, int>>& pairs();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
