#include "closing_hand.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// A finger closes if its aperture shrinks faster than this [m/s],
constexpr double kMinClosingSpeed = 0.03;
/// and than this fraction of its own and its base's speed: a hand that slaps or nudges does not close.
constexpr double kMinClosingRatio = 0.25;
/// Largest distance of a body from the line between a finger and its base [m].
constexpr double kMaxLineDistance = 0.01;
/// Largest distance at which a hand's closest faces are searched [m].
constexpr double kSearchDistance = 0.1;

double distance_from_axis(const Vector3& point, const Capsule& capsule) {
  const Vector3 along = capsule.end - capsule.start;
  const double s = (point - capsule.start).dot(along) / std::max(along.squaredNorm(), 1e-30);
  return (point - capsule.axis_point(std::clamp(s, 0.0, 1.0))).norm();
}

}  // namespace

bool has_tip(const Hand& hand, int finger) {
  return hand.has(capsule_index(finger, 3));
}

bool ClosingHand::closes(const HandTrack& track, bool by_palm, int finger) {
  const Vector3 across = tip_of(track.current, finger) - base_of(track.current, by_palm);
  const auto& points = track.mean_velocity.points;
  const Vector3 &tip = points[tip_point(finger)], &base = points[by_palm ? 0 : tip_point(0)];
  const double least = std::max(kMinClosingSpeed, kMinClosingRatio * std::max(tip.norm(), base.norm()));
  return -across.dot(tip - base) > least * across.norm();
}

std::optional<ClosingHand::Nearest> ClosingHand::nearest(const Capsule& capsule, const Object& object,
                                                         const Poses& poses, double margin) const {
  std::optional<Nearest> result;
  for (std::size_t i = 0; i < object.size(); ++i) {
    const int body = object[i];
    const auto shapes = static_cast<int>(scene_.bodies[body].shapes.size());
    for (int shape = 0; shape < shapes; ++shape) {
      const auto features = finder_.closest(capsule, body, shape, poses[i], margin);
      if (features && (!result || features->distance < result->features.distance))
        result = Nearest{*features, body};
    }
  }
  return result;
}

double ClosingHand::gap(const Hand& hand, bool by_palm, bool of_base, const Object& object,
                        const Poses& poses) const {
  double limit = kSearchDistance;
  for (int c = 0; c < kCapsules; ++c) {
    if (!hand.has(c) || is_base(by_palm, c) != of_base) continue;
    const auto found = nearest(hand.capsules[c], object, poses, limit);
    if (found) limit = std::min(limit, found->features.distance);
  }
  return limit;
}

bool ClosingHand::on_opposite_faces(const Hand& hand, int finger, const Object& object,
                                    const Poses& poses) const {
  const auto under = [&](int capsule) {
    return nearest(hand.capsules[capsule], object, poses, kSearchDistance);
  };
  const auto tip = under(capsule_index(finger, 3)), base = under(capsule_index(0, 3));
  return tip && base && tip->features.normal.dot(base->features.normal) < kMaxOpposingCosine;
}

bool ClosingHand::closes_on(const HandTrack& track, int finger, const Object& object,
                            const Poses& poses) const {
  if (!closes(track, false, finger)) return false;
  const Hand& hand = track.current;
  const Capsule line{base_of(hand, false), tip_of(hand, finger), 0.0};
  bool is_far = true;
  for (std::size_t i = 0; i < object.size(); ++i) {
    const Body& body = scene_.bodies[object[i]];
    is_far = is_far && distance_from_axis(poses[i].position, line) > body.bounding_radius + kMaxLineDistance;
  }
  return !is_far && nearest(line, object, poses, kMaxLineDistance) &&
         on_opposite_faces(hand, finger, object, poses);
}

bool ClosingHand::closes_on(const HandTrack& track, const Object& object, const Poses& poses) const {
  if (!has_tip(track.current, 0)) return false;
  for (int finger = 1; finger < kFingers; ++finger)
    if (has_tip(track.current, finger) && closes_on(track, finger, object, poses)) return true;
  return false;
}

}  // namespace mrhi
