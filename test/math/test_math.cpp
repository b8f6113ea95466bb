#include <gtest/gtest.h>

#include "math/minimum_jerk.h"
#include "math/registration.h"
#include "math/rotation.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "record/duration_histogram.h"

namespace mrhi {
namespace {

constexpr double kRounding = 1e-12;  // of lengths about 1

Quaternion any_turn(Random& random) {
  return Quaternion(random.gaussian(), random.gaussian(), random.gaussian(), random.gaussian()).normalized();
}
Pose any_pose(Random& random) {
  return {random.gaussian_vector(1.0), any_turn(random)};
}

TEST(Pose, products_are_taken_one_after_the_other) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose a = any_pose(random), b = any_pose(random);
    const Vector3 point = random.gaussian_vector(1.0);
    EXPECT_LT(((a * b) * point - a * (b * point)).norm(), kRounding);
    EXPECT_NEAR((a * b).orientation.norm(), 1.0, kRounding);
  }
}

TEST(Pose, an_inverse_takes_back_what_it_is_the_inverse_of) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = any_pose(random);
    const Vector3 point = random.gaussian_vector(1.0);
    EXPECT_LT((pose.to_local(pose * point) - point).norm(), kRounding);
    EXPECT_LT((pose.inverse() * (pose * point) - point).norm(), kRounding);
    EXPECT_LT((pose * (pose.inverse() * point) - point).norm(), kRounding);
  }
}

TEST(RotationBetween, is_the_shortest_from_one_direction_to_the_other_also_if_they_are_opposite) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vector3 from = random.gaussian_vector(1.0), to = i % 10 ? random.gaussian_vector(1.0) : -2.0 * from;
    const Quaternion turn = rotation_between(from, to);
    EXPECT_NEAR(turn.norm(), 1.0, kRounding);
    EXPECT_LT((turn * from.normalized() - to.normalized()).norm(),
              1e-6);  // opposite up to 1e-12 in the cosine
    EXPECT_NEAR(rotation_vector(turn).norm(),
                std::acos(std::max(-1.0, from.normalized().dot(to.normalized()))), 1e-6);
  }
}

TEST(CrossMatrix, is_skew_and_multiplies_as_the_cross_product_does) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Vector3 v = random.gaussian_vector(1.0), w = random.gaussian_vector(1.0);
    EXPECT_LT((cross_matrix(v) * w - v.cross(w)).norm(), kRounding);
    EXPECT_EQ(cross_matrix(v).transpose(), -cross_matrix(v));
  }
}

TEST(Capsule, its_axis_goes_from_start_to_end) {
  const Capsule capsule{{1, 2, 3}, {3, 2, -1}, 0.1};
  EXPECT_EQ(capsule.axis_point(0.0), capsule.start);
  EXPECT_EQ(capsule.axis_point(1.0), capsule.end);
  EXPECT_EQ(capsule.axis_point(0.5), capsule.centre());
  EXPECT_EQ(capsule.axis_point(0.25), Vector3(1.5, 2, 2));
}

TEST(Seconds, are_a_billion_nanoseconds) {
  EXPECT_DOUBLE_EQ(to_seconds(1'500'000'000), 1.5);
  EXPECT_DOUBLE_EQ(to_seconds(-1), -1e-9);
}

using Points = std::vector<Vector3>;

Points some_points(Random& random, int count, double size) {
  Points points;
  for (int i = 0; i < count; ++i) points.push_back(random.gaussian_vector(size));
  return points;
}
Points transformed(const Points& points, const Pose& pose, double scale) {
  Points result;
  for (const Vector3& point : points) result.push_back(pose * (scale * point));
  return result;
}
std::optional<Registration> registered(const Points& from, const Points& to) {
  return mrhi::registered(from.data(), to.data(), from.size());
}
Vector3 apply(const Registration& found, const Vector3& point) {
  return found.to + found.scale * (found.rotation * (point - found.from));
}
double squares(const Registration& found, const Points& from, const Points& to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (apply(found, from[i]) - to[i]).squaredNorm();
  return sum;
}

TEST(Registration, finds_the_turn_scale_and_shift_that_there_is) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Points from = some_points(random, 3 + i % 5, 0.05);
    const Pose pose = any_pose(random);
    const double scale = 0.5 + random.uniform();
    const auto found = registered(from, transformed(from, pose, scale));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->scale, scale, 1e-9);
    EXPECT_LT((found->rotation - pose.orientation.toRotationMatrix()).norm(), 1e-9);
    EXPECT_LT((apply(*found, Vector3::Zero()) - pose.position).norm(), 1e-9);
  }
}

TEST(Registration, is_the_least_of_all_near_it) {
  Random random(5);
  Points from = some_points(random, 12, 0.05), to = transformed(from, any_pose(random), 1.1);
  for (Vector3& point : to) point += random.gaussian_vector(0.005);
  const auto found = registered(from, to);
  ASSERT_TRUE(found);
  const double least = squares(*found, from, to);
  for (int i = 0; i < 200; ++i) {
    Registration other = *found;
    const Vector3 turn = random.gaussian_vector(1e-3);
    other.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * other.rotation;
    other.scale *= 1.0 + 1e-3 * random.gaussian();
    other.to += random.gaussian_vector(1e-4);
    EXPECT_GE(squares(other, from, to), least);
  }
}

// Points that only a mirror would bring upon each other, as of a left and a right hand.
TEST(Registration, never_mirrors) {
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Points from = some_points(random, 8, 0.05);
    Points to;
    for (const Vector3& point : from) to.push_back({-point.x(), point.y(), point.z()});
    const auto found = registered(from, to);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->rotation.determinant(), 1.0, 1e-9);
    EXPECT_LT((found->rotation.transpose() * found->rotation - Matrix3::Identity()).norm(), 1e-9);
    EXPECT_GE(squares(*found, from, to), 0.0);
    EXPECT_LT(found->scale, 1.0);
  }
}

