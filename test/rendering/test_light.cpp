#include "rendering/skin.h"

#include <gtest/gtest.h>

namespace mrhi {
namespace {

TEST(Light, comes_from_above_and_leaves_no_side_black_or_blinding) {
  const Rgb up = light_on(Eigen::Vector3f::UnitZ()), down = light_on(-Eigen::Vector3f::UnitZ());
  EXPECT_TRUE((up > down).all());
  for (const Eigen::Vector3f& normal : {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(-1, 0, 0),
                                        Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, -1, 0)}) {
    EXPECT_GT(light_on(normal).minCoeff(), 0.2f);
    EXPECT_LT(light_on(normal).maxCoeff(), 1.2f);
  }
}

TEST(Light, is_less_in_a_fold_where_less_of_it_arrives_from_all_around) {
  const Eigen::Vector3f normal(0.6f, 0.0f, 0.8f);
  EXPECT_TRUE((light_on(normal, 0.5f) < light_on(normal)).all());
  EXPECT_TRUE((light_on(normal, 0.0f) >= 0.0f).all());
}

}  // namespace
}  // namespace mrhi
