#include <algorithm>

#include "renderer.h"

namespace mrhi {
namespace {

/// Largest distance from a body at which a hand was on one side of it [m].
constexpr double kMaxSideDistance = 0.5;
/// Tolerance by which a plane of the previous frame may ask for more than the hand and bodies have moved [m].
constexpr double kRoundness = 0.005;
/// Tolerance of the test that a plane bounds a shape [m].
constexpr double kPlaneTolerance = 1e-4;
/// Smallest cosine between normals of one side of a body.
constexpr double kMinSameSideCosine = 0.5;

const Contact* touching(const HandFrameView& view, int capsule, int body, int shape) {
  const auto found = std::find_if(view.contacts.begin(), view.contacts.end(), [&](const Contact& contact) {
    const ContactKey& key = contact.key;
    return key.hand == view.slot && key.capsule == capsule && key.body == body && key.shape == shape &&
           contact.touching();
  });
  return found == view.contacts.end() ? nullptr : &*found;
}

/// Height of a capsule's surface above a plane [m].
double height(const Capsule& capsule, const Vector3& normal, const Vector3& point) {
  return std::min(normal.dot(capsule.start - point), normal.dot(capsule.end - point)) - capsule.radius;
}

/// True if the plane can bound the shape. The height above a plane that has all of a convex shape below it is
/// a lower bound of the distance. A plane of an earlier frame may violate this if the shape is hollow or has
/// turned.
bool keeps_out(const Capsule& capsule, const Vector3& normal, const Vector3& point, double distance) {
  return height(capsule, normal, point) <= distance + kPlaneTolerance;
}

/// The entry of this key, created if there is none. Removes entries of another side of the shape.
Clearance& entry(const ContactKey& key, const Vector3& normal, std::vector<Clearance>& clearances) {
  const auto other_side = [&](const Clearance& known) {
    return known.key.same_pair(key) && known.normal.dot(normal) < kMinSameSideCosine;
  };
  clearances.erase(std::remove_if(clearances.begin(), clearances.end(), other_side), clearances.end());
  for (Clearance& known : clearances) {
    if (known.key == key) return known;
  }
  clearances.emplace_back();
  clearances.back().key = key;
  return clearances.back();
}

}  // namespace

/// Tests the box about the tracked hand against the bounding sphere of each body.
bool ClearanceFinder::begin(const HandFrameView& view, double margin) {
  view_ = &view;
  near_.clear();
  shown_in_.clear();
  const Eigen::AlignedBox3d hand = box_around(view.track.current);
  for (std::size_t b = 0; b < view.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    const Pose& pose = view.bodies[b].pose;
    if (!is_near(hand, pose.position, body.bounding_radius + margin)) continue;
    const ContactFinder::PlacedFrame frame{pose.orientation.toRotationMatrix(), pose.position};
    std::vector<Near>& list = view.interactions[b].shown_in ? shown_in_ : near_;
    for (int shape = 0; shape < static_cast<int>(body.shapes.size()); ++shape)
      list.push_back({static_cast<int>(b), shape, frame, pose.position, body.bounding_radius});
  }
  return !near_.empty();
}

void ClearanceFinder::end_shown_in(const Hand& shown) const {
  for (const Near& near : shown_in_) view_->interactions[near.body].shown_in = false;
  each_near(shown_in_, shown, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    if (finder_.closest(capsule, near.body, near.shape, near.frame, 0.0))
      view_->interactions[near.body].shown_in = true;
  });
}

/// |v| + |w| R.
double ClearanceFinder::fastest_body() const {
  double fastest = 0.0;
  for (const Near& near : near_) {
    const Body& body = scene_.bodies[near.body];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, view_->bodies[near.body]);
    fastest = std::max(fastest, twist.linear.norm() + twist.angular.norm() * near.radius);
  }
  return fastest;
}

Vector3 ClearanceFinder::velocity(int body, const Vector3& point) const {
  if (fixed(body)) return Vector3::Zero();
  const BodyState& state = view_->bodies[body];
  const Twist twist = twist_of(scene_.bodies[body], state);
  return twist.linear + twist.angular.cross(point - state.pose.position);
}

