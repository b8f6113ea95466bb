#pragma once

#include <mr_hand_interaction/ObjectState.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

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

constexpr double kTransientLifetime = 0.5;  ///< of hands and contacts, if the node stops [s]
constexpr double kNoExpiry = 0.0;

/// Adds markers of one layer to an array.
struct MarkerLayer {
  visualization_msgs::MarkerArray& array;
  std_msgs::Header header;
  std::string name;
  double lifetime;  ///< [s]; 0: unlimited

  /// Valid until the next call.
  visualization_msgs::Marker& add(int id, int type, const Pose& pose, const Vector3& scale,
                                  const std_msgs::ColorRGBA& color) const;
};

/// The layers of an array, by name. A layer is added by a function that Markers::update calls.
struct MarkerLayers {
  visualization_msgs::MarkerArray& array;
  const std_msgs::Header& header;

  MarkerLayer layer(const char* name, double lifetime = kTransientLifetime) const {
    return {array, header, name, lifetime};
  }
};

constexpr int kIdsPerHand = 100;

/// Style of a hand's capsules.
struct HandStyle {
  std_msgs::ColorRGBA skin, touching;
  double thickness;  ///< fraction of the phalanges' radii
};

/// Draws joints as spheres, bones and palm as cylinders. Ids from `first_id`, less than kIdsPerHand.
void add_capsules(const Hand& hand, const Touching& touching, const HandStyle& style, int first_id,
                  const MarkerLayer& layer);

/// The shapes that are drawn of a body: its visuals, or without any its collision shapes.
std::vector<Visual> drawn_shapes(const Body& body);

/// Adds a shape as a marker; a box has the lighting of hands. Valid until the layer's next call.
visualization_msgs::Marker& add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint,
                                      int id, const MarkerLayer& layer);

/// Opacity of a ghost's vertex by its distance from the same vertex of the rendered hand [m].
float ghost_opacity(double distance, const PictureStyle& style);
/// Colour of a ghost's vertex with this normal, lighting included.
Rgb ghost_colour(const Vector3& normal, const PictureStyle& style);

/// Draws hands as triangles. A hand with missing bones has no skin, and is drawn as capsules.
class HandMarkers {
 public:
  /// `hand`: skins; `ghost`: tracked hands' skins where they differ; `capsules`: rendered hands as simulated.
  /// kIdsPerHand for each hand. Without `style.skins` the first two have only hands without a skin.
  void add(const FrameResult& result, const SimulationState& state, const PictureStyle& style,
           const MarkerLayers& layers);
  /// Takes used markers, to reuse their memory.
  void recycle(std::vector<visualization_msgs::Marker>& markers);

 private:
  bool pose_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style);
  void add_skin(const Skin& skin, Side side, int id, const MarkerLayer& layer);

  const Skin &skin_ = Skin::human(), &outline_ = Skin::outline();
  SkinSurface surface_, beneath_;  // reused memory, like the rest
  std::vector<Rgb> colours_;
  std::vector<float> alphas_;
  std::vector<visualization_msgs::Marker> spare_;
};

/// Adds a vertex lit like hands, by its unit normal in world. rviz leaves averted sides almost black.
void add_lit(const Vector3& point, const Vector3& normal, const std_msgs::ColorRGBA& paint,
             visualization_msgs::Marker& marker);

/// From `begin` to `tip`, in world [m].
struct Arrow {
  Vector3 begin, tip;
  double shaft_radius, head_radius, head_length;  ///< [m]; the head is at most as long as the arrow
};

/// Lit as by add_lit(). Valid until the layer's next call.
visualization_msgs::Marker& add_arrow(const Arrow& arrow, const std_msgs::ColorRGBA& paint, int id,
                                      const MarkerLayer& layer);

/// Contacts of hands with bodies. `contacts`: a dot at each; `friction`: a ring on the surface around it,
/// green while sticking, yellow while slipping; `forces`: an arrow behind the finger, whose length grows with
/// the force, and one from an object along the force of grasp assist on it; `newtons`: the force as a number,
/// at the arrow's end; `share`: a ball coloured by friction utilisation, from blue (none) to orange (full).
void add_contacts(const Scene& scene, const FrameResult& result, const SimulationState& state,
                  const PictureStyle& style, const MarkerLayers& layers);

/// A flat ring about z, between two fractions of a turn: clockwise seen from z, from x on.
struct Ring {
  double inner, outer;  // radii [m]
  double begin = 0.0, end = 1.0;
  double pieces = 36.0;  // in a full turn
};
void add_ring(const Ring& ring, const Pose& place, visualization_msgs::Marker& marker);

/// Target of an object.
struct TargetMark {
  const Body& body;
  Pose pose;              ///< of the body's frame, in world
  double progress = 0.0;  ///< 0 to 1, of the time to hold the object there
  bool reached = false;
  bool waits = false;  ///< a later target: fainter
};

/// The object's shape at its target, translucent: blue, and green once reached. A horizontal ring around it
/// fills with the progress. Ids from `first_id`, one more than the body has visible shapes.
void add_target(const TargetMark& target, int first_id, const MarkerLayer& layer);
double ring_radius(const Body& body);  ///< inner radius of a target's ring [m]

/// Marks the object to be taken: a translucent yellow shell around it, and an arrow from above. Ids from
/// `first_id`, one more than the body has visible shapes.
void add_highlight(const Body& body, const Pose& pose, int first_id, const MarkerLayer& layer);

/// Height of the ground for shadows: the highest horizontal top of a wide fixture below all free bodies; else
/// z = 0.1 m, the height of rviz's grid, or lower if a free body is there.
double ground_height(const Scene& scene);

/// Impacts of hands: a ring on the surface that widens and fades within kSeen.
class ImpactMarkers {
 public:
  static constexpr double kSeen = 0.15;  ///< [s]
  /// Adds the impacts of a frame, at its stamp.
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

/// Vertical shadows of hands and the first free bodies, softer and fainter for higher objects.
class ShadowMarkers {
 public:
  /// Keeps a reference. `ground`: its height [m].
  ShadowMarkers(const Scene& scene, double ground) : scene_(scene), ground_(ground) {}
  /// Adds shadows of objects that have moved, or all; deletes those of hands that are gone.
  void add(const SimulationState& state, const FrameResult& result, bool all, const MarkerLayer& layer);

 private:
  struct Cast {
    std::vector<Vector3> from;  ///< positions of the object when the shadow was last computed
    visualization_msgs::Marker marker;
  };
  template <typename Outlines>
  void add_one(int id, std::vector<Vector3> from, const Outlines& outlines, bool all,
               const MarkerLayer& layer);

  const Scene& scene_;
  const double ground_;
  std::map<int, Cast> casts_;
};

/// One line that tells the participant what to do now.
std::string instruction_now(const Session& session, bool paused, bool begins_by_itself);

/// Markers of a session for rviz, in the status's frame, with a namespace for each layer: `target` (its ring
/// fills with the time held), `places` (the other targets, fainter, with their numbers), `path`, `object`
/// (highlighted until held; `seen`: empty if absent), `instructions`, `timer` and `result`. They expire
/// unless repeated. Text is nearer to the camera of rviz/training.rviz than the hands' workspace.
visualization_msgs::MarkerArray training_markers(const Session& session, const Body& body,
                                                 const mr_hand_interaction::TrainingStatus& status,
                                                 const std::optional<mr_hand_interaction::ObjectState>& seen);

}  // namespace mrhi
