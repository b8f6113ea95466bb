#pragma once

#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Adds markers of one layer to an array. Okabe & Ito's colours (2008), which colour-blind people tell apart.
class MarkerLayer {
 public:
  MarkerLayer(visualization_msgs::MarkerArray& array, std_msgs::Header header, std::string name,
              double lifetime)
      : array_(array), header_(std::move(header)), name_(std::move(name)), lifetime_(lifetime) {}

  /// Valid until the next call.
  visualization_msgs::Marker& add(int id, int type, const Pose& pose, const Vector3& scale,
                                  const std_msgs::ColorRGBA& color);

 private:
  visualization_msgs::MarkerArray& array_;
  std_msgs::Header header_;
  std::string name_;
  double lifetime_;  ///< [s], 0: for ever
};

std_msgs::ColorRGBA color(double r, double g, double b, double a = 1.0);

/// How a hand is drawn.
struct HandStyle {
  std_msgs::ColorRGBA skin, touching;
  double thickness;  ///< share of the phalanges' radii
};

/// Spheres at the joints, cylinders along the bones, a palm between the metacarpals. Ids from `first_id`, at
/// most 100.
void add_hand(const Hand& hand, const std::array<bool, kCapsules>& touching, const HandStyle& style,
              int first_id, MarkerLayer& layer);

void add_bodies(const Scene& scene, const SimulationState& state, bool fixed, MarkerLayer& layer);

/// Points, and arrows of the forces on the objects that end in them.
void add_contacts(const FrameResult& result, MarkerLayer& layer);

}  // namespace mrhi
