#include "contact_finder.h"

#include <algorithm>
#include <cmath>

#include "segment.h"
#include "step_motion.h"

namespace mrhi {
namespace {

/// Largest gap of a contact, plus the distance that the pair can close within a step [m]. Larger than
/// kSeparation, so that a contact loses its memory before it ends: a phalanx that returns causes a new
/// impact.
constexpr double kMargin = 0.001;

/// True if the ball about a shape is farther from a capsule than the margin, both in the body's frame.
bool is_beyond(const Capsule& capsule, const PlacedCollider& shape, double margin) {
  const Vector3 along = capsule.end - capsule.start;
  const Vector3 nearest = capsule.start + foot(capsule.start, along, shape.pose.position) * along;
  const double reach = capsule.radius + shape.bounding_radius + margin;
  return (nearest - shape.pose.position).squaredNorm() > reach * reach;
}

}  // namespace

ContactFinder::ContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity,
                             const ContactConfiguration& refinements)
    : scene_(scene), geometry_(geometry), gravity_(gravity), refinements_(refinements) {
  found_.reserve(64 * kMaxHands);
  factors_.reserve(64);
}

/// Contacts of one hand are found in the keys' order; those of two hands interleave.
void ContactFinder::find(const std::vector<HandMotion>& hands, const Neighbours& neighbours,
                         const std::vector<BodyState>& bodies, double step, std::vector<Contact>& contacts) {
  found_count_ = 0;
  for (const HandMotion& motion : hands) {
    const MovingHand& hand = motion.hand();
    for (const NearBody& near : neighbours.near_hand(hand.slot))
      find_pair(hand, near, bodies[near.body], step, contacts);
  }
  found_.resize(found_count_);
  if (hands.size() > 1) {
    std::sort(found_.begin(), found_.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
  contacts.swap(found_);
}

std::optional<ClosestFeatures> ContactFinder::closest(const Capsule& capsule, int body, int shape,
                                                      const Pose& body_pose, double margin) const {
  return closest(capsule, body, shape, {body_pose.orientation.toRotationMatrix(), body_pose.position},
                 margin);
}

std::optional<ClosestFeatures> ContactFinder::closest(const Capsule& capsule, int body, int shape,
                                                      const PlacedFrame& frame, double margin,
                                                      AxisSpan* span) const {
  const PlacedCollider& collider = geometry_.colliders[body][shape];
  const Capsule in_body{frame.rotation.transpose() * (capsule.start - frame.position),
                        frame.rotation.transpose() * (capsule.end - frame.position), capsule.radius};
  const Capsule in_shape = collider.to_shape(in_body);
  auto features = collider.closest(in_shape, margin);
  if (!features) return std::nullopt;
  if (span != nullptr) *span = collider.span(in_shape, *features);
  features = collider.to_body(*features);
  features->normal = frame.rotation * features->normal;
  features->point = frame.rotation * features->point + frame.position;
  return features;
}

/// No point of the body is faster than |v| + |w| R + |g| h / 2 on average through the step h, and no phalanx
/// faster than its faster end. Clearances hold for the hand's path in the frame, less the body's displacement
/// since they were measured.
void ContactFinder::find_pair(const MovingHand& hand, const NearBody& near, const BodyState& state,
                              double step, const std::vector<Contact>& before) {
  const Body& body = scene_.bodies[near.body];
  const MovingBody moving(body, state, gravity_);
  const double body_speed = moving.twist.linear.norm() + moving.twist.angular.norm() * body.bounding_radius +
                            0.5 * step * moving.acceleration.norm();
  const ContactKey first{0, 0, 0, static_cast<std::uint8_t>(hand.slot),
                         static_cast<std::uint16_t>(near.body)};
  memory_ = std::lower_bound(before.data(), before.data() + before.size(), first,
                             [](const Contact& contact, const ContactKey& key) { return contact.key < key; });
  const int shapes = static_cast<int>(body.shapes.size());
  const double moved = near.moved(state.pose, body.bounding_radius);
  const double carried_speed = hand.carried_speed(state.pose.position, body.bounding_radius);
  for (int i = 0; i < near.count; ++i) {
    const int c = near.capsules[i];
    const double speed = hand.speed[c] + carried_speed + body_speed;
    const double margin = refinements_.sweep ? kMargin + speed * step : kMargin;
    if (near.clearances[i] - moved > margin) continue;
    const Capsule in_world = hand.capsule(c), in_body = moving.to_local(in_world);
    const std::size_t found_before = found_count_;
    for (int shape = 0; shape < shapes; ++shape) {
      if (shapes > 1 && is_beyond(in_body, geometry_.colliders[near.body][shape], margin)) continue;
      find_touch({hand, c, in_world, in_body, near.body, shape, moving, refinements_}, step, margin, before);
    }
    if (shapes > 1) share_between_shapes(found_before);
  }
}

/// Limits a phalanx's force on a body of several shapes to that of its whole stiffness at its deepest point.
/// Points on perpendicular faces are independent, by c_ij = max(0, n_i.n_j):
///
///     share_i <- share_i min(1, max_j c_ij d_j / sum_j c_ij share_j d_j)
void ContactFinder::share_between_shapes(std::size_t first) {
  if (found_count_ - first < 2 || found_[first].key.shape == found_[found_count_ - 1].key.shape) return;
  const auto begin = found_.begin() + static_cast<std::ptrdiff_t>(first),
             end = found_.begin() + static_cast<std::ptrdiff_t>(found_count_);
  factors_.clear();
  for (auto one = begin; one != end; ++one) {
    double deepest = 0.0, sum = 0.0;
    for (auto other = begin; other != end; ++other) {
      const double depth = std::max(0.0, one->normal.dot(other->normal)) *
                           (other->ignored ? 0.0 : std::max(0.0, other->depth));
      deepest = std::max(deepest, depth);
      sum += other->share * depth;
    }
    factors_.push_back(sum > deepest ? deepest / sum : 1.0);
  }
  for (std::size_t i = 0; i < factors_.size(); ++i)
    begin[static_cast<std::ptrdiff_t>(i)].share *= factors_[i];
}

/// Within kMargin, the present features. Beyond, only if the pair meets within the step, and then the face
/// that it meets with its present distance n.(a(s) - point) - r.
void ContactFinder::find_touch(const TouchingPair& pair, double step, double margin,
                               const std::vector<Contact>& before) {
  const PlacedCollider& collider = geometry_.colliders[pair.body][pair.shape];
  const Capsule in_shape = collider.to_shape(pair.in_body);
  std::optional<ClosestFeatures> found = collider.closest(in_shape, margin);
  if (!found) return;
  const bool is_apart = found->distance > kMargin;
  if (is_apart) found = swept(pair, collider, step, margin);
  if (!found) return;
  ClosestFeatures& features = *found;
  if (is_apart) {
    // The present distance from the point of the surface that will be met.
    features.distance =
        features.normal.dot(in_shape.axis_point(features.axis_parameter) - features.point) - in_shape.radius;
  }
  const AxisSpan span = collider.pad(in_shape, features);
  if (span.s0 == span.s1) features.axis_parameter = span.s0;
  if (!collider.has_bodys_frame()) features = collider.to_body(features);
  touch(pair, features, span, before);
}

/// Eq. 8 of the nearest points gives the rate: n.(c1' - c2'), n from the object to the hand in world.
std::optional<ClosestFeatures> ContactFinder::swept(const TouchingPair& pair, const PlacedCollider& collider,
                                                    double step, double margin) const {
  const MovingBody& moving = pair.moving;
  const auto separation = [&](double time) -> std::optional<Separation<ClosestFeatures>> {
    const Capsule then = pair.hand.capsule(pair.capsule, time);
    const Pose pose = moving.at(time);
    const Capsule in_body_then{pose.to_local(then.start), pose.to_local(then.end), then.radius};
    const auto features = collider.closest(collider.to_shape(in_body_then), margin);
    if (!features) return std::nullopt;
    const ClosestFeatures in_body = collider.to_body(*features);
    const Vector3 normal = pose.orientation * in_body.normal;
    const Vector3 hand_velocity =
        pair.hand.motion(pair.capsule, then).of_surface(in_body.axis_parameter, -then.radius * normal);
    const Vector3 relative = hand_velocity - moving.velocity(time, pose.orientation * in_body.point);
    return Separation<ClosestFeatures>{*features, features->distance, normal.dot(relative)};
  };
  const auto touch = first_touch<ClosestFeatures>(separation, step);
  if (!touch) return std::nullopt;
  return touch->features;
}

/// The capsules and shapes of one hand and body come in the keys' order, so that memory_ only advances.
/// Surfaces farther apart than kSeparation lose their memory, and may touch again if they overlapped when
/// spawned.
void ContactFinder::touch(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                          const std::vector<Contact>& before) {
  const ContactKey key = pair.key(0);
  const Contact* const end = before.data() + before.size();
  while (memory_ != end && memory_->key < key) ++memory_;
  const Contact* last = memory_;
  while (last != end && last->key.same_pair(key)) ++last;
  const bool apart = features.distance > kSeparation;
  const int count = apart ? 0 : static_cast<int>(last - memory_);
  if (found_.size() < found_count_ + 2) found_.resize(found_count_ + 2);
  Contact* now = &found_[found_count_];
  const int found = update_god_objects(pair, features, span, memory_, count, now);
  for (int i = 0; apart && i < found; ++i) now[i].ignored = now[i].struck = false;
  found_count_ += found;
}

}  // namespace mrhi
