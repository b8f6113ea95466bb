#include "mr_hand_interaction/collision/contact_finder.h"

#include <algorithm>
#include <variant>

#include "mr_hand_interaction/collision/god_object.h"
#include "mr_hand_interaction/collision/sweep.h"

namespace mrhi {
namespace {

/// Contacts are followed from this gap on, plus what the pair can close within a step [m].
constexpr double kMargin = 0.001;

struct LocalClosest {
  const Capsule& capsule;
  const MeshCollider* mesh;
  double margin;

  std::optional<ClosestFeatures> operator()(const Sphere& s) const { return capsule_sphere(capsule, s); }
  std::optional<ClosestFeatures> operator()(const Box& b) const { return capsule_box(capsule, b); }
  std::optional<ClosestFeatures> operator()(const Cylinder& c) const { return capsule_cylinder(capsule, c); }
  std::optional<ClosestFeatures> operator()(const Mesh&) const { return mesh->closest(capsule, margin); }
};

/// Half the size of an axis-aligned box about the capsule.
Vector3 half_size(const Capsule& capsule) {
  return 0.5 * (capsule.end - capsule.start).cwiseAbs() + Vector3::Constant(capsule.radius);
}

/// True if the capsule is outside an axis-aligned cube about `centre`.
bool beside(const Capsule& capsule, const Vector3& centre, double half) {
  const double reach = half + capsule.radius;
  for (int i = 0; i < 3; ++i) {
    const double from = capsule.start[i] - centre[i], to = capsule.end[i] - centre[i];
    if (std::min(from, to) > reach || std::max(from, to) < -reach) return true;
  }
  return false;
}

/// A quick look before the closed form is asked; in the shape's frame.
struct FarApart {
  const Capsule& capsule;
  double margin;

  bool operator()(const Box& box) const {
    const Vector3 gap = capsule.centre().cwiseAbs() - half_size(capsule) - box.half_extents;
    return gap.maxCoeff() > margin;
  }
  template <typename Other>
  bool operator()(const Other&) const {
    return false;
  }
};

}  // namespace

ContactFinder::ContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity,
                             const ContactConfiguration& refinements)
    : scene_(scene), geometry_(geometry), gravity_(gravity), refinements_(refinements) {
  found_.reserve(64 * kMaxHands);
}

void ContactFinder::find(const std::vector<HandMotion>& hands, const Neighbours& neighbours,
                         const std::vector<BodyState>& bodies, double step, std::vector<Contact>& contacts) {
  found_.clear();
  memory_ = 0;
  for (const HandMotion& motion : hands) {
    const MovingHand& hand = motion.hand();
    for (const int body : neighbours.near_hand(hand.slot)) {
      find_pair(hand, body, bodies[static_cast<std::size_t>(body)], step, contacts);
    }
  }
  const auto in_order = [](const Contact& a, const Contact& b) { return a.key < b.key; };
  if (!std::is_sorted(found_.begin(), found_.end(), in_order))
    std::sort(found_.begin(), found_.end(), in_order);
  contacts.swap(found_);
}

std::optional<ClosestFeatures> ContactFinder::closest(const Capsule& capsule, int body, int shape,
                                                      const Pose& body_pose, double margin) const {
  const auto b = static_cast<std::size_t>(body), i = static_cast<std::size_t>(shape);
  const PlacedShape& placed = scene_.bodies[b].shapes[i];
  const Pose pose = body_pose * placed.pose;
  const Matrix3 rotation = pose.orientation.toRotationMatrix();
  const Capsule local{rotation.transpose() * (capsule.start - pose.position),
                      rotation.transpose() * (capsule.end - pose.position), capsule.radius};
  if (std::visit(FarApart{local, margin}, placed.shape)) return std::nullopt;
  auto features = std::visit(LocalClosest{local, geometry_.meshes[b][i].get(), margin}, placed.shape);
  if (!features || features->distance > margin) return std::nullopt;
  features->normal = rotation * features->normal;
  features->point = rotation * features->point + pose.position;
  return features;
}

void ContactFinder::find_pair(const MovingHand& hand, int body_index, const BodyState& state, double step,
                              const std::vector<Contact>& before) {
  const Body& body = scene_.bodies[static_cast<std::size_t>(body_index)];
  const double linear_speed = body.fixed ? 0.0 : state.linear_momentum.norm() / body.mass;
  const double falls = body.fixed ? 0.0 : 0.5 * step * gravity_.norm();
  // However it spins, the body stays in its sphere.
  const double farthest = body.bounding_radius + kMargin + (hand.top_speed + linear_speed + falls) * step;
  std::optional<MovingBody> moving;
  double body_speed = 0.0;
  frames_.clear();
  for (int c = 0; c < kCapsules; ++c) {
    const auto ci = static_cast<std::size_t>(c);
    const Capsule& capsule = hand.capsules[ci];
    if (capsule.radius <= 0.0 || beside(capsule, state.pose.position, farthest)) continue;
    if (!moving) {
      moving.emplace(body, state, gravity_);
      body_speed = linear_speed + falls + moving->twist.angular.norm() * body.bounding_radius;
      for (const PlacedShape& placed : body.shapes)
        frames_.push_back({moving->rotation * placed.pose.orientation.toRotationMatrix(),
                           moving->to_world(placed.pose.position)});
    }
    const double speed = std::max(hand.start_velocity[ci].norm(), hand.end_velocity[ci].norm()) + body_speed;
    const double margin = refinements_.sweep ? kMargin + speed * step : kMargin;
    for (int shape = 0; shape < static_cast<int>(body.shapes.size()); ++shape) {
      find_touch({hand, c, body_index, shape, *moving, refinements_},
                 frames_[static_cast<std::size_t>(shape)], step, margin, before);
    }
  }
}

