#pragma once

#include <std_msgs/ColorRGBA.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

class BodyMarkers;
class HandMarkers;
class ImpactMarkers;
class ShadowMarkers;

std_msgs::ColorRGBA color(double r, double g, double b, double a = 1.0);

/// What of the picture a viewer may choose. Okabe & Ito's colours (2008), which colour-blind people tell
/// apart.
struct PictureStyle {
  /// False: the viewer bends the skins itself, and `hand` and `ghost` have only hands that have no skin.
  bool skins = true;
  std_msgs::ColorRGBA ghost = color(0.337, 0.706, 0.914, 0.7);  ///< at its most opaque
  double ghost_from = 0.003, ghost_full = 0.012;  ///< distances from the hand: unseen up to, most opaque [m]
  std_msgs::ColorRGBA contacts = color(1.0, 1.0, 1.0);
  std_msgs::ColorRGBA sticks = color(0.000, 0.620, 0.451), slips = color(0.941, 0.894, 0.259);
  std_msgs::ColorRGBA forces = color(0.97, 0.97, 0.97);
  std_msgs::ColorRGBA impacts = color(1.0, 0.85, 0.35);
  double least_force = 0.1;  ///< of an arrow [N]
};

/// "implicit  |  gravity: none": what the text says besides what is held.
std::string caption(const std::string& contact_model, const Vector3& gravity);

/// What is drawn, for rviz's MarkerArray display, for other viewers and for the package's own rviz display
/// alike; a namespace for each layer: `hand` (rendered, as a skin), `ghost` (tracked, where it is elsewhere),
/// `capsules` (rendered, as simulated), `objects`, `fixtures` (their names are the markers' texts),
/// `contacts` (points), `friction` (rings), `forces` (arrows), `newtons` (the same in numbers), `share` (of
/// friction's limit, a colour), `impacts` (rings that fade), `shadows` and `text`. What passes (hands,
/// contacts) is in each array, and deleted by the first one that it is not in; what stays is sent when it
/// changes, and again twice a second.
class Markers {
 public:
  /// Keeps a reference to the scene. `caption`: see caption().
  Markers(const Scene& scene, std::string caption, PictureStyle style = {});
  Markers(const Scene& scene, const Configuration& configuration, PictureStyle style = {});
  ~Markers();

  /// Call for each frame, shown or not: what lasts for less than a picture is kept for the next one.
  void note(const FrameResult& result, const ros::Time& stamp);
  /// `array` may be one that is done with: its memory is used again.
  void update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
              visualization_msgs::MarkerArray& array);
  /// The next array has everything, and begins by deleting what was there before.
  void clear();
  /// The next array has everything.
  void send_all() { all_ = true; }
  PictureStyle& style() { return style_; }

 private:
  using Key = std::pair<std::string, int>;
  void delete_gone(const std_msgs::Header& header, visualization_msgs::MarkerArray& array);
  bool all_due(const ros::Time& stamp);

  const Scene& scene_;
  const std::string caption_;
  PictureStyle style_;
  const Vector3 text_place_;
  std::unique_ptr<HandMarkers> hands_;
  std::unique_ptr<BodyMarkers> bodies_;
  std::unique_ptr<ShadowMarkers> shadows_;
  std::unique_ptr<ImpactMarkers> impacts_;
  std::string text_;
  std::vector<Key> shown_, now_;  // what passes, in order
  ros::Time all_sent_;
  bool cleared_ = true, all_ = true;
};

}  // namespace mrhi
