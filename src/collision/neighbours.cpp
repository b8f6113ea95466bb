#include "mr_hand_interaction/collision/neighbours.h"

#include <algorithm>
#include <limits>

namespace mrhi {
namespace {

// Room around a body at rest, and as a part of its size; what a moving one has beyond that: its way in some
// time. More room is asked for more rarely, but lists more pairs that are not near.
constexpr double kRoom = 0.002;  // [m]
constexpr double kRoomPart = 0.1;
constexpr double kRoomTime = 0.01;  // [s]
/// From this gap on contacts are followed, with what gravity adds to a step's way [m].
constexpr double kFollowed = 0.004;

}  // namespace

Neighbours::Neighbours(const Scene& scene)
    : scene_(scene),
      broad_phase_(scene.bodies.size()),
      rooms_(scene.bodies.size()),
      reaches_(kMaxHands),
      near_hand_(kMaxHands) {
  for (std::vector<int>& near : near_hand_) near.reserve(scene.bodies.size());
  pairs_.reserve(4 * scene.bodies.size());
}

void Neighbours::begin_frame(const std::vector<HandTrack>& hands, const std::vector<BodyState>& bodies) {
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    Reach& reach = reaches_[slot];
    reach.min.setConstant(std::numeric_limits<double>::max());
    reach.max = -reach.min;
    if (!hands[slot].active) continue;
    for (const Hand* hand : {&hands[slot].previous, &hands[slot].current}) {
      for (const Capsule& capsule : hand->capsules) {
        if (capsule.radius <= 0.0) continue;
        const Vector3 radius = Vector3::Constant(capsule.radius);
        reach.min = reach.min.cwiseMin(capsule.start.cwiseMin(capsule.end) - radius);
        reach.max = reach.max.cwiseMax(capsule.start.cwiseMax(capsule.end) + radius);
      }
    }
  }
  if (place_those_leaving(bodies, 0.0)) list_pairs();
  list_near_hands();
}

void Neighbours::begin_step(const std::vector<BodyState>& bodies, double step) {
  if (!place_those_leaving(bodies, step)) return;
  list_pairs();
  list_near_hands();
}

double Neighbours::reach_of(std::size_t body, const BodyState& state, double seconds) const {
  const Body& b = scene_.bodies[body];
  const double way = b.fixed ? 0.0 : seconds * state.linear_momentum.norm() / b.mass;
  return b.bounding_radius + way + kFollowed;
}

bool Neighbours::may_meet_hand(std::size_t body, const BodyState& state, double seconds) const {
  const Vector3& centre = state.pose.position;
  const double radius = reach_of(body, state, seconds);
  return std::any_of(reaches_.begin(), reaches_.end(), [&](const Reach& hand) {
    if (hand.min.x() > hand.max.x()) return false;
    return (centre - centre.cwiseMax(hand.min).cwiseMin(hand.max)).norm() <= radius;
  });
}

bool Neighbours::may_meet(std::size_t a, std::size_t b, const std::vector<BodyState>& bodies,
                          double seconds) const {
  const double apart = (bodies[a].pose.position - bodies[b].pose.position).norm();
  return apart <= reach_of(a, bodies[a], seconds) + reach_of(b, bodies[b], seconds);
}

bool Neighbours::place_those_leaving(const std::vector<BodyState>& bodies, double step) {
  bool any = false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    Room& room = rooms_[b];
    const double travel = body.fixed ? 0.0 : step / body.mass;
    const Vector3& position = bodies[b].pose.position;
    // Twice the sum of squares is no less than the square of the sum.
    const double way = 2.0 * ((position - room.centre).squaredNorm() +
                              travel * travel * bodies[b].linear_momentum.squaredNorm());
    if (way <= room.slack_squared) continue;
    const double speed = body.fixed ? 0.0 : bodies[b].linear_momentum.norm() / body.mass;
    const double slack = kRoom + kRoomPart * body.bounding_radius + (kRoomTime + 2.0 * step) * speed;
    room = {position, slack * slack};
    broad_phase_.update(static_cast<int>(b), position, body.bounding_radius + slack + kFollowed);
    any = true;
  }
  return any;
}

void Neighbours::list_near_hands() {
  for (std::size_t slot = 0; slot < reaches_.size(); ++slot) {
    const Reach& reach = reaches_[slot];
    near_hand_[slot].clear();
    if (reach.min.x() <= reach.max.x()) near_hand_[slot] = broad_phase_.query(reach.min, reach.max);
  }
}

void Neighbours::list_pairs() {
  pairs_.clear();
  for (std::pair<int, int> pair : broad_phase_.pairs()) {
    const bool fixed_first = scene_.bodies[static_cast<std::size_t>(pair.first)].fixed;
    const bool fixed_second = scene_.bodies[static_cast<std::size_t>(pair.second)].fixed;
    if (fixed_first && fixed_second) continue;
    if (fixed_second) std::swap(pair.first, pair.second);
    pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
  paired_.clear();
  for (const auto& [a, b] : pairs_) paired_.push_back(a), paired_.push_back(b);
  std::sort(paired_.begin(), paired_.end());
  paired_.erase(std::unique(paired_.begin(), paired_.end()), paired_.end());
}

}  // namespace mrhi
