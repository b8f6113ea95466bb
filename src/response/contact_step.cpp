#include "contact_step.h"

#include <algorithm>
#include <tuple>

#include "../integration/free_flight.h"

namespace mrhi {
namespace {

constexpr std::size_t kTurnCapacity = 128;  // for one step; grows if needed

}  // namespace

void StepChanges::reset(std::size_t bodies) {
  solved_.assign(bodies, false);
  for (const Impacted& impacted : impacted_) places_[impacted.body] = -1;
  places_.resize(bodies, -1);
  impacted_.reserve(bodies);
  turns_.reserve(kTurnCapacity);
  impacted_.clear();
  turns_.clear();
}

StepChanges::Impacted& StepChanges::impacted(int body, const BodyState& after) {
  int& place = places_[body];
  if (place < 0) {
    place = static_cast<int>(impacted_.size());
    impacted_.push_back({body,
                         {after.linear_momentum, after.angular_momentum},
                         after.pose.orientation,
                         {},
                         Vector3::Zero(),
                         0.0,
                         0.0});
  }
  return impacted_[place];
}

// For each body: J, r x J and t J. The momenta already include the impulses, so those before the impacts are
// computed at a body's first impact.
void StepChanges::note_impacts(const std::vector<BodyImpact>& impacts, const std::vector<BodyState>& bodies) {
  const std::size_t known = impacted_.size();
  for (const BodyImpact& impact : impacts) {
    Impacted& body = impacted(impact.body, bodies[impact.body]);
    const Vector3 turn = impact.arm.cross(impact.impulse);
    if (static_cast<std::size_t>(places_[impact.body]) >= known) {
      body.before.linear -= impact.impulse;
      body.before.angular -= turn;
    }
    body.sum.linear += impact.impulse;
    body.sum.angular += turn;
    body.moment += impact.time * impact.impulse;
    turns_.push_back({impact.body, impact.time, turns_.size(), turn});
    body.size += impact.impulse.norm();
    body.size_moment += impact.time * impact.impulse.norm();
  }
}

// delay_impacts() skips a body without a moment.
void StepChanges::forget(int body) {
  const int place = places_[body];
  if (place >= 0) impacted_[place].size_moment = 0.0;
}

double StepChanges::mean_impact_time(std::size_t body) const {
  const int place = body < places_.size() ? places_[body] : -1;
  if (place < 0) return 0.0;
  const Impacted& impacted = impacted_[place];
  return impacted.size_moment > 0.0 ? impacted.size_moment / impacted.size : 0.0;
}

// Flight has moved the body by h times the velocity at the end of the step, as if J had acted from the start.
// It acted for h - t, so x -= sum t J / m. Springs respond to the impact in the same solve. Their impulse,
// all that is neither J nor gravity, counts from the mean time of the impacts.
//
//     x -= (sum t J + T dp) / m,      dp = p - p_before - sum J - m h g,      T = sum t |J| / sum |J|
//
// The body rotates anew, from impact to impact: so each acts on the orientation for which it was solved, and
// its energy is the one after it.
void StepChanges::delay_impacts(const std::vector<Body>& scene, const Vector3& gravity, double step,
                                std::vector<BodyState>& bodies) {
  for (const Impacted& impacted : impacted_) {
    const Vector3& after = bodies[impacted.body].angular_momentum;
    turns_.push_back({impacted.body, mean_impact_time(impacted.body), turns_.size(),
                      after - impacted.before.angular - impacted.sum.angular});
  }
  std::sort(turns_.begin(), turns_.end(), [this](const Turn& a, const Turn& b) {
    return std::tie(places_[a.body], a.time, a.number) < std::tie(places_[b.body], b.time, b.number);
  });
  auto turn = turns_.begin();
  for (const Impacted& impacted : impacted_) {
    const Body& body = scene[impacted.body];
    Quaternion orientation = impacted.orientation;
    Vector3 momentum = impacted.before.angular;
    double time = 0.0;
    for (; turn != turns_.end() && turn->body == impacted.body; ++turn) {
      if (turn->time > time) free_rotation(body, momentum, turn->time - time, orientation);
      time = turn->time;
      momentum += turn->change;
    }
    if (impacted.size_moment <= 0.0) continue;
    BodyState& state = bodies[impacted.body];
    free_rotation(body, state.angular_momentum, step - time, orientation);
    state.pose.orientation = orientation;
    const Vector3 by_springs =
        state.linear_momentum - (body.mass * step) * gravity - impacted.before.linear - impacted.sum.linear;
    state.pose.position -= (impacted.moment + mean_impact_time(impacted.body) * by_springs) / body.mass;
  }
}

}  // namespace mrhi
