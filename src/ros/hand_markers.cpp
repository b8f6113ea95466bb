#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "../math/rotation.h"
#include "../simulation/contact_phase.h"
#include "../text/text.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

const HandStyle kHandStyle{color(0.91, 0.76, 0.65), color(0.84, 0.28, 0.06), 1.0};
/// Thinner, so that it is hidden in the rendered hand where the two coincide.
const HandStyle kGhostStyle{color(0.337, 0.706, 0.914, 0.45), color(0.337, 0.706, 0.914, 0.45), 0.75};

void add_bone(const Capsule& bone, bool with_start, const HandStyle& style, const std_msgs::ColorRGBA& skin,
              int id, const MarkerLayer& layer) {
  const double diameter = 2.0 * style.thickness * bone.radius;
  const Vector3 ball = Vector3::Constant(diameter);
  layer.add(id, Marker::SPHERE, {bone.end}, ball, skin);
  if (with_start) layer.add(id + 1, Marker::SPHERE, {bone.start}, ball, skin);
  const double length = (bone.end - bone.start).norm();
  if (length < 1e-6) return;
  layer.add(id + 2, Marker::CYLINDER,
            {bone.centre(), rotation_between(Vector3::UnitZ(), bone.end - bone.start)},
            {diameter, diameter, length}, skin);
}

bool follows_another(const Hand& hand, int index) {
  if (bone_of(index) == 0 || !hand.has(index - 1)) return false;
  return (hand.capsules[index].start - hand.capsules[index - 1].end).norm() < 1e-6;
}

constexpr double kMaxArrowLength = 0.12;      // of an arrow for an infinite force [m]
constexpr double kHalfLengthForce = 3.0;      // force whose arrow is half as long [N]
constexpr double kLetterHeight = 0.009;       // height of a force's number [m]
constexpr double kNumberGap = 0.017;          // from an arrow to the middle of its number [m]
constexpr double kMinArrowLength = 0.004;     // [m]
constexpr double kFingerGap = 0.002;          // between the arrow and the back of the finger [m]
constexpr double kPointSize = 0.005;          // [m]
constexpr double kRingSegments = 28.0;        // of a ring
constexpr double kLiftAboveSurface = 0.0006;  // of a ring above the surface [m]
constexpr double kHalfWidthImpulse = 0.02;    // impulse whose ring widens half as far as the widest [N s]
constexpr double kMaxGrowth = 0.03;           // largest growth of a ring's radius [m]
constexpr double kInitialWidth = 0.004;       // initial width of an impact's ring [m]

Pose on_surface(const Vector3& point, const Vector3& normal) {
  return {point + kLiftAboveSurface * normal, rotation_between(Vector3::UnitZ(), normal)};
}

/// Rings of one colour, set at each vertex too; rviz would otherwise light them and leave their sides black.
void add_rings(const std::vector<Contact>& contacts, ContactPhase of_phase, const PictureStyle& style, int id,
               const MarkerLayer& layer) {
  const std_msgs::ColorRGBA paint = of_phase == ContactPhase::sticking ? style.sticks : style.slips;
  Marker* rings = nullptr;
  for (const Contact& contact : contacts) {
    if (phase(contact) != of_phase) continue;
    if (!rings) rings = &layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), paint);
    add_ring({0.9 * contact.radius, 1.15 * contact.radius, 0.0, 1.0, kRingSegments},
             on_surface(contact.point, contact.normal), *rings);
  }
  if (rings) rings->colors.resize(rings->points.size(), paint);
}

/// Distance from a body's centre of mass to its surface, or to its bounding sphere if there is none [m].
double surface_distance(const Body& body, const Pose& pose, const Vector3& direction) {
  double farthest = 0.0;
  for (const PlacedShape& placed : body.shapes) {
    const Pose at = pose * placed.pose;
    const Quaternion to_shape = at.orientation.conjugate();
    const Vector3 centre = to_shape * (pose.position - at.position), along = to_shape * direction;
    const auto exit = [&](const auto& shape) { return shape.exit_distance(centre, along); };
    farthest = std::max(farthest, std::visit(exit, placed.shape).value_or(0.0));
  }
  return farthest > 0.0 ? farthest : body.bounding_radius;
}

