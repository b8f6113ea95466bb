#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "response/block_system.h"
#include "response/spring_contact.h"
#include "response/spring_lanes.h"

namespace mrhi {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Springs that press, stick, slip, are twisted, and such that do not touch.
class Springs {
 public:
  explicit Springs(std::size_t fours) : fours_(fours) {
    for (SpringContact<Lanes>& four : fours_) {
      for (int lane = 0; lane < kLanes; ++lane) put(any(), lane, four);
    }
  }

  static void put(const SpringContact<double>& one, int lane, SpringContact<Lanes>& four) {
    const auto* from = reinterpret_cast<const double*>(&one);
    auto* to = reinterpret_cast<Lanes*>(&four);
    for (std::size_t i = 0; i < sizeof(one) / sizeof(double); ++i) to[i].lane[lane] = from[i];
  }

  SpringSum respond(const SpringLanes& lanes, const Vector6& velocity, bool renew_limits = true) {
    SpringSum sum;
    lanes.respond(fours_.data(), fours_.data() + fours_.size(), velocity.data(), renew_limits, sum);
    return sum;
  }
  SpringSlope slope(const SpringLanes& lanes) const {
    SpringSlope slope;
    lanes.slope(fours_.data(), fours_.data() + fours_.size(), slope);
    return slope;
  }
  const std::vector<SpringContact<Lanes>>& fours() const { return fours_; }

 private:
  double number(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(random_); }
  Vector3 vector3(double scale) { return {number(scale), number(scale), number(scale)}; }

  SpringContact<double> any() {
    SpringContact<double> one{};
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
  std::vector<SpringContact<Lanes>> fours_;
};

const Vector6 kVelocity = (Vector6() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.4).finished();

template <typename T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

TEST(SpringLanes, give_the_same_bits_on_every_kind_of_processor) {
  if (&spring_lanes() == &kPortableLanes) GTEST_SKIP() << "this processor has no wider registers";
  for (const std::size_t count : {1, 3, 50}) {
    Springs portable(count), wide(count);
    EXPECT_TRUE(
        same_bits(portable.respond(kPortableLanes, kVelocity), wide.respond(spring_lanes(), kVelocity)));
    EXPECT_TRUE(same_bits(portable.slope(kPortableLanes), wide.slope(spring_lanes())));
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(same_bits(portable.fours()[i], wide.fours()[i])) << i;
  }
}

TEST(SpringLanes, give_the_bits_of_a_spring_by_itself) {
  Springs springs(20);
  springs.respond(spring_lanes(), kVelocity);
  const Triple<double> linear = triple(kVelocity.head<3>()), angular = triple(kVelocity.tail<3>());
  for (const SpringContact<Lanes>& four : springs.fours()) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const SpringContact<double> found = contact_in(lane, four);
      SpringContact<double> one = found;
      one.response = {};
      const Triple<double> u = one.drive - linear - angular.cross(one.arm);
      one.spring.respond(u, one.drive_spin - one.spring.normal.dot(angular), true, one.response);
      EXPECT_TRUE(same_bits(one, found));
    }
  }
}

TEST(SpringLanes, slope_is_that_of_the_sum) {
  constexpr double kSmall = 1e-7;  // a velocity
  Springs springs(20);
  springs.respond(spring_lanes(), kVelocity, true);
  const SpringSlope slope = springs.slope(spring_lanes());
  double largest = 0.0;
  for (const double entry : slope.entry) largest = std::max(largest, std::abs(entry));
  const auto wrench = [&](const Vector6& velocity) {
    const SpringSum sum = springs.respond(spring_lanes(), velocity, false);
    return (Vector6() << Vector3(sum.force), Vector3(sum.torque)).finished();
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
