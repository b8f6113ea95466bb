#include "grip_margin.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kSize = 0.03;  // by which turns and moves are weighed alike [m]
constexpr int kRounds = 150;    // of the iteration, which gains little after a few dozen
constexpr double kBegin = 1.0,
                 kSharper = 0.9;   // what moves slower than this part of the whole keeps a finite weight
constexpr double kNothing = 1e-9;  // of a load [N]

/// What slides at a contact: along the surface, and about its normal, as it takes power.
struct Slide {
  Eigen::Matrix<double, 3, 6> along;
  Eigen::Matrix<double, 1, 6> turn;
  double limit, lever;
};

Matrix3 cross_of(const Vector3& r) {
  Matrix3 m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

Slide slide_of(const GripContact& grip, const Vector3& about) {
  Slide slide;
  const Matrix3 along = Matrix3::Identity() - grip.normal * grip.normal.transpose();
  slide.along << along, -along * cross_of(grip.point - about) / kSize;
  slide.turn << Eigen::RowVector3d::Zero(), grip.normal.transpose() / kSize;
  slide.limit = grip.limit;
  slide.lever = grip.lever;
  return slide;
}

double power(const std::vector<Slide>& slides, const Vector6& motion) {
  double sum = 0.0;
  for (const Slide& slide : slides)
    sum += slide.limit * ((slide.along * motion).norm() + slide.lever * std::abs(slide.turn.dot(motion)));
  return sum;
}

/// Quadratic, and of the same power and slope at this motion.
Matrix6 weights(const std::vector<Slide>& slides, const Vector6& motion, double still) {
  Matrix6 sum = Matrix6::Zero();
  for (const Slide& slide : slides) {
    const double along = std::max((slide.along * motion).norm(), still);
    const double turn = std::max(slide.lever * std::abs(slide.turn.dot(motion)), still);
    sum += slide.limit / along * slide.along.transpose() * slide.along;
    sum += slide.limit * slide.lever * slide.lever / turn * slide.turn.transpose() * slide.turn;
  }
  return sum + 1e-15 * (1e-9 + sum.trace()) * Matrix6::Identity();
}

}  // namespace

double bearable(const std::vector<GripContact>& grips, const Load& load) {
  Vector6 wrench;
  wrench << load.force, load.torque / kSize;
  if (wrench.norm() < kNothing) return kNoLoad;
  std::vector<Slide> slides;
  for (const GripContact& grip : grips) slides.push_back(slide_of(grip, load.about));
  Vector6 motion = wrench / wrench.squaredNorm();
  double least = power(slides, motion);
  double still = kBegin;
  for (int round = 0; round < kRounds; ++round, still *= kSharper) {
    const Vector6 yielding =
        weights(slides, motion, std::max(still, 1e-6) * motion.norm() * kSize).ldlt().solve(wrench);
    motion = yielding / yielding.dot(wrench);
    least = std::min(least, power(slides, motion));
  }
  return least;
}

}  // namespace mrhi
