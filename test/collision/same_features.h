#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "collision/closest_features.h"

namespace mrhi {

/// Expects the same features bit for bit.
inline void expect_same(const std::optional<ClosestFeatures>& a, const std::optional<ClosestFeatures>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->distance, b->distance);
  EXPECT_EQ(a->normal, b->normal);
  EXPECT_EQ(a->point, b->point);
  EXPECT_EQ(a->axis_parameter, b->axis_parameter);
  EXPECT_EQ(a->part, b->part);
}

}  // namespace mrhi
