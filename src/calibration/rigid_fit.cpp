#include "rigid_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "../text/text.h"

namespace mrhi {
namespace {

constexpr std::size_t kFewest = 3;
constexpr double kLeastWidth = 0.01;   // [m]: at 1 mm of error the turn about the line is known to 0.1 rad
constexpr double kTellable = 0.001;    // [m]: an rms below is that of a good fit, mirrored or not
constexpr double kMirrorShare = 0.25;  // of the rms, left by the mirror image: it is what was measured

using Points = Eigen::Matrix3Xd;

/// Distance (rms) of the points from the line that is nearest to them.
double width(const Points& points) {
  const Points centred = points.colwise() - points.rowwise().mean();
  const Matrix3 spread = centred * centred.transpose() / static_cast<double>(points.cols());
  const Vector3 variances = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvalues();
  return std::sqrt(std::max(0.0, variances[0] + variances[1]));
}

void refuse_degenerate(const Points& points, const char* frame) {
  const double found = width(points);
  if (found >= kLeastWidth) return;
  throw FitError(std::string("the points lie on one line in ") + frame + ": " + text::number(1e3 * found) +
                 " mm (rms) off it; at least " + text::number(1e3 * kLeastWidth) + " mm are needed");
}

RigidFit best_fit(const Points& local, const Points& world) {
  const Eigen::Matrix4d transform = Eigen::umeyama(local, world, false);
  RigidFit fit;
  fit.local_in_world = {transform.topRightCorner<3, 1>(),
                        Quaternion(Matrix3(transform.topLeftCorner<3, 3>())).normalized()};
  double sum = 0.0;
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    fit.residuals.push_back((fit.local_in_world * local.col(i) - world.col(i)).norm());
    sum += fit.residuals.back() * fit.residuals.back();
  }
  fit.rms = std::sqrt(sum / static_cast<double>(local.cols()));
  return fit;
}

}  // namespace

RigidFit fit_rigid(const std::vector<PointPair>& pairs) {
  if (pairs.size() < kFewest)
    throw FitError(std::to_string(pairs.size()) + " points; at least three are needed, not on one line");
  Points local(3, pairs.size()), world(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    local.col(static_cast<Eigen::Index>(i)) = pairs[i].local;
    world.col(static_cast<Eigen::Index>(i)) = pairs[i].world;
  }
  if (!local.allFinite() || !world.allFinite()) throw FitError("a point's coordinate is not a finite number");
  refuse_degenerate(world, "world");
  refuse_degenerate(local, "the device's frame");
  RigidFit fit = best_fit(local, world);
  if (fit.rms > kTellable && best_fit(-local, world).rms < kMirrorShare * fit.rms)
    throw FitError(
        "the points are mirrored: one of the two frames is left-handed; allowed: right-handed frames");
  return fit;
}

}  // namespace mrhi
