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

Capsule to_local(const Capsule& capsule, const Pose& pose) {
  return {pose.to_local(capsule.start), pose.to_local(capsule.end), capsule.radius};
}

bool spheres_apart(const Capsule& capsule, const Vector3& centre, double radius) {
  const double reach = radius + capsule.radius;
  // Distance to the axis is at least distance to its middle less half its length.
  const double half_length = 0.5 * (capsule.end - capsule.start).norm();
  return (capsule.centre() - centre).norm() > reach + half_length;
}

AxisSpan span_over(const TouchingPair& pair, const ClosestFeatures& features) {
  const PlacedShape& placed = pair.body.shapes[static_cast<std::size_t>(pair.shape_index)];
  const Pose pose = pair.state.pose * placed.pose;
  ClosestFeatures local = features;
  local.normal = pose.orientation.conjugate() * local.normal;
  local.point = pose.to_local(local.point);
  const Capsule& capsule = pair.hand.capsules[static_cast<std::size_t>(pair.capsule)];
  return contact_span(to_local(capsule, pose), placed.shape, local);
}

}  // namespace

ContactFinder::ContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity)
    : scene_(scene), geometry_(geometry), gravity_(gravity) {
  found_.reserve(64 * kMaxHands);
}

void ContactFinder::find(const std::vector<MovingHand>& hands, const Neighbours& neighbours,
                         const std::vector<BodyState>& bodies, double step, std::vector<Contact>& contacts) {
  found_.clear();
  for (const MovingHand& hand : hands) {
    for (const int body : neighbours.near_hand(hand.slot)) {
      find_pair(hand, body, bodies[static_cast<std::size_t>(body)], step, contacts);
    }
  }
  std::sort(found_.begin(), found_.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  contacts.swap(found_);
}

std::optional<ClosestFeatures> ContactFinder::closest(const Capsule& capsule, int body, int shape,
                                                      const Pose& body_pose, double margin) const {
  const auto b = static_cast<std::size_t>(body), i = static_cast<std::size_t>(shape);
  const PlacedShape& placed = scene_.bodies[b].shapes[i];
  const Pose pose = body_pose * placed.pose;
  std::optional<ClosestFeatures> features =
      std::visit(LocalClosest{to_local(capsule, pose), geometry_.meshes[b][i].get(), margin}, placed.shape);
  if (!features || features->distance > margin) return std::nullopt;
  features->normal = pose.orientation * features->normal;
  features->point = pose * features->point;
  return features;
}

void ContactFinder::find_pair(const MovingHand& hand, int body_index, const BodyState& state, double step,
                              const std::vector<Contact>& before) {
  const Body& body = scene_.bodies[static_cast<std::size_t>(body_index)];
  const MovingBody moving(body, state, gravity_);
  const Twist& twist = moving.twist;
  const double falls = 0.5 * step * moving.acceleration.norm();
  for (int c = 0; c < kCapsules; ++c) {
    const auto ci = static_cast<std::size_t>(c);
    const Capsule& capsule = hand.capsules[ci];
    if (capsule.radius <= 0.0) continue;
    const double speed = std::max(hand.start_velocity[ci].norm(), hand.end_velocity[ci].norm()) +
                         twist.linear.norm() + twist.angular.norm() * body.bounding_radius + falls;
    const double margin = kMargin + speed * step;
    if (spheres_apart(capsule, state.pose.position, body.bounding_radius + margin)) continue;
    for (int shape = 0; shape < static_cast<int>(body.shapes.size()); ++shape) {
      const TouchingPair pair{hand, c, body_index, shape, body, state};
      std::optional<ClosestFeatures> features = closest(capsule, body_index, shape, state.pose, margin);
      if (features && features->distance > kMargin) features = swept(pair, moving, step, margin);
      if (features) touch(pair, *features, before);
    }
  }
}

std::optional<ClosestFeatures> ContactFinder::swept(const TouchingPair& pair, const MovingBody& moving,
                                                    double step, double margin) const {
  const auto c = static_cast<std::size_t>(pair.capsule);
  const Capsule& capsule = pair.hand.capsules[c];
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
  features.point = pair.state.pose * then.to_local(features.point);
  features.normal = pair.state.pose.orientation * (then.orientation.conjugate() * features.normal);
  features.distance =
      features.normal.dot(capsule.axis_point(features.axis_parameter) - features.point) - capsule.radius;
  return features;
}

void ContactFinder::touch(const TouchingPair& pair, const ClosestFeatures& features,
                          const std::vector<Contact>& before) {
  const ContactKey key{static_cast<std::uint16_t>(pair.body_index), static_cast<std::uint8_t>(pair.hand.slot),
                       static_cast<std::uint8_t>(pair.capsule), static_cast<std::uint8_t>(pair.shape_index),
                       0};
  const auto first = std::lower_bound(before.begin(), before.end(), key,
                                      [](const Contact& a, const ContactKey& k) { return a.key < k; });
  auto last = first;
  while (last != before.end() && last->key.same_pair(key)) ++last;
  const bool apart = features.distance > kSeparation;
  const int count = apart ? 0 : static_cast<int>(last - first);
  const std::size_t size = found_.size();
  update_god_objects(pair, features, span_over(pair, features), count > 0 ? &*first : nullptr, count, found_);
  for (std::size_t i = size; apart && i < found_.size(); ++i) found_[i].ignored = found_[i].struck = false;
}

}  // namespace mrhi