/// Adds a force's arrow, and its number at the arrow's outer end. The inner end is `distance` from `place`:
/// against the force, which then pushes (contacts), or along it, which then pulls (grasp assist) [m].
struct ForceMarkers {
  const PictureStyle& style;
  const MarkerLayer &arrows, &numbers;
  int id = 0;

  void add(const Vector3& force, const Vector3& place, double distance, bool pulls) {
    const int this_id = id++;
    const double newtons = force.norm();
    if (newtons < style.least_force) return;
    const double length = kMaxArrowLength * newtons / (newtons + kHalfLengthForce);
    if (length < kMinArrowLength) return;
    const Vector3 outwards = (pulls ? 1.0 : -1.0) / newtons * force;
    const Vector3 inner = place + distance * outwards, outer = inner + length * outwards;
    const std_msgs::ColorRGBA& paint = pulls ? style.assist : style.forces;
    add_arrow({pulls ? inner : outer, pulls ? outer : inner, 0.00175, 0.0045, std::min(0.014, 0.5 * length)},
              paint, this_id, arrows);
    numbers
        .add(this_id, Marker::TEXT_VIEW_FACING, {outer + kNumberGap * outwards},
             Vector3::Constant(kLetterHeight), paint)
        .text = text::format("%.1f N", newtons);
  }
};

/// Blue to orange by way of white, which colour-blind people can distinguish.
std_msgs::ColorRGBA utilisation_color(double utilisation) {
  const Vector3 blue(0.000, 0.447, 0.698), white(1.0, 1.0, 1.0), orange(0.835, 0.369, 0.000);
  const double s = std::clamp(utilisation, 0.0, 1.0);
  const Vector3 mixed = s < 0.5 ? Vector3(blue + 2.0 * s * (white - blue))
                                : Vector3(white + (2.0 * s - 1.0) * (orange - white));
  return color(mixed.x(), mixed.y(), mixed.z());
}

}  // namespace

float ghost_opacity(double distance, const PictureStyle& style) {
  const double seen =
      std::clamp((distance - style.ghost_from) / (style.ghost_full - style.ghost_from), 0.0, 1.0);
  return style.ghost.a * static_cast<float>(seen);
}

Rgb ghost_colour(const Vector3& normal, const PictureStyle& style) {
  const auto light = static_cast<float>(0.85 + 0.15 * normal.z());
  return light * Rgb(style.ghost.r, style.ghost.g, style.ghost.b);
}

void HandMarkers::add(const FrameResult& result, const SimulationState& state, const PictureStyle& style,
                      const MarkerLayers& layers) {
  const MarkerLayer hand = layers.layer("hand"), ghost = layers.layer("ghost"),
                    capsules = layers.layer("capsules");
  int id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, id += kIdsPerHand) {
    const RenderedHand& rendered = result.rendered[i];
    const Hand& tracked = result.tracked[i];
    const bool apart = farthest_joint(rendered.hand, tracked) > style.ghost_from;
    if (!skin_.pose(rendered.hand, surface_)) {
      add_capsules(rendered.hand, rendered.touching, kHandStyle, id, hand);
      if (apart) add_capsules(tracked, {}, kGhostStyle, id, ghost);
    } else if (style.skins) {
      press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
      paint_skin(skin_, rendered, surface_, colours_);
      alphas_.assign(skin_.size(), 1.0f);
      add_skin(skin_, rendered.hand.side, id, hand);
      if (apart && pose_ghost(rendered.hand, tracked, style)) add_skin(outline_, tracked.side, id, ghost);
    }
    add_capsules(rendered.hand, rendered.touching, kHandStyle, id, capsules);
  }
}

