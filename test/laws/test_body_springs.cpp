#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "response/body_problem.h"

namespace mrhi {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Springs that press, stick, slip, are twisted, and such that do not touch.
class Springs {
 public:
  std::vector<BodySpring> all;

  explicit Springs(int count) {
    for (int i = 0; i < count; ++i) {
      all.push_back(any());
      all.back().part = i % kParts;
    }
  }

  SpringSum respond(const Vector6& velocity, bool renew_limits) {
    return mrhi::respond(triple(velocity.head<3>()), triple(velocity.tail<3>()), renew_limits, all);
  }

 private:
  double number(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(random_); }
  Vector3 vector3(double scale) { return {number(scale), number(scale), number(scale)}; }

  BodySpring any() {
    BodySpring one{};
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
    one.drive = triple(vector3(0.1));
    one.drive_spin = number(1.0);
    return one;
  }

  std::mt19937 random_{5};
};

const Vector6 kVelocity = (Vector6() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.4).finished();

TEST(BodySprings, slope_is_that_of_the_sum) {
  constexpr double kSmall = 1e-7;  // a velocity
  Springs springs(80);
  springs.respond(kVelocity, true);
  const SpringSlope slope = slope_of(springs.all);
  double largest = 0.0;
  for (const double entry : slope.entry) largest = std::max(largest, std::abs(entry));
  const auto wrench = [&](const Vector6& velocity) {
    const SpringSum sum = springs.respond(velocity, false);
    return (Vector6() << vector(sum.force), vector(sum.torque)).finished();
  };
  for (int column = 0; column < 6; ++column) {
    const Vector6 way = kSmall * Vector6::Unit(column);
    const Vector6 lost = (wrench(kVelocity - way) - wrench(kVelocity + way)) / (2.0 * kSmall);
    for (int row = column; row < 6; ++row)
      EXPECT_NEAR(slope.entry[Cholesky6::at(row, column)], lost[row], 1e-6 * largest) << row << ' ' << column;
  }
}

TEST(Cholesky6, solves) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix6 any = Matrix6::NullaryExpr([&] { return normal(random); });
    const Matrix6 matrix = any * any.transpose() + 0.1 * Matrix6::Identity();
    const Vector6 x = Vector6::NullaryExpr([&] { return normal(random); });
    double entries[Cholesky6::kEntries];
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j <= i; ++j) entries[Cholesky6::at(i, j)] = matrix(i, j);
    }
    Cholesky6 factors;
    factors.factorise(entries);
    EXPECT_LT((factors.solve(matrix * x) - x).norm(), 1e-11 * x.norm());
  }
}

}  // namespace
}  // namespace mrhi
