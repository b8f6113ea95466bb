#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "response/island_problem.h"

namespace mrhi {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Rows that press, stick, slip, are twisted, are tilted, and such that do not touch.
class Rows {
 public:
  std::vector<SpringContact> all;

  explicit Rows(int count) {
    for (int i = 0; i < count; ++i) all.push_back(any());
  }

  /// Force and torque on body 2 at its velocity and angular velocity.
  Vector6 wrench(const Vector6& velocity, bool renew_limits) {
    Vector6 sum = Vector6::Zero();
    const Vector3 v = velocity.head<3>(), w = velocity.tail<3>();
    for (SpringContact& row : all) {
      const Vector3 n = vector(row.spring.normal), arm = vector(row.arm), tilt = vector(row.tilt);
      const Vector3 u = vector(row.drive) - v - w.cross(arm) - w.dot(tilt) * n;
      row.spring.evaluate(triple(u), row.drive_spin - n.dot(w), renew_limits, row.response);
      const Vector3 force = vector(row.response.force);
      sum.head<3>() += force;
      sum.tail<3>() += arm.cross(force) + force.dot(n) * tilt + row.response.torque * n;
    }
    return sum;
  }

 private:
  double number(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(random_); }
  Vector3 vector3(double scale) { return {number(scale), number(scale), number(scale)}; }

  SpringContact any() {
    SpringContact one{};
    const Vector3 n = vector3(1.0).normalized(), stretch = vector3(0.001);
    one.spring.normal = triple(n);
    one.spring.stretch = triple(stretch - n.dot(stretch) * n);
    one.spring.depth = number(0.002);
    one.spring.twist = number(0.5);
    one.spring.ahead = 0.0055;
    one.spring.fade = 10.0;
    one.spring.stiffness = 2000.0 + number(1000.0);
    one.spring.twist_stiffness = number(1.0) > 0.0 ? 1.25 : 0.0;
    one.spring.friction = 0.8;
    one.spring.patch_friction = 0.002;
    one.arm = triple(vector3(0.03));
    one.tilts = number(1.0) > 0.0;
    if (one.tilts) one.tilt = triple(vector3(0.01).cross(n));
    one.drive = triple(vector3(0.1));
    one.drive_spin = number(1.0);
    return one;
  }

  std::mt19937 random_{5};
};

const Vector6 kVelocity = (Vector6() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.4).finished();

TEST(Rows, slope_is_that_of_the_sum) {
  constexpr double kSmall = 1e-7;  // a velocity
  Rows rows(80);
  rows.wrench(kVelocity, true);
  Lower6 slope{};
  for (const SpringContact& row : rows.all) add_slope(row, point_slope(row), row.arm, slope);
  double largest = 0.0;
  for (const double entry : slope) largest = std::max(largest, std::abs(entry));
  for (int column = 0; column < 6; ++column) {
    const Vector6 change = kSmall * Vector6::Unit(column);
    const Vector6 lost =
        (rows.wrench(kVelocity - change, false) - rows.wrench(kVelocity + change, false)) / (2.0 * kSmall);
    for (int row = column; row < 6; ++row) {
      const auto at = static_cast<std::size_t>(Cholesky6::at(row, column));
      EXPECT_NEAR(slope[at], lost[row], 1e-6 * largest) << row << ' ' << column;
    }
  }
}

TEST(Cholesky6, solves) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix6 any = Matrix6::NullaryExpr([&] { return normal(random); });
    const Matrix6 matrix = any * any.transpose() + 0.1 * Matrix6::Identity();
    const Vector6 x = Vector6::NullaryExpr([&] { return normal(random); });
    Lower6 entries{};
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j <= i; ++j) entries[static_cast<std::size_t>(Cholesky6::at(i, j))] = matrix(i, j);
    }
    Cholesky6 factors;
    factors.factorise(entries);
    EXPECT_LT((factors.solve(matrix * x) - x).norm(), 1e-11 * x.norm());
  }
}

}  // namespace
}  // namespace mrhi
