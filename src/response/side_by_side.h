#pragma once

#include <functional>
#include <type_traits>

#include "../math/lanes.h"
#include "mr_hand_interaction/math.h"

namespace mrhi {

inline Triple<double> triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Vector3 vector(const Triple<double>& v) {
  return {v.x, v.y, v.z};
}
template <typename Real>
Triple<Real> everywhere(const Vector3& v) {
  return {constant<Real>(v.x()), constant<Real>(v.y()), constant<Real>(v.z())};
}

inline double lane_of(int, double value) {
  return value;
}
template <typename Real>
Triple<double> lane_of(int lane, const Triple<Real>& v) {
  return {lane_of(lane, v.x), lane_of(lane, v.y), lane_of(lane, v.z)};
}

/// Gives a member of a thing, or a function of it, as a Real or a Triple: what is made of things is so
/// written once for one and for four side by side.
template <typename Thing>
class One {
 public:
  using Real = double;
  explicit One(const Thing& thing) : thing_(thing) {}

  template <typename Get>
  auto operator()(Get get) const {
    if constexpr (std::is_same_v<std::decay_t<std::invoke_result_t<Get, const Thing&>>, Vector3>) {
      return triple(std::invoke(get, thing_));
    } else {
      return std::invoke(get, thing_);
    }
  }

 private:
  const Thing& thing_;
};

template <typename Thing>
class Four {
 public:
  using Real = Wide;
  explicit Four(Thing* const* things) : a_(things[0]), b_(things[1]), c_(things[2]), d_(things[3]) {}

  template <typename Get>
  auto operator()(Get get) const {
    if constexpr (std::is_same_v<std::decay_t<std::invoke_result_t<Get, const Thing&>>, Vector3>) {
      const auto coordinate = [&](int i) {
        return each([&get, i](const Thing& thing) { return std::invoke(get, thing)[i]; });
      };
      return Triple<Wide>{coordinate(0), coordinate(1), coordinate(2)};
    } else {
      return each([&get](const Thing& thing) { return std::invoke(get, thing); });
    }
  }

 private:
  template <typename Get>
  Wide each(Get get) const {
    return side_by_side(get(*a_), get(*b_), get(*c_), get(*d_));
  }

  const Thing *a_, *b_, *c_, *d_;
};

}  // namespace mrhi
