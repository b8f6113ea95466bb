#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr double kPerNewton = 0.1;    // length of an arrow [m/N]
constexpr double kLongest = 0.12;     // [m]
constexpr double kShortest = 0.003;   // [m]
constexpr double kPointSize = 0.006;  // [m]

std_msgs::ColorRGBA phase_color(const Contact& contact) {
  if (!contact.impulse.isZero(0.0)) return color(1.0, 1.0, 1.0);
  return contact.friction == Friction::sticking ? color(0.941, 0.894, 0.259) : color(0.800, 0.475, 0.655);
}

void add_arrow(const Contact& contact, int id, MarkerLayer& layer) {
  const double newtons = contact.force.norm();
  const double length = std::min(kPerNewton * newtons, kLongest);
  if (length < kShortest) return;
  Marker& arrow = layer.add(id, Marker::ARROW, Pose{}, {0.004, 0.010, 0.4 * length}, phase_color(contact));
  arrow.points = {to_message(Vector3(contact.point - length / newtons * contact.force)),
                  to_message(contact.point)};
}

}  // namespace

void add_contacts(const FrameResult& result, MarkerLayer& layer) {
  if (result.contacts.empty()) return;
  int id = 1;
  for (const Contact& contact : result.contacts) add_arrow(contact, id++, layer);
  Marker& points =
      layer.add(0, Marker::SPHERE_LIST, Pose{}, Vector3::Constant(kPointSize), color(1.0, 1.0, 1.0));
  for (const Contact& contact : result.contacts) {
    points.points.push_back(to_message(contact.point));
    points.colors.push_back(phase_color(contact));
  }
}

}  // namespace mrhi
