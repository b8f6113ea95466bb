#include "contact_step.h"

namespace mrhi {

void StepChanges::reset(std::size_t bodies) {
  solved_.assign(bodies, false);
  for (const Impacted& impacted : impacted_) places_[impacted.body] = -1;
  places_.resize(bodies, -1);
  impacted_.reserve(bodies);
  impacted_.clear();
}

StepChanges::Impacted& StepChanges::impacted(int body, const BodyState& after) {
  int& place = places_[body];
  if (place < 0) {
    place = static_cast<int>(impacted_.size());
    impacted_.push_back({body, {after.linear_momentum, after.angular_momentum}, {}, {}, 0.0, 0.0});
  }
  return impacted_[place];
}

// For each body: J, r x J, and both times their time t. The momenta already include the impulses, so those
// before the impacts are computed at a body's first impact.
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
    body.moment.linear += impact.time * impact.impulse;
    body.moment.angular += impact.time * turn;
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
// It acted for h - t, so x -= sum t J / m, and the rotation likewise. Springs respond to the impact in the
// same solve. Their impulse, all that is neither J nor gravity, counts from the mean time of the impacts.
//
//     x -= (sum t J + T dp) / m,      turn by -I^-1 (sum t r x J + T dL),      T = sum t |J| / sum |J|
//     dp = p - p_before - sum J - m h g,     dL = L - L_before - sum r x J
//
// The rotation is removed about the axes, and by I, at the end of the step; the error is of second order in
// the impact's rotation. Only poses change, so momenta and energy stay.
void StepChanges::delay_impacts(const std::vector<Body>& scene, const Vector3& gravity, double step,
                                std::vector<BodyState>& bodies) const {
  for (const Impacted& impacted : impacted_) {
    if (impacted.size_moment <= 0.0) continue;
    const auto index = static_cast<std::size_t>(impacted.body);
    const Body& body = scene[index];
    BodyState& state = bodies[index];
    const double time = impacted.size_moment / impacted.size;
    const Vector3 fallen = (body.mass * step) * gravity;
    const Vector3 linear_by_springs =
        state.linear_momentum - fallen - impacted.before.linear - impacted.sum.linear;
    const Vector3 angular_by_springs =
        state.angular_momentum - impacted.before.angular - impacted.sum.angular;
    state.pose.position -= (impacted.moment.linear + time * linear_by_springs) / body.mass;
    const Vector3 turned = -(world_inverse_inertia(body, state.pose.orientation) *
                             (impacted.moment.angular + time * angular_by_springs));
    const double angle = turned.norm();
    if (angle > 0.0) {
      state.pose.orientation =
          (Quaternion(Eigen::AngleAxisd(angle, turned / angle)) * state.pose.orientation).normalized();
    }
  }
}

}  // namespace mrhi
