#include "contact_step.h"

namespace mrhi {

void StepChanges::reset(std::size_t bodies) {
  solved_.assign(bodies, false);
  for (const Struck& struck : struck_) places_[static_cast<std::size_t>(struck.body)] = -1;
  places_.resize(bodies, -1);
  struck_.reserve(bodies);
  struck_.clear();
}

StepChanges::Struck& StepChanges::struck(int body, const BodyState& after) {
  int& place = places_[static_cast<std::size_t>(body)];
  if (place < 0) {
    place = static_cast<int>(struck_.size());
    const Vector3 none = Vector3::Zero();
    struck_.push_back(
        {body, after.linear_momentum, after.angular_momentum, none, none, none, none, 0.0, 0.0});
  }
  return struck_[static_cast<std::size_t>(place)];
}

// Of each body: J, r x J, and both times the time t at which they fell. An impact that comes on top of others
// of the same step finds the momenta with those already in, so what was before is noted with the first.
void StepChanges::note_impacts(const std::vector<BodyImpact>& impacts, const std::vector<BodyState>& bodies) {
  const std::size_t known = struck_.size();
  for (const BodyImpact& impact : impacts) {
    Struck& body = struck(impact.body, bodies[static_cast<std::size_t>(impact.body)]);
    const Vector3 turn = impact.arm.cross(impact.impulse);
    if (static_cast<std::size_t>(places_[static_cast<std::size_t>(impact.body)]) >= known) {
      body.linear_before -= impact.impulse;
      body.angular_before -= turn;
    }
    body.linear += impact.impulse;
    body.angular += turn;
    body.linear_moment += impact.time * impact.impulse;
    body.angular_moment += impact.time * turn;
    body.size += impact.impulse.norm();
    body.size_moment += impact.time * impact.impulse.norm();
  }
}

// Without a moment delay_impacts() passes it over.
void StepChanges::forget(int body) {
  const int place = places_[static_cast<std::size_t>(body)];
  if (place >= 0) struck_[static_cast<std::size_t>(place)].size_moment = 0.0;
}

double StepChanges::mean_impact_time(std::size_t body) const {
  const int place = body < places_.size() ? places_[body] : -1;
  if (place < 0) return 0.0;
  const Struck& struck = struck_[static_cast<std::size_t>(place)];
  return struck.size_moment > 0.0 ? struck.size_moment / struck.size : 0.0;
}

// Flight has moved the body by h times the velocity of the step's end, as if J had been there from its start.
// It had h - t: so x -= sum t J / m, and the same of the turn. Springs answer the blow within the same solve;
// what they gave (all that is neither J nor gravity) is taken to begin at the blows' mean time.
//
//     x -= (sum t J + T dp) / m,      turn by -I^-1 (sum t r x J + T dL),      T = sum t |J| / sum |J|
//     dp = p - p_before - sum J - m h g,     dL = L - L_before - sum r x J
//
// The turn is taken back about the axes of the end, by I of the end: of second order in what a blow turns
// in a step. Only poses are changed, so momenta and energy stay what they are.
void StepChanges::delay_impacts(const std::vector<Body>& scene, const Vector3& gravity, double step,
                                std::vector<BodyState>& bodies) const {
  for (const Struck& struck : struck_) {
    if (struck.size_moment <= 0.0) continue;
    const auto index = static_cast<std::size_t>(struck.body);
    const Body& body = scene[index];
    BodyState& state = bodies[index];
    const double time = struck.size_moment / struck.size;
    const Vector3 fallen = (body.mass * step) * gravity;
    const Vector3 linear_by_springs = state.linear_momentum - fallen - struck.linear_before - struck.linear;
    const Vector3 angular_by_springs = state.angular_momentum - struck.angular_before - struck.angular;
    state.pose.position -= (struck.linear_moment + time * linear_by_springs) / body.mass;
    const Vector3 turned = -(world_inverse_inertia(body, state.pose.orientation) *
                             (struck.angular_moment + time * angular_by_springs));
    const double angle = turned.norm();
    if (angle > 0.0) {
      state.pose.orientation =
          (Quaternion(Eigen::AngleAxisd(angle, turned / angle)) * state.pose.orientation).normalized();
    }
  }
}

}  // namespace mrhi
