#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>

#include "marker_layers.h"

namespace mrhi {

void add_ring(const Ring& ring, const Pose& place, visualization_msgs::Marker& marker) {
  const double turn = ring.end - ring.begin;
  const int pieces = std::max(0, static_cast<int>(std::ceil(ring.pieces * turn)));
  const auto at = [&](double radius, int piece) {
    const double angle = -2.0 * M_PI * (ring.begin + turn * piece / pieces);
    return to_message(place * (radius * Vector3(std::cos(angle), std::sin(angle), 0.0)));
  };
  for (int i = 0; i < pieces; ++i) {
    const auto a = at(ring.inner, i), b = at(ring.outer, i), c = at(ring.outer, i + 1),
               d = at(ring.inner, i + 1);
    for (const auto& corner : {a, b, c, a, c, d}) marker.points.push_back(corner);
  }
}

}  // namespace mrhi
