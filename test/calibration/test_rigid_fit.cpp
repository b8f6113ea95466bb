#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "calibration/rigid_fit.h"

namespace {

using mrhi::fit_rigid;
using mrhi::FitError;
using mrhi::PointPair;
using mrhi::Pose;
using mrhi::Quaternion;
using mrhi::RigidFit;
using mrhi::Vector3;

Pose random_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto number = [&] { return normal(random); };
  const Quaternion turn = Quaternion(number(), number(), number(), number()).normalized();
  return {{number(), number(), number()}, turn};
}

/// Points of a desk: four corners and the top of a box, 0.2 m about.
std::vector<Vector3> desk() {
  return {{-0.2, -0.1, 0.0}, {0.2, -0.1, 0.0}, {0.2, 0.15, 0.0}, {-0.2, 0.15, 0.0}, {0.05, 0.05, 0.12}};
}

std::vector<PointPair> seen_from(const Pose& device, const std::vector<Vector3>& world) {
  std::vector<PointPair> pairs;
  for (const Vector3& point : world) pairs.push_back({device.to_local(point), point});
  return pairs;
}

double angle(const Quaternion& a, const Quaternion& b) {
  return a.angularDistance(b);
}

std::string refusal(const std::vector<PointPair>& pairs) {
  try {
    fit_rigid(pairs);
  } catch (const FitError& error) {
    return error.what();
  }
  return "taken";
}

TEST(RigidFit, ExactPointsGiveThePoseBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose device = random_pose(random);
    const RigidFit fit = fit_rigid(seen_from(device, desk()));
    // Rounding of coordinates of a few metres.
    EXPECT_LT((fit.local_in_world.position - device.position).norm(), 1e-13);
    EXPECT_LT(angle(fit.local_in_world.orientation, device.orientation), 1e-7);  // of acos near 1
    EXPECT_LT(fit.rms, 1e-13);
  }
}

TEST(RigidFit, ThreePointsAreEnoughAndAPlaneIsNoMirror) {
  std::mt19937 random(2);
  const Pose device = random_pose(random);
  for (std::size_t count : {3u, 4u}) {
    const auto all = desk();
    const RigidFit fit = fit_rigid(seen_from(device, {all.begin(), all.begin() + static_cast<int>(count)}));
    EXPECT_LT((fit.local_in_world.position - device.position).norm(), 1e-13);
    EXPECT_LT(angle(fit.local_in_world.orientation, device.orientation), 1e-7);
  }
}

/// Of 3n coordinates six go into the pose: the squared residuals sum to sigma^2 chi^2(3n - 6) in the mean.
TEST(RigidFit, NoiseLeavesTheResidualAndTheErrorThatTheoryHasForIt) {
  constexpr double kSigma = 0.0005;
  constexpr int kRuns = 2000;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, kSigma);
  const auto world = desk();
  const double free = 3.0 * static_cast<double>(world.size()) - 6.0;
  Vector3 centre = Vector3::Zero();
  for (const Vector3& point : world) centre += point / static_cast<double>(world.size());
  double squares = 0.0, centre_squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const Pose device = random_pose(random);
    auto pairs = seen_from(device, world);
    for (PointPair& pair : pairs) pair.local += Vector3(noise(random), noise(random), noise(random));
    const RigidFit fit = fit_rigid(pairs);
    squares += fit.rms * fit.rms * static_cast<double>(pairs.size());
    centre_squares += (fit.local_in_world * device.to_local(centre) - centre).squaredNorm();
  }
  // Five standard deviations of the mean of chi^2 variables over the runs.
  const double free_ratio = squares / kRuns / (kSigma * kSigma * free);
  EXPECT_NEAR(free_ratio, 1.0, 5.0 * std::sqrt(2.0 / (free * kRuns)));
  const double centre_ratio =
      centre_squares / kRuns / (3.0 * kSigma * kSigma / static_cast<double>(world.size()));
  EXPECT_NEAR(centre_ratio, 1.0, 5.0 * std::sqrt(2.0 / (3.0 * kRuns)));
}

TEST(RigidFit, ResidualNamesThePointThatIsOff) {
  auto pairs = seen_from({}, desk());
  pairs[2].local.z() += 0.02;
  const RigidFit fit = fit_rigid(pairs);
  ASSERT_EQ(fit.residuals.size(), pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_LE(fit.residuals[i], fit.residuals[2]);
  }
  double squares = 0.0;
  for (double residual : fit.residuals) squares += residual * residual;
  EXPECT_DOUBLE_EQ(fit.rms, std::sqrt(squares / 5.0));
}

TEST(RigidFit, RefusesTooFewPoints) {
  EXPECT_EQ(refusal(seen_from({}, {{0, 0, 0}, {0.1, 0, 0}})),
            "2 points; at least three are needed, not on one line");
}

TEST(RigidFit, RefusesPointsOnOneLineInEitherFrame) {
  std::mt19937 random(4);
  const Pose device = random_pose(random);
  const std::vector<Vector3> line{{0, 0, 0}, {0.1, 0.2, 0}, {0.2, 0.4, 0}, {0.3, 0.602, 0}};
  EXPECT_NE(refusal(seen_from(device, line)).find("lie on one line in world"), std::string::npos);
  auto pairs = seen_from(device, desk());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].local = {0.1 * static_cast<double>(i), 0.0, 0.0};
  EXPECT_NE(refusal(pairs).find("lie on one line in the device's frame"), std::string::npos);
  EXPECT_NE(refusal(seen_from(device, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})).find("one line"),
            std::string::npos);
}

TEST(RigidFit, RefusesMirroredPointsAlsoWithNoise) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.001);
  for (int run = 0; run < 100; ++run) {
    auto pairs = seen_from(random_pose(random), desk());
    for (PointPair& pair : pairs)
      pair.local = Vector3(-pair.local.x() + noise(random), pair.local.y(), pair.local.z() + noise(random));
    EXPECT_NE(refusal(pairs).find("mirrored"), std::string::npos);
  }
}

TEST(RigidFit, RefusesWhatIsNotFinite) {
  auto pairs = seen_from({}, desk());
  pairs[1].local.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(pairs), "a point's coordinate is not a finite number");
}

}  // namespace
