#include "neighbours.h"

#include <algorithm>
#include <cmath>

#include "../scene/solid_mesh.h"

#include "overlap.h"
#include "segment.h"

namespace mrhi {

Eigen::AlignedBox3d box_around(const Body& body) {
  if (body.shapes.empty()) return Eigen::AlignedBox3d(Vector3::Zero(), Vector3::Zero());
  Eigen::AlignedBox3d box;
  for (const PlacedShape& placed : body.shapes) box.extend(box_around(placed));
  return box;
}

Eigen::AlignedBox3d box_around(const Hand& hand) {
  Eigen::AlignedBox3d box;
  for (const Capsule& capsule : hand.capsules) {
    if (capsule.radius <= 0.0) continue;
    const Vector3 radius = Vector3::Constant(capsule.radius);
    box.extend(capsule.start.cwiseMin(capsule.end) - radius);
    box.extend(capsule.start.cwiseMax(capsule.end) + radius);
  }
  return box;
}

std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin) {
  const Eigen::AlignedBox3d box = box_around(hand);
  std::vector<int> near;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (is_near(box, bodies[b].pose.position, scene.bodies[b].bounding_radius + margin))
      near.push_back(static_cast<int>(b));
  }
  return near;
}

namespace {

// Margin of a body's sphere in the Verlet list: a constant [m], a fraction of the body's size, and the
// distance that a moving body covers in a time [s]. A larger margin lasts longer, but lists more distant
// pairs.
constexpr double kMargin = 0.002;
constexpr double kMarginFraction = 0.1;
constexpr double kMarginTime = 0.01;
/// Fraction of its padding from which a body is placed anew when another leaves its sphere.
constexpr double kUsedPadding = 0.5;
/// Largest gap at which pairs are listed [m]: ContactFinder's margin of 1 mm, and a fall of 2 mm, from rest
/// within 20 ms at 1 g.
constexpr double kMaxGap = 0.004;

}  // namespace

Neighbours::Neighbours(const Scene& scene)
    : scene_(scene),
      broad_phase_(scene.bodies.size()),
      padded_(scene.bodies.size()),
      hand_paths_(kMaxHands),
      near_hand_(kMaxHands) {
  for (const Body& body : scene.bodies) boxes_.push_back(box_around(body));
  for (std::vector<NearBody>& near : near_hand_) near.reserve(scene.bodies.size());
  for (HandPaths& reach : hand_paths_) reach.paths.reserve(kCapsules);
  pairs_.reserve(4 * scene.bodies.size());
  untouching_ = overlaps_in_mechanisms(scene);
  for (const Joint& joint : scene.joints) untouching_.emplace_back(joint.parent, joint.child);
  for (std::size_t i = untouching_.size(); i-- > 0;)
    untouching_.emplace_back(untouching_[i].second, untouching_[i].first);
  std::sort(untouching_.begin(), untouching_.end());
}

void Neighbours::begin_frame(const std::vector<HandTrack>& hands, const std::vector<BodyState>& bodies,
                             const Carried& carried) {
  for (std::size_t slot = 0; slot < hands.size(); ++slot)
    measure(hands[slot], carried[slot], hand_paths_[slot]);
  if (place_those_leaving(bodies, 0.0)) list_pairs();
  list_near_hands(bodies);
}

/// An axis point a(s) goes from a0 to a1, and is (f - 1/2)(a1 - a0) off its place halfway at the fraction f
/// of the frame: at most half the longer displacement of the two ends, and f (1 - f) of the longest bend.
void Neighbours::measure(const HandTrack& hand, const CarriedFrame* carried, HandPaths& reach) {
  reach.box.setEmpty();
  reach.paths.clear();
  if (!hand.active) return;
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& to = hand.current.capsules[c];
    const Capsule& from = hand.previous.capsules[c].radius > 0.0 ? hand.previous.capsules[c] : to;
    if (to.radius <= 0.0) continue;
    Vector3 start = 0.5 * (from.start + to.start), end = 0.5 * (from.end + to.end);
    const double displacement =
        std::sqrt(std::max((to.start - from.start).squaredNorm(), (to.end - from.end).squaredNorm()));
    CapsulePath path{c, start, end - start, to.radius + 0.5 * displacement + 0.25 * hand.path.longest_bend};
    if (carried != nullptr) {
      const CarrierMotion& carrier = carried->motion;
      start = carrier.to_world(start);
      end = carrier.to_world(end);
      path.start = start, path.along = end - start;
      // Half of the displacement, and all of the turn, whose rotation is that of the start; of both ends.
      const double arm =
          std::sqrt(std::max((start - carrier.centre).squaredNorm(), (end - carrier.centre).squaredNorm())) +
          path.reach;
      path.reach += carried->margin + carried->seconds * (0.5 * carrier.twist.linear.norm() +
                                                          arm * carrier.twist.angular.norm());
    }
    reach.box.extend(start.cwiseMin(end) - Vector3::Constant(path.reach));
    reach.box.extend(start.cwiseMax(end) + Vector3::Constant(path.reach));
    reach.paths.push_back(path);
  }
}

void Neighbours::begin_step(const std::vector<BodyState>& bodies, double step) {
  if (!place_those_leaving(bodies, step)) return;
  list_pairs();
  list_near_hands(bodies);
}

