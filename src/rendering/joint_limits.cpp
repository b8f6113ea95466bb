#include "joint_limits.h"

#include <cmath>

namespace mrhi {
namespace {

constexpr double kDegree = M_PI / 180.0;

ThumbRest make_thumb_rest() {
  const Quaternion rest = Eigen::AngleAxisd(38.0 * kDegree, Vector3::UnitZ()) *
                          Eigen::AngleAxisd(18.0 * kDegree, Vector3::UnitY()) *
                          Eigen::AngleAxisd(-60.0 * kDegree, Vector3::UnitX());
  return {rest * Vector3::UnitX(), rest * Vector3::UnitY()};
}

}  // namespace

JointLimits joint_limits(int finger) {
  if (finger == 0) {
    return {kDegree * FingerOffset(-35.0, -40.0, -15.0, -20.0),
            kDegree * FingerOffset(50.0, 55.0, 60.0, 85.0)};
  }
  return {kDegree * FingerOffset(-40.0, -25.0, -5.0, -20.0), kDegree * FingerOffset(95.0, 25.0, 115.0, 85.0)};
}

const ThumbRest& thumb_rest() {
  static const ThumbRest rest = make_thumb_rest();
  return rest;
}

}  // namespace mrhi
