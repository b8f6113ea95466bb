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

std_msgs::ColorRGBA color(double r, double g, double b, double a = 1.0);

/// Style of the rendered view. Colours of Okabe & Ito (2008), which colour-blind people can distinguish.
struct PictureStyle {
  /// False: the viewer deforms the skins itself; `hand` and `ghost` then have only hands without a skin.
  bool skins = true;
  std_msgs::ColorRGBA ghost = color(0.337, 0.706, 0.914, 0.7);  ///< maximum opacity
  double ghost_from = 0.003, ghost_full = 0.012;  ///< distances from the hand: invisible up to the first,
                                                  ///< maximum opacity at the second [m]
  std_msgs::ColorRGBA contacts = color(1.0, 1.0, 1.0);
  std_msgs::ColorRGBA sticks = color(0.000, 0.620, 0.451), slips = color(0.941, 0.894, 0.259);
  std_msgs::ColorRGBA forces = color(0.97, 0.97, 0.97);
  std_msgs::ColorRGBA assist = color(0.800, 0.475, 0.655);  ///< forces of grasp assist
  std_msgs::ColorRGBA impacts = color(1.0, 0.85, 0.35);
  double least_force = 0.1;      ///< smallest force with an arrow [N]
  double least_impulse = 0.002;  ///< smallest impact with a ring [N s]
};

/// Text of the view besides held objects: "implicit  |  gravity: none".
std::string caption(const std::string& contact_model, const Vector3& gravity);

/// Makes the markers for rviz's MarkerArray display, for other viewers and for the package's own rviz
/// display. Each layer has a namespace: `hand` (rendered, as a skin), `ghost` (tracked, where it differs),
/// `capsules` (rendered, as simulated), `objects`, `fixtures` (their names are the markers' texts),
/// `contacts` (points), `friction` (rings), `forces` (arrows), `newtons` (the same in numbers), `share`
/// (friction utilisation, a colour), `impacts` (rings that fade), `shadows` and `text`. Transient markers
/// (hands, contacts) are in each array, and deleted by the first without them. Persistent ones are sent when
/// they change, and twice a second.
class Markers {
 public:
  /// Keeps a reference to the scene. `caption`: see caption().
  Markers(const Scene& scene, std::string caption, PictureStyle style = {});
  Markers(const Scene& scene, const Configuration& configuration, PictureStyle style = {});
  ~Markers();

  /// Call for each frame, shown or not: keeps short events for the next array.
  void note(const FrameResult& result, const ros::Time& stamp);
  /// Fills `array`, whose memory is reused.
  void update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
              visualization_msgs::MarkerArray& array);
  /// Makes the next array complete, and delete all earlier markers first.
  void clear();
  /// Makes the next array complete.
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
  struct Parts;
  std::unique_ptr<Parts> parts_;  // makers of the layers
  std::string text_;
  std::vector<Key> shown_, now_;  // transient markers, sorted
  ros::Time all_sent_;
  bool cleared_ = true, all_ = true;
};

}  // namespace mrhi
