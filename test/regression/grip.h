#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi::testing {

/// The phalanges that press the object at one time, as a rigid whole: where the object is among them later.
class Grip {
 public:
  Grip(const Hand& hand, const std::vector<Contact>& contacts, const Pose& object) : object_(object) {
    for (const Contact& contact : contacts) {
      const int capsule = contact.key.capsule;
      const bool known = std::find(capsules_.begin(), capsules_.end(), capsule) != capsules_.end();
      if (contact.touching() && !known) capsules_.push_back(capsule);
    }
    joints_ = joints(hand);
  }

  /// How far the object has moved among them (best rigid fit: Umeyama 1991), and how far they themselves
  /// among each other, rms [m].
  struct Change {
    double object, joints;
  };
  Change change(const Hand& hand, const Pose& object) const {
    const Eigen::Matrix3Xd now = joints(hand);
    const Eigen::Matrix4d fit = Eigen::umeyama(now, joints_, false);
    const Matrix3 turn = fit.topLeftCorner<3, 3>();
    const Vector3 shift = fit.topRightCorner<3, 1>();
    const Eigen::Matrix3Xd left = ((turn * now).colwise() + shift) - joints_;
    return {(turn * object.position + shift - object_.position).norm(),
            std::sqrt(left.squaredNorm() / static_cast<double>(left.cols()))};
  }
  double fastest(const Hand& from, const Hand& to, double seconds) const {
    return (joints(to) - joints(from)).colwise().norm().maxCoeff() / seconds;
  }
  std::size_t size() const { return capsules_.size(); }

 private:
  Eigen::Matrix3Xd joints(const Hand& hand) const {
    Eigen::Matrix3Xd points(3, 2 * static_cast<Eigen::Index>(capsules_.size()));
    Eigen::Index column = 0;
    for (const int capsule : capsules_) {
      points.col(column++) = hand.capsules[static_cast<std::size_t>(capsule)].start;
      points.col(column++) = hand.capsules[static_cast<std::size_t>(capsule)].end;
    }
    return points;
  }

  std::vector<int> capsules_;
  Pose object_;
  Eigen::Matrix3Xd joints_;
};

}  // namespace mrhi::testing
