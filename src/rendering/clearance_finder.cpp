#include "clearance_finder.h"

#include <algorithm>
#include <limits>

namespace mrhi {
namespace {

/// Farther than this from a body a hand was on no side of it [m].
constexpr double kFarthest = 0.5;
constexpr double kRound = 0.005;  // [m]
constexpr double kFlat = 1e-4;    // [m]
/// Normals of one side of a body differ by no more than this (cosine).
constexpr double kSameSide = 0.5;

struct Extent {
  Vector3 min, max;
};

Extent extent(const Hand& hand) {
  Extent extent{Vector3::Constant(std::numeric_limits<double>::max()),
                Vector3::Constant(std::numeric_limits<double>::lowest())};
  for (const Capsule& capsule : hand.capsules) {
    if (capsule.radius <= 0.0) continue;
    const Vector3 radius = Vector3::Constant(capsule.radius);
    extent.min = extent.min.cwiseMin(capsule.start.cwiseMin(capsule.end) - radius);
    extent.max = extent.max.cwiseMax(capsule.start.cwiseMax(capsule.end) + radius);
  }
  return extent;
}

const Contact* touching(const std::vector<Contact>& contacts, int slot, int capsule, int body, int shape) {
  for (const Contact& contact : contacts) {
    const ContactKey& key = contact.key;
    if (key.hand == slot && key.capsule == capsule && key.body == body && key.shape == shape &&
        contact.touching())
      return &contact;
  }
  return nullptr;
}

double deepest_end(const Capsule& capsule, const Vector3& normal) {
  return normal.dot(capsule.end - capsule.start) < 0.0 ? 1.0 : 0.0;
}

/// Of a capsule above a plane [m].
double height(const Capsule& capsule, const Vector3& normal, const Vector3& point) {
  return std::min(normal.dot(capsule.start - point), normal.dot(capsule.end - point)) - capsule.radius;
}

bool outside(const Capsule& capsule, const Vector3& normal, const Vector3& point) {
  return height(capsule, normal, point) > -ClearanceFinder::kShallow;
}

/// No plane that keeps a capsule out of a shape is nearer than the nearest way out; where a shape is hollow,
/// or has turned, a plane of before may be. A plane has all of a convex shape below it, so that the height
/// above it is a bound from below of the distance: larger than the distance it is no such plane.
bool keeps_out(const Capsule& capsule, const Vector3& normal, const Vector3& point, double distance) {
  return height(capsule, normal, point) <= distance + kFlat;
}

/// n.a(s) - height - r, with n.x = height the plane and r the capsule's radius.
double gap(const Capsule& capsule, const Clearance& clearance) {
  return clearance.normal.dot(capsule.axis_point(clearance.s)) - clearance.height - capsule.radius;
}

/// The entry of this key, made if there is none. What is known of another side of the shape goes.
Clearance& entry(const ContactKey& key, const Vector3& normal, std::vector<Clearance>& clearances) {
  const auto other_side = [&](const Clearance& known) {
    return known.key.same_pair(key) && known.normal.dot(normal) < kSameSide;
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

/// The box about the tracked hand against the ball about each body: by the squares of what the ball's centre
/// is beyond the box.
bool ClearanceFinder::begin(const Setting& setting, double margin) {
  near_.clear();
  shown_in_.clear();
  const Extent hand = extent(setting.tracked);
  for (std::size_t b = 0; b < setting.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    const Pose& pose = setting.bodies[b].pose;
    const Vector3 outside = (hand.min - pose.position).cwiseMax(pose.position - hand.max).cwiseMax(0.0);
    const double reach = body.bounding_radius + margin;
    if (outside.squaredNorm() > reach * reach) continue;
    const ContactFinder::PlacedFrame frame{pose.orientation.toRotationMatrix(), pose.position};
    std::vector<Near>& list = setting.interactions[b].shown_in ? shown_in_ : near_;
    for (int shape = 0; shape < static_cast<int>(body.shapes.size()); ++shape)
      list.push_back({static_cast<int>(b), shape, frame, pose.position, body.bounding_radius});
  }
  return !near_.empty();
}

void ClearanceFinder::end_shown_in(const Hand& shown, Interaction* interactions) const {
  for (const Near& near : shown_in_) interactions[near.body].shown_in = false;
  each_near(shown_in_, shown, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    if (finder_.closest(capsule, near.body, near.shape, near.frame, 0.0))
      interactions[near.body].shown_in = true;
  });
}

/// |v| + |w| R.
double ClearanceFinder::fastest_body(const std::vector<BodyState>& bodies) const {
  double fastest = 0.0;
  for (const Near& near : near_) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(near.body)];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, bodies[static_cast<std::size_t>(near.body)]);
    fastest = std::max(fastest, twist.linear.norm() + twist.angular.norm() * near.radius);
  }
  return fastest;
}