bool HandMarkers::pose_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style) {
  if (!outline_.pose(tracked, surface_) || !outline_.pose(rendered, beneath_)) return false;
  alphas_.resize(outline_.size());
  colours_.resize(outline_.size());
  for (std::size_t v = 0; v < outline_.size(); ++v) {
    alphas_[v] = ghost_opacity((surface_.vertices[v] - beneath_.vertices[v]).norm(), style);
    colours_[v] = ghost_colour(surface_.normals[v], style);
  }
  return true;
}

void HandMarkers::recycle(std::vector<Marker>& markers) {
  spare_.clear();
  for (Marker& marker : markers)
    if (marker.ns == "hand" || marker.ns == "ghost") spare_.push_back(std::move(marker));
}

/// Adds the visible triangles of the surface, counter-clockwise from outside for both left and right hands.
void HandMarkers::add_skin(const Skin& skin, Side side, int id, const MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  const auto spare =
      std::find_if(spare_.begin(), spare_.end(), [&](const Marker& used) { return used.ns == marker.ns; });
  if (spare != spare_.end()) {
    marker.points.swap(spare->points);
    marker.colors.swap(spare->colors);
    spare_.erase(spare);
  }
  marker.points.clear();
  marker.colors.clear();
  marker.points.reserve(3 * skin.triangles().size());
  marker.colors.reserve(3 * skin.triangles().size());
  for (const auto& triangle : skin.triangles()) {
    if (alphas_[triangle[0]] + alphas_[triangle[1]] + alphas_[triangle[2]] <= 0.0f) continue;
    for (const std::size_t corner : {0, 1, 2}) {
      const int v = triangle[side == Side::left ? 2 - corner : corner];
      std_msgs::ColorRGBA& paint = marker.colors.emplace_back();
      paint.r = colours_[v][0], paint.g = colours_[v][1], paint.b = colours_[v][2], paint.a = alphas_[v];
      marker.points.push_back(to_message(surface_.vertices[v]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

void add_capsules(const Hand& hand, const Touching& touching, const HandStyle& style, int first_id,
                  const MarkerLayer& layer) {
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    add_bone(hand.capsules[i], !follows_another(hand, i), style, touching[i] ? style.touching : style.skin,
             first_id + 3 * i, layer);
  }
}

void add_contacts(const Scene& scene, const FrameResult& result, const SimulationState& state,
                  const PictureStyle& style, const MarkerLayers& layers) {
  if (!result.contacts.empty()) {
    const auto add_balls = [&](const char* name, double size, const std_msgs::ColorRGBA& paint) -> Marker& {
      Marker& balls = layers.layer(name).add(0, Marker::SPHERE_LIST, Pose{}, Vector3::Constant(size), paint);
      for (const Contact& contact : result.contacts) balls.points.push_back(to_message(contact.point));
      return balls;
    };
    add_balls("contacts", kPointSize, style.contacts);
    int id = 0;
    for (const auto kind : {ContactPhase::sticking, ContactPhase::slipping})
      add_rings(result.contacts, kind, style, id++, layers.layer("friction"));
    Marker& shares = add_balls("share", 2.0 * kPointSize, color(1.0, 1.0, 1.0));
    for (const Contact& contact : result.contacts) {
      const FrictionUse use = friction_use(contact, scene.bodies[contact.key.body].material);
      shares.colors.push_back(utilisation_color(use.limit > 0.0 ? use.tangential / use.limit : 0.0));
    }
  }
  const MarkerLayer arrows = layers.layer("forces"), numbers = layers.layer("newtons");
  ForceMarkers forces{style, arrows, numbers};
  for (const Contact& contact : result.contacts)
    forces.add(contact.force, contact.point, 2.0 * contact.radius + kFingerGap, false);
  for (const GraspSupport& assist : result.assists) {
    const Pose& pose = state.bodies[assist.body].pose;
    forces.add(assist.force, pose.position,
               surface_distance(scene.bodies[assist.body], pose, assist.force.normalized()) + kFingerGap,
               true);
  }
}

/// An impact that spans several frames gets one ring.
void ImpactMarkers::note(const std::vector<Contact>& contacts, const ros::Time& stamp) {
  for (const Contact& contact : contacts) {
    const double impulse = contact.impulse.norm();
    if (impulse <= 0.0) continue;
    const auto known = std::find_if(impacts_.begin(), impacts_.end(), [&](const Impact& impact) {
      return impact.key.same_pair(contact.key) && seconds_between(impact.last, stamp) < 0.5 * kSeen;
    });
    if (known != impacts_.end()) {
      known->last = stamp;
      known->impulse = std::max(known->impulse, impulse);
    } else {
      impacts_.push_back({stamp, stamp, contact.key, contact.point, contact.normal, contact.radius, impulse});
    }
  }
}

void ImpactMarkers::add(const ros::Time& now, const PictureStyle& style, const MarkerLayer& layer) {
  const auto age = [&](const Impact& impact) { return seconds_between(impact.begin, now); };
  impacts_.erase(
      std::remove_if(impacts_.begin(), impacts_.end(),
                     [&](const Impact& impact) { return age(impact) < 0.0 || age(impact) >= kSeen; }),
      impacts_.end());
  int id = 0;
  for (const Impact& impact : impacts_) {
    if (impact.impulse < style.least_impulse) continue;
    const double elapsed = age(impact) / kSeen;
    const double strength = impact.impulse / (impact.impulse + kHalfWidthImpulse);
    const double inner = impact.radius + (0.35 + elapsed) * strength * kMaxGrowth;
    Marker& ring = layer.add(id++, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), style.impacts);
    add_ring({inner, inner + (1.0 - 0.6 * elapsed) * kInitialWidth}, on_surface(impact.point, impact.normal),
             ring);
    std_msgs::ColorRGBA paint = style.impacts;
    paint.a *= static_cast<float>((1.0 - elapsed) * (1.0 - elapsed));
    ring.colors.assign(ring.points.size(), paint);
  }
}

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

Marker& add_arrow(const Arrow& arrow, const std_msgs::ColorRGBA& paint, int id, const MarkerLayer& layer) {
  constexpr int kSides = 12;
  struct OutlinePoint {
    double along, radius;
  };
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), paint);
  const double length = (arrow.tip - arrow.begin).norm(), neck = length - arrow.head_length;
  const Vector3 along = (arrow.tip - arrow.begin) / length, u = along.unitOrthogonal(), v = along.cross(u);
  const std::array<OutlinePoint, 5> outline{{{0.0, 0.0},  // rotated about the axis
                                             {0.0, arrow.shaft_radius},
                                             {neck, arrow.shaft_radius},
                                             {neck, arrow.head_radius},
                                             {length, 0.0}}};
  const auto out = [&](int side) -> Vector3 {
    const double turn = 2.0 * M_PI * side / kSides;
    return std::cos(turn) * u + std::sin(turn) * v;
  };
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const OutlinePoint &from = outline[i], &to = outline[i + 1];
    const auto add = [&](const OutlinePoint& point, int side) {
      const Vector3 normal = (to.along - from.along) * out(side) - (to.radius - from.radius) * along;
      add_lit(arrow.begin + point.along * along + point.radius * out(side), normal.normalized(), paint,
              marker);
    };
    for (int side = 0; side < kSides; ++side) {
      if (to.radius > 0.0) add(from, side), add(to, side + 1), add(to, side);
      if (from.radius > 0.0) add(from, side), add(from, side + 1), add(to, to.radius > 0.0 ? side + 1 : side);
    }
  }
  return marker;
}

}  // namespace mrhi
