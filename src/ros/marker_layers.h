#pragma once

#include <mr_hand_interaction/ObjectState.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "../rendering/skin.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/training/session.h"

namespace mrhi {

constexpr double kPassing = 0.5;  ///< lifetime of hands and contacts, which go if the node does [s]
constexpr double kForEver = 0.0;

/// Adds markers of one layer to an array.
class MarkerLayer {
 public:
  MarkerLayer(visualization_msgs::MarkerArray& array, std_msgs::Header header, std::string name,
              double lifetime)
      : array_(array), header_(std::move(header)), name_(std::move(name)), lifetime_(lifetime) {}

  /// Valid until the next call.
  visualization_msgs::Marker& add(int id, int type, const Pose& pose, const Vector3& scale,
                                  const std_msgs::ColorRGBA& color) const;

 private:
  visualization_msgs::MarkerArray& array_;
  std_msgs::Header header_;
  std::string name_;
  double lifetime_;  ///< [s], 0: for ever
};

/// The layers of an array, by their names. A layer is what adds it, and the call of that in Markers::update.
struct MarkerLayers {
  visualization_msgs::MarkerArray& array;
  const std_msgs::Header& header;

  MarkerLayer layer(const char* name, double lifetime = kPassing) const {
    return {array, header, name, lifetime};
  }
};

constexpr int kIdsPerHand = 100;

/// How a hand is drawn.
struct HandStyle {
  std_msgs::ColorRGBA skin, touching;
  double thickness;  ///< share of the phalanges' radii
};

/// Spheres at the joints, cylinders along the bones and the palm, as the simulation has them. Ids from
/// `first_id`, less than kIdsPerHand.
void add_capsules(const Hand& hand, const Touching& touching, const HandStyle& style, int first_id,
                  const MarkerLayer& layer);

/// A shape as a marker, a box in the light that hands are in; valid until the layer's next call.
visualization_msgs::Marker& add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint,
                                      int id, const MarkerLayer& layer);

/// Farthest that the ends of two hands' phalanges are apart [m].
double farthest_apart(const Hand& a, const Hand& b);
/// Opacity of a ghost's vertex that is this far from the same vertex of the rendered hand [m].
float ghost_opacity(double distance, const PictureStyle& style);
/// Colour of a ghost's vertex with this normal, light included.
Rgb ghost_colour(const Vector3& normal, const PictureStyle& style);

/// Draws hands as triangles. One with bones missing has no skin: its capsules take the skin's place.
class HandMarkers {
 public:
  explicit HandMarkers(const Skin& skin);  ///< keeps a reference
  /// `hand`: skins, and apart from them their wrists' sides; `ghost`: tracked hands' skins where they are
  /// elsewhere; `capsules`: rendered hands as the simulation has them. kIdsPerHand for each hand. Without
  /// `style.skins` the first two have only hands that have none.
  void add(const FrameResult& result, const SimulationState& state, const PictureStyle& style,
           const MarkerLayers& layers);
  /// Takes the memory of markers that are done with, for the next ones.
  void recycle(std::vector<visualization_msgs::Marker>& markers);

 private:
  void add_hand(const RenderedHand& rendered, const Hand& tracked, const FrameResult& result,
                const SimulationState& state, const PictureStyle& style, int first_id,
                const MarkerLayer& hand, const MarkerLayer& ghost);
  /// What is translucent hides nothing, and is drawn from the farthest marker's place to the nearest: in one
  /// marker the wrist's far side would stand before its near one.
  static constexpr int kWristSides = 6;
  using Triangles = std::vector<SkinWrist::Triangle>;
  visualization_msgs::Marker& add_triangles(int id, const MarkerLayer& layer);
  void add_part(const Triangles& triangles, Side side, const Vector3& origin, int id,
                const MarkerLayer& layer);
  void add_skin(const RenderedHand& rendered, int first_id, const MarkerLayer& layer);
  void add_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, int id,
                 const MarkerLayer& layer);
  /// On which side of the wrist, as seen along the forearm.
  std::size_t side_of_wrist(const SkinWrist::Triangle& triangle) const;

  const Skin &skin_, &outline_;
  const SkinPaint paint_;
  const SkinWrist wrist_;
  std::array<Triangles, kWristSides> sides_;
  SkinSurface surface_, ghost_, beneath_;  // kept for their memory, as are the rest
  std::vector<Rgb> colours_;
  std::vector<float> alphas_;
  std::vector<visualization_msgs::Marker> spare_;
};

/// The same colour in the light that hands are in, on a surface with this normal: rviz leaves the sides that
/// its own light does not reach almost black.
std_msgs::ColorRGBA lit(const Vector3& normal, const std_msgs::ColorRGBA& paint);