double Neighbours::reach_of(std::size_t body, const BodyState& state, double seconds) const {
  const Body& b = scene_.bodies[body];
  const double travel = b.fixed ? 0.0 : seconds * state.linear_momentum.norm() / b.mass;
  return b.bounding_radius + travel + kMaxGap;
}

/// The foot of the centre on the axis halfway, clamped in 0..1, is as near as it gets to it.
bool Neighbours::CapsulePath::comes_near(const Vector3& centre, double radius) const {
  const double s = foot(start, along, centre);
  return (start + s * along - centre).squaredNorm() <= (reach + radius) * (reach + radius);
}

/// Greatest gap along the box's axes: a lower bound, loose only beside edges and corners.
double Neighbours::CapsulePath::clearance(const Eigen::AlignedBox3d& box, const Pose& pose,
                                          const Matrix3& rotation) const {
  const Vector3 half_along = 0.5 * along;
  const Vector3 middle = rotation.transpose() * (start + half_along - pose.position) - box.center();
  const Vector3 half_length = (rotation.transpose() * half_along).cwiseAbs();
  return (middle.cwiseAbs() - half_length - 0.5 * box.sizes()).maxCoeff() - reach;
}

bool Neighbours::may_meet_hand(std::size_t body, const BodyState& state, double seconds) const {
  const Vector3& centre = state.pose.position;
  const double radius = reach_of(body, state, seconds);
  const auto near = [&](const CapsulePath& path) { return path.comes_near(centre, radius); };
  return std::any_of(hand_paths_.begin(), hand_paths_.end(), [&](const HandPaths& hand) {
    return std::any_of(hand.paths.begin(), hand.paths.end(), near);
  });
}

bool Neighbours::may_meet(std::size_t a, std::size_t b, const std::vector<BodyState>& bodies,
                          double seconds) const {
  const double apart = (bodies[a].pose.position - bodies[b].pose.position).norm();
  return apart <= reach_of(a, bodies[a], seconds) + reach_of(b, bodies[b], seconds);
}

/// A body leaves if |moved| + |v| step may exceed its padding, tested as 2 (moved^2 + (v step)^2) > padding^2
/// without a root. If one leaves, all that have used much of their padding are placed anew: in a heap some
/// body would leave in nearly every step.
bool Neighbours::place_those_leaving(const std::vector<BodyState>& bodies, double step) {
  const auto uses = [&](std::size_t b, double part) {
    const Body& body = scene_.bodies[b];
    if (body.is_operator) return false;  // never placed, never found
    const double travel = body.fixed ? 0.0 : step / body.mass;
    return 2.0 * ((bodies[b].pose.position - padded_[b].centre).squaredNorm() +
                  travel * travel * bodies[b].linear_momentum.squaredNorm()) >
           part * part * padded_[b].padding_squared;
  };
  std::size_t leaving = 0;
  while (leaving < bodies.size() && !uses(leaving, 1.0)) ++leaving;
  if (leaving == bodies.size()) return false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!uses(b, kUsedPadding)) continue;
    const Body& body = scene_.bodies[b];
    const double speed = body.fixed ? 0.0 : bodies[b].linear_momentum.norm() / body.mass;
    const double padding =
        kMargin + kMarginFraction * body.bounding_radius + (kMarginTime + 2.0 * step) * speed;
    padded_[b] = {bodies[b].pose.position, padding * padding, body.bounding_radius + padding + kMaxGap};
    broad_phase_.update(static_cast<int>(b), padded_[b].centre, padded_[b].radius);
  }
  return true;
}

void Neighbours::list_near_hands(const std::vector<BodyState>& bodies) {
  for (std::size_t slot = 0; slot < hand_paths_.size(); ++slot) {
    const HandPaths& reach = hand_paths_[slot];
    near_hand_[slot].clear();
    if (reach.paths.empty()) continue;
    for (const int body : broad_phase_.query(reach.box.min(), reach.box.max())) {
      const PaddedSphere& sphere = padded_[body];
      const Pose& pose = bodies[body].pose;
      const Matrix3 rotation = pose.orientation.toRotationMatrix();
      NearBody near{body, 0, pose, {}, {}};
      for (const CapsulePath& path : reach.paths) {
        if (!path.comes_near(sphere.centre, sphere.radius)) continue;
        near.add(path.capsule, path.clearance(boxes_[body], pose, rotation));
      }
      if (near.count > 0) near_hand_[slot].push_back(near);
    }
  }
}

/// Sorted, so that equal states give equal bits. Bodies that share a joint do not touch, nor do those of one
/// mechanism that overlap where they start.
void Neighbours::list_pairs() {
  pairs_.clear();
  for (std::pair<int, int> pair : broad_phase_.pairs()) {
    const bool fixed_first = scene_.bodies[pair.first].fixed;
    const bool fixed_second = scene_.bodies[pair.second].fixed;
    if (fixed_first && fixed_second) continue;
    if (fixed_second) std::swap(pair.first, pair.second);
    if (!std::binary_search(untouching_.begin(), untouching_.end(), pair)) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
  is_paired_.assign(scene_.bodies.size(), 0);
  for (const auto& [a, b] : pairs_) is_paired_[a] = is_paired_[b] = 1;
  paired_.clear();
  for (std::size_t b = 0; b < is_paired_.size(); ++b)
    if (is_paired_[b]) paired_.push_back(static_cast<int>(b));
}

}  // namespace mrhi