void ContactFinder::find_touch(const TouchingPair& pair, const PlacedFrame& frame, double step, double margin,
                               const std::vector<Contact>& before) {
  const auto b = static_cast<std::size_t>(pair.body_index), i = static_cast<std::size_t>(pair.shape_index);
  const Shape& shape = pair.moving.body.shapes[i].shape;
  const Capsule& capsule = pair.hand.capsules[static_cast<std::size_t>(pair.capsule)];
  const Capsule local{frame.rotation.transpose() * (capsule.start - frame.position),
                      frame.rotation.transpose() * (capsule.end - frame.position), capsule.radius};
  if (std::visit(FarApart{local, margin}, shape)) return;
  auto features = std::visit(LocalClosest{local, geometry_.meshes[b][i].get(), margin}, shape);
  if (!features || features->distance > margin) return;
  if (features->distance > kMargin) {
    features = swept(pair, step, margin);
    if (!features) return;
    const Vector3 normal = frame.rotation.transpose() * features->normal;
    const Vector3 point = frame.rotation.transpose() * (features->point - frame.position);
    const AxisSpan span =
        contact_span(local, shape, {features->distance, normal, point, features->axis_parameter});
    return touch(pair, *features, span, before);
  }
  const AxisSpan span = contact_span(local, shape, *features);
  features->normal = frame.rotation * features->normal;
  features->point = frame.rotation * features->point + frame.position;
  touch(pair, *features, span, before);
}

std::optional<ClosestFeatures> ContactFinder::swept(const TouchingPair& pair, double step,
                                                    double margin) const {
  const auto c = static_cast<std::size_t>(pair.capsule);
  const Capsule& capsule = pair.hand.capsules[c];
  const MovingBody& moving = pair.moving;
  const auto separation = [&](double time) -> std::optional<Separation<ClosestFeatures>> {
    const Capsule then{capsule.start + time * pair.hand.start_velocity[c],
                       capsule.end + time * pair.hand.end_velocity[c], capsule.radius};
    const Pose pose = moving.at(time);
    const auto features = closest(then, pair.body_index, pair.shape_index, pose, margin);
    if (!features) return std::nullopt;
    const Vector3 hand_velocity = pair.hand.surface_velocity(pair.capsule, features->axis_parameter,
                                                             -capsule.radius * features->normal);
    const Vector3 relative = hand_velocity - moving.velocity(time, features->point - pose.position);
    return Separation<ClosestFeatures>{*features, features->distance, features->normal.dot(relative)};
  };
  const auto touch = first_touch<ClosestFeatures>(separation, step);
  if (!touch) return std::nullopt;
  // Told where the body is now: the place on its surface that will be met.
  const Pose then = moving.at(touch->time);
  ClosestFeatures features = touch->features;
  features.point = moving.to_world(then.to_local(features.point));
  features.normal = moving.rotation * (then.orientation.conjugate() * features.normal);
  features.distance =
      features.normal.dot(capsule.axis_point(features.axis_parameter) - features.point) - capsule.radius;
  return features;
}

void ContactFinder::touch(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                          const std::vector<Contact>& before) {
  const ContactKey key{static_cast<std::uint16_t>(pair.body_index), static_cast<std::uint8_t>(pair.hand.slot),
                       static_cast<std::uint8_t>(pair.capsule), static_cast<std::uint8_t>(pair.shape_index),
                       0};
  // Pairs come in the order of their keys, but for several hands.
  if (memory_ == before.size() || key < before[memory_].key) memory_ = 0;
  while (memory_ < before.size() && before[memory_].key < key) ++memory_;
  const auto first = before.begin() + static_cast<std::ptrdiff_t>(memory_);
  auto last = first;
  while (last != before.end() && last->key.same_pair(key)) ++last;
  const bool apart = features.distance > kSeparation;
  const int count = apart ? 0 : static_cast<int>(last - first);
  const std::size_t size = found_.size();
  update_god_objects(pair, features, span, count > 0 ? &*first : nullptr, count, found_);
  for (std::size_t i = size; apart && i < found_.size(); ++i) found_[i].ignored = found_[i].struck = false;
}

}  // namespace mrhi