Vector3 ClearanceFinder::velocity(int body, const Vector3& point,
                                  const std::vector<BodyState>& bodies) const {
  const auto b = static_cast<std::size_t>(body);
  if (scene_.bodies[b].fixed) return Vector3::Zero();
  const Twist twist = twist_of(scene_.bodies[b], bodies[b]);
  return twist.linear + twist.angular.cross(point - bodies[b].pose.position);
}

/// Near is who is so by the balls about capsule and body.
template <typename See>
void ClearanceFinder::each_near(const std::vector<Near>& bodies, const Hand& hand, double margin,
                                const See& see) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(c)];
    if (capsule.radius <= 0.0) continue;
    const Vector3 centre = capsule.centre();
    const double around = 0.5 * (capsule.end - capsule.start).norm() + capsule.radius + margin;
    for (const Near& near : bodies) {
      const double reach = near.radius + around;
      if ((centre - near.centre).squaredNorm() <= reach * reach) see(c, capsule, near);
    }
  }
}

/// What was found in earlier passes stays, measured with its plane of then: dropped, a gap that has been
/// closed by its pressure would open again, and the passes would go to and fro.
double ClearanceFinder::find(const Hand& placed, const Setting& setting, double margin,
                             std::vector<Clearance>& clearances) const {
  double least = margin;
  each_near(near_, placed, margin, [&](int c, const Capsule& capsule, const Near& near) {
    AxisSpan span{};
    const auto features = finder_.closest(capsule, near.body, near.shape, near.frame, margin, &span);
    if (!features) return;
    const Face found = face(placed, c, near, *features, span, setting);
    const bool flat = found.s0 < found.s1;
    for (int end = 0; end < (flat ? 2 : 1); ++end) {
      const double s = end == 0 ? found.s0 : found.s1;
      const ContactKey key{static_cast<std::uint8_t>(flat ? end : s > 0.5),
                           static_cast<std::uint8_t>(near.shape), static_cast<std::uint8_t>(c),
                           static_cast<std::uint8_t>(setting.slot), static_cast<std::uint16_t>(near.body)};
      Clearance& clearance = entry(key, found.normal, clearances);
      clearance.s = s;
      clearance.normal = found.normal;
      clearance.height = found.normal.dot(found.point);
    }
  });
  for (Clearance& clearance : clearances) {
    clearance.gap = gap(placed.capsules[clearance.key.capsule], clearance);
    least = std::min(least, clearance.gap);
  }
  return least;
}

bool ClearanceFinder::clear(const Hand& hand) const {
  bool clear = true;
  each_near(near_, hand, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    clear = clear && !finder_.closest(capsule, near.body, near.shape, near.frame, 0.0);
  });
  return clear;
}

/// The face that the capsule keeps to. Deep inside the nearest way out may lead through the body: then it is
/// the side on which the capsule was shown last, told by the god object if it is on that side too. In order:
/// shallow, the nearest surface; the god object's plane, if the hand was shown on its side; the plane that
/// was nearest before. A plane of before is no longer believed once it asks for more than the hand and bodies
/// have moved.
ClearanceFinder::Face ClearanceFinder::face(const Hand& placed, int c, const Near& near,
                                            const ClosestFeatures& features, const AxisSpan& span,
                                            const Setting& setting) const {
  const Face nearest{features.normal, features.point, span.s0, span.s1};
  if (features.distance > -kShallow) return nearest;
  const auto i = static_cast<std::size_t>(c);
  const Capsule& capsule = placed.capsules[i];
  const Capsule* before = setting.shown_before == nullptr ? nullptr : &setting.shown_before->capsules[i];
  if (const Contact* contact = touching(setting.contacts, setting.slot, c, near.body, near.shape)) {
    const bool same_side = before == nullptr || outside(*before, contact->normal, contact->point);
    if (same_side && contact->normal.dot(features.normal) >= kSameSide) return nearest;
    const double s = deepest_end(capsule, contact->normal);
    const bool keeps = keeps_out(capsule, contact->normal, contact->point, features.distance);
    if (same_side && keeps) return {contact->normal, contact->point, s, s};
  }
  if (before == nullptr || before->radius <= 0.0) return nearest;
  const auto last = finder_.closest(*before, near.body, near.shape, near.frame, kFarthest);
  if (!last || last->distance < -kShallow || last->normal.dot(features.normal) >= kSameSide) return nearest;
  // A way that is longer than what the hand has gone leads around a corner.
  const double s = features.axis_parameter;
  // r - n.(a - q): by how much the capsule is below the plane of before.
  const double way = capsule.radius - last->normal.dot(capsule.axis_point(s) - last->point);
  if (way > setting.moved + kRound) return nearest;
  if (!keeps_out(capsule, last->normal, last->point, features.distance)) return nearest;
  return {last->normal, last->point, s, s};
}

}  // namespace mrhi
