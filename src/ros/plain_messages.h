#pragma once

#include <geometry_msgs/Point.h>
#include <ros/message_traits.h>
#include <std_msgs/ColorRGBA.h>

// In memory these are what goes over the wire: roscpp copies a vector of them in one go.
static_assert(sizeof(geometry_msgs::Point) == 3 * sizeof(double), "a point has padding");
static_assert(sizeof(std_msgs::ColorRGBA) == 4 * sizeof(float), "a colour has padding");
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "messages are little-endian");

namespace ros {
namespace message_traits {
template <>
struct IsSimple<geometry_msgs::Point> : TrueType {};
template <>
struct IsSimple<std_msgs::ColorRGBA> : TrueType {};
}  // namespace message_traits
}  // namespace ros