/// From `begin` to `tip`, in world [m].
struct Arrow {
  Vector3 begin, tip;
  double shaft_radius, head_radius, head_length;  ///< [m]; the head at most as long as the arrow
};

/// Lit as by lit(). Valid until the layer's next call.
visualization_msgs::Marker& add_arrow(const Arrow& arrow, const std_msgs::ColorRGBA& paint, int id,
                                      const MarkerLayer& layer);

/// Where a body is touched, and by what force. `contacts`: a dot at each; `friction`: a ring on the surface
/// around it, green where it sticks, yellow where it slips; `forces`: an arrow behind the finger that
/// presses, whose length grows with the force; `newtons`: the force in numbers, at the arrow's end; `share`:
/// a ball, how much of what friction bears is used, from blue (none) to orange (all).
void add_contacts(const Scene& scene, const FrameResult& result, const PictureStyle& style,
                  const MarkerLayers& layers);

/// A flat ring about z, in the marker's own frame, from `begin` to `end` of a full turn, clockwise seen from
/// z, starting at x.
struct Ring {
  double inner, outer;  // radii [m]
  double begin = 0.0, end = 1.0;
  double pieces = 36.0;  // of a full turn
};
void add_ring(const Ring& ring, const Pose& place, visualization_msgs::Marker& marker);

/// A place that an object is to be brought to.
struct TargetMark {
  const Body& body;
  Pose pose;              ///< of the body's frame, in world
  double progress = 0.0;  ///< 0 to 1, of the time that it is to stay there
  bool reached = false;
  bool waits = false;  ///< its turn comes later: fainter
};

/// The object's shape there, translucent: blue, and green once it is reached; around it a level ring that
/// fills with the progress. Ids from `first_id`, one more than the body has shapes to be seen.
void add_target(const TargetMark& target, int first_id, const MarkerLayer& layer);
double ring_radius(const Body& body);  ///< inner, of a target's ring [m]

/// The object that is to be taken: a translucent yellow shell around it, and an arrow from above. Ids from
/// `first_id`, one more than the body has shapes to be seen.
void add_highlight(const Body& body, const Pose& pose, int first_id, const MarkerLayer& layer);

/// Height of what shadows fall on: the highest level top of a wide fixture under all that is free; else
/// z = 0.1 m, where rviz has its grid, or lower where something is free there.
double ground_height(const Scene& scene);

/// Where hands have struck bodies: a ring on the surface that widens and fades within kSeen.
class ImpactMarkers {
 public:
  static constexpr double kSeen = 0.15;  ///< [s]
  /// Impacts of a frame, at its stamp.
  void note(const std::vector<Contact>& contacts, const ros::Time& stamp);
  void add(const ros::Time& now, const PictureStyle& style, const MarkerLayer& layer);

 private:
  struct Impact {
    ros::Time begin, last;
    ContactKey key;
    Vector3 point, normal;
    double radius, impulse;
  };
  std::vector<Impact> impacts_;
};

/// The shadows of hands and of the first free bodies, straight below them on the ground: the higher a thing
/// is, the softer and fainter.
class ShadowMarkers {
 public:
  /// Keeps a reference. `ground`: height of what they fall on [m].
  ShadowMarkers(const Scene& scene, double ground) : scene_(scene), ground_(ground) {}
  /// Those of what has moved since they were last added, or all; those of hands that are gone are deleted.
  void add(const SimulationState& state, const FrameResult& result, bool all, const MarkerLayer& layer);

 private:
  struct Cast {
    std::vector<Vector3> from;  ///< places of what casts it, as it was last added
    visualization_msgs::Marker marker;
  };
  template <typename Outlines>
  void add_one(int id, std::vector<Vector3> from, const Outlines& outlines, bool all,
               const MarkerLayer& layer);

  const Scene& scene_;
  const double ground_;
  std::map<int, Cast> casts_;
};

/// What the participant is to do now, in a line.
std::string instruction_now(const Session& session, bool paused, bool begins_by_itself);

/// What rviz shows of a session, in the status's frame, a namespace for each layer: `target` (where the
/// object is to be; its ring fills with the time held), `places` (the others, fainter, with their numbers),
/// `path`, `object` (highlighted until it is held; `seen`: nothing if it is not there), `instructions`,
/// `timer` and `result`. They go if they are not shown again. What is to be read is nearer to the eye of
/// rviz/training.rviz than what hands do.
visualization_msgs::MarkerArray training_markers(const Session& session, const Body& body,
                                                 const mr_hand_interaction::TrainingStatus& status,
                                                 const std::optional<mr_hand_interaction::ObjectState>& seen);

}  // namespace mrhi