TEST(Registration, in_one_plane_is_fixed_and_in_one_line_or_of_two_is_not) {
  const Pose pose{{0.1, 0.2, 0.3}, Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 1, 0).normalized()))};
  const Points plane{{0, 0, 0}, {0.05, 0, 0}, {0, 0.03, 0}, {0.04, 0.04, 0}};
  const auto found = registered(plane, transformed(plane, pose, 1.0));
  ASSERT_TRUE(found);
  EXPECT_LT((found->rotation - pose.orientation.toRotationMatrix()).norm(), 1e-9);
  const Points line{{0, 0, 0}, {0.05, 0, 0}, {0.02, 0, 0}, {0.08, 0, 0}};
  EXPECT_FALSE(registered(line, transformed(line, pose, 1.0)));
  const Points two{{0, 0, 0}, {0.05, 0.01, 0}};
  EXPECT_FALSE(registered(two, two));
  EXPECT_FALSE(registered(Points{}, Points{}));
  const Points one_place(5, Vector3(0.1, 0, 0));
  EXPECT_FALSE(registered(one_place, one_place));
}

// A spread of sqrt(1e-6 m^2) = 1 mm across the line is where a hand's points begin to fix it.
TEST(Registration, needs_a_millimetre_across_its_line) {
  const auto strip = [](double width) {
    return Points{{0, 0, -width},  {0.05, 0, width},  {0.1, 0, -width}, {0.15, 0, width},
                  {0.1, 0, width}, {0.05, 0, -width}, {0, 0, width},    {0.15, 0, -width}};
  };
  EXPECT_FALSE(registered(strip(0.0009), strip(0.0009)));
  EXPECT_TRUE(registered(strip(0.0011), strip(0.0011)));
}

TEST(MinimumJerk, goes_from_rest_to_rest_with_its_greatest_speed_in_the_middle) {
  constexpr double kStep = 1e-5;  // central differences: error about 1e-9
  const auto speed = [](double t) {
    return (minimum_jerk(t + kStep) - minimum_jerk(t - kStep)) / (2.0 * kStep);
  };
  EXPECT_EQ(minimum_jerk(0.0), 0.0);
  EXPECT_EQ(minimum_jerk(1.0), 1.0);
  EXPECT_NEAR(speed(0.0), 0.0, 1e-8);
  EXPECT_NEAR(speed(1.0), 0.0, 1e-8);
  EXPECT_NEAR(speed(0.5), 1.875, 1e-8);
}

TEST(MinimumJerk, stays_at_the_ends_outside_its_duration) {
  EXPECT_EQ(minimum_jerk(-1.0), 0.0);
  EXPECT_EQ(minimum_jerk(2.0), 1.0);
}

TEST(MinimumJerk, has_the_velocities_that_were_asked_for_at_its_ends) {
  const Vector3 from(1, 2, 3), to(4, 3, 2), v0(0.5, -1, 0), v1(0, 2, 1);
  const double duration = 0.8, step = 1e-6;
  const auto at = [&](double t) { return minimum_jerk(from, v0, to, v1, duration, t); };
  EXPECT_EQ(at(0.0), from);
  EXPECT_LT((at(1.0) - to).norm(), 1e-12);
  // One-sided differences; the acceleration is zero there, so their error is of second order.
  EXPECT_LT(((at(step) - from) / (step * duration) - v0).norm(), 1e-6);
  EXPECT_LT(((to - at(1.0 - step)) / (step * duration) - v1).norm(), 1e-6);
}

TEST(MinimumJerk, is_straight_and_even_when_the_ends_have_the_mean_velocity) {
  const Vector3 from(0, 0, 0), velocity(0.1, -0.3, 0.2), to = 2.0 * velocity;
  for (const double t : {0.1, 0.35, 0.8}) {
    const Vector3 p = minimum_jerk(from, velocity, to, velocity, 2.0, t);
    EXPECT_LT((p - 2.0 * t * velocity).norm(), 1e-12);
  }
}

constexpr double kRelative = 0.0101;  // half a bin of 2 %

TEST(DurationHistogram, nothing_added_has_quantiles_of_zero) {
  const DurationHistogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.quantile_us(0.5), 0.0);
  EXPECT_EQ(histogram.max_us(), 0.0);
}

TEST(DurationHistogram, quantiles_are_within_one_percent) {
  DurationHistogram histogram;
  for (int microseconds = 1; microseconds <= 1000; ++microseconds) histogram.add(1000 * microseconds);
  EXPECT_NEAR(histogram.quantile_us(0.5), 500.0, kRelative * 500.0);
  EXPECT_NEAR(histogram.quantile_us(0.99), 990.0, kRelative * 990.0);
  EXPECT_NEAR(histogram.quantile_us(1.0), 1000.0, kRelative * 1000.0);
  EXPECT_EQ(histogram.max_us(), 1000.0);
}

TEST(DurationHistogram, no_quantile_exceeds_the_maximum) {
  DurationHistogram histogram;
  histogram.add(12345);
  EXPECT_LE(histogram.quantile_us(0.99), histogram.max_us());
}

TEST(DurationHistogram, extremes_are_counted) {
  DurationHistogram histogram;
  for (const Nanoseconds duration : {Nanoseconds{0}, Nanoseconds{1}, Nanoseconds{3'600'000'000'000}}) {
    histogram.add(duration);
  }
  EXPECT_EQ(histogram.count(), 3u);
  EXPECT_EQ(histogram.max_us(), 3.6e9);
  EXPECT_LT(histogram.quantile_us(0.5), 0.011);
}

}  // namespace
}  // namespace mrhi