/// Visits pairs of capsule and body whose bounding spheres are within `margin`.
template <typename See>
void ClearanceFinder::each_near(const std::vector<Near>& bodies, const Hand& hand, double margin,
                                const See& see) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[c];
    if (capsule.radius <= 0.0) continue;
    const Vector3 centre = capsule.centre();
    const double around = 0.5 * (capsule.end - capsule.start).norm() + capsule.radius + margin;
    for (const Near& near : bodies) {
      const double reach = near.radius + around;
      if ((centre - near.centre).squaredNorm() <= reach * reach) see(c, capsule, near);
    }
  }
}

/// Keeps clearances of earlier passes with their planes. Without them a gap that its pressure has closed
/// would open again, and the passes would oscillate.
double ClearanceFinder::find(const Hand& placed, std::vector<Clearance>& clearances) const {
  double min_gap = kLookAhead;
  each_near(near_, placed, kLookAhead, [&](int c, const Capsule& capsule, const Near& near) {
    AxisSpan span{};
    const auto features = finder_.closest(capsule, near.body, near.shape, near.frame, kLookAhead, &span);
    if (!features) return;
    const Face found = face(placed, c, near, *features, span);
    const bool flat = found.s0 < found.s1;
    for (int end = 0; end < (flat ? 2 : 1); ++end) {
      const double s = end == 0 ? found.s0 : found.s1;
      const ContactKey key{static_cast<std::uint8_t>(flat ? end : s > 0.5),
                           static_cast<std::uint8_t>(near.shape), static_cast<std::uint8_t>(c),
                           static_cast<std::uint8_t>(view_->slot), static_cast<std::uint16_t>(near.body)};
      Clearance& clearance = entry(key, found.normal, clearances);
      clearance.s = s;
      clearance.normal = found.normal;
      clearance.height = found.normal.dot(found.point);
    }
  });
  for (Clearance& clearance : clearances) {
    const Capsule& capsule = placed.capsules[clearance.key.capsule];
    clearance.gap = clearance.normal.dot(capsule.axis_point(clearance.s)) - clearance.height - capsule.radius;
    min_gap = std::min(min_gap, clearance.gap);
  }
  return min_gap;
}

bool ClearanceFinder::clear(const Hand& hand) const {
  bool clear = true;
  each_near(near_, hand, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    clear = clear && !finder_.closest(capsule, near.body, near.shape, near.frame, 0.0);
  });
  return clear;
}

/// The face outside which the capsule stays. In order: the nearest surface if the capsule is shallow; the god
/// object's plane if the hand was shown on its side; the plane that was nearest in the previous frame. Deep
/// inside, the nearest surface may be on the far side of the body. A plane of the previous frame is rejected
/// if it asks for more than the hand and bodies have moved.
ClearanceFinder::Face ClearanceFinder::face(const Hand& placed, int c, const Near& near,
                                            const ClosestFeatures& features, const AxisSpan& span) const {
  const Face nearest{features.normal, features.point, span.s0, span.s1};
  if (features.distance > -kMaxShallowDepth) return nearest;
  const Capsule& capsule = placed.capsules[c];
  const Capsule* before = view_->shown_before == nullptr ? nullptr : &view_->shown_before->capsules[c];
  if (const Contact* contact = touching(*view_, c, near.body, near.shape)) {
    const bool same_side =
        before == nullptr || height(*before, contact->normal, contact->point) > -kMaxShallowDepth;
    if (same_side && contact->normal.dot(features.normal) >= kMinSameSideCosine) return nearest;
    const double s = contact->normal.dot(capsule.end - capsule.start) < 0.0 ? 1.0 : 0.0;  // the deeper end
    const bool keeps = keeps_out(capsule, contact->normal, contact->point, features.distance);
    if (same_side && keeps) return {contact->normal, contact->point, s, s};
  }
  if (before == nullptr || before->radius <= 0.0) return nearest;
  const auto last = finder_.closest(*before, near.body, near.shape, near.frame, kMaxSideDistance);
  if (!last || last->distance < -kMaxShallowDepth || last->normal.dot(features.normal) >= kMinSameSideCosine)
    return nearest;
  // A distance longer than the displacement since then leads around a corner.
  const double s = features.axis_parameter;
  // r - n.(a - q): depth of the capsule below that plane.
  const double depth = capsule.radius - last->normal.dot(capsule.axis_point(s) - last->point);
  if (depth > view_->moved + kRoundness) return nearest;
  if (!keeps_out(capsule, last->normal, last->point, features.distance)) return nearest;
  return {last->normal, last->point, s, s};
}

}  // namespace mrhi
