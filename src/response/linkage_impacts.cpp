#include "linkage_impacts.h"

#include <algorithm>

#include "../collision/god_object.h"
#include "impact.h"

namespace mrhi {
/// The next point, with a zero Jacobian in `coordinates_`.
ImpactPoint LinkageImpacts::new_point(const Vector3& normal, double gap, double restitution) {
  if (coordinates_.size() == points_.size()) coordinates_.emplace_back();
  JointCoordinates& coordinates = coordinates_[points_.size()];
  coordinates.jacobian.setZero(3, velocity_.size());
  coordinates.velocity = &velocity_;
  ImpactPoint point;
  point.b.joints = &coordinates;
  point.normal = normal;
  point.gap = gap;
  point.restitution = restitution;
  return point;
}

/// Keeps the point if it collides within the step. Gravity is not in the rate: the velocity is that of the
/// step's start.
void LinkageImpacts::add(double step, const IslandProblem& problem, const ImpactPoint& point) {
  const double rate = point.rate();
  if (classify(rate) != Approach::colliding) return;
  double time = time_to_close(point.gap, rate, 0.0);
  if (point.between != nullptr && point.between->first_touch >= 0.0) time = point.between->first_touch;
  if (time >= step) return;
  JointCoordinates& coordinates = coordinates_[points_.size()];
  coordinates.response.resize(velocity_.size(), 3);
  for (int i = 0; i < 3; ++i) {
    column_ = coordinates.jacobian.row(i).transpose();
    problem.solve_mass(column_);
    coordinates.response.col(i) = column_;
  }
  points_.push_back(point);
  points_.back().time = time;
}

// The relative velocity is w = hand_velocity - J_b u: J_b is that of body 2, less that of body 1 if there is
// one. n points from 2 to 1, so w.n < 0 approaches (Eq. 8).
void LinkageImpacts::find(ContactStep& step, const Island& island, const IslandProblem& problem,
                          const std::vector<JointState>& joints, bool friction) {
  points_.clear();
  velocity_ = problem.start();
  for (const IslandBody& body : island.bodies) {
    const Material& material = step.scene.bodies[body.body].material;
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (contact.ignored || contact.struck) continue;
      ImpactPoint point =
          new_point(contact.normal, -contact.depth, contact.restitution.value_or(material.restitution));
      point.by_hand = true;
      point.hand_velocity = contact.hand_velocity;
      point.a.inverse_mass = contact.inverse_mass + contact.carrier_inverse_mass;
      point.a.recoil = recoils_.begin(contact.key);
      if (friction) point.friction = material.static_friction;
      point.total = &contact.impulse, point.struck = &contact.struck;
      problem.add_point_jacobian(island.place_of(body.body),
                                 contact.point - step.bodies[body.body].pose.position, 1.0,
                                 coordinates_[points_.size()].jacobian);
      add(step.step, problem, point);
      if (!points_.empty() && points_.back().struck == &contact.struck)
        contact.time_of_impact = points_.back().time;
    }
  }
  for (const Link& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (contact.struck) continue;
    ImpactPoint point = new_point(contact.normal, contact.first_touch >= 0.0 ? 0.0 : -contact.depth,
                                  contact.material.restitution);
    point.between = &contact;
    if (friction) point.friction = contact.material.static_friction;
    point.total = &contact.impulse, point.struck = &contact.struck;
    auto& jacobian = coordinates_[points_.size()].jacobian;
    problem.add_point_jacobian(island.place_of(contact.key.b), contact.arm_b, 1.0, jacobian);
    if (!step.scene.bodies[contact.key.a].fixed)
      problem.add_point_jacobian(island.place_of(contact.key.a), contact.arm_a, -1.0, jacobian);
    add(step.step, problem, point);
  }
  find_limits(step, problem, joints);
}

/// Adds the joints that reach a limit within the step, each as a contact along its coordinate. Springs and
/// gravity, which act through the step, then find the joint on its way back and give it no further energy.
///
///     room = upper - q for u > 0, q - lower for u < 0;   collides if 0 < room < h |u|
///     w = -sign u: < 0 approaches, as of surfaces; the impulse on the joint is -sign j
void LinkageImpacts::find_limits(const ContactStep& step, const IslandProblem& problem,
                                 const std::vector<JointState>& joints) {
  for (Eigen::Index unknown = 0; unknown < velocity_.size(); ++unknown) {
    if (problem.joint_of(unknown) == LinkageBody::kNone) continue;
    const auto index = static_cast<std::size_t>(problem.joint_of(unknown));
    const Joint& joint = step.scene.joints[index];
    const double sign = velocity_[unknown] > 0.0 ? 1.0 : -1.0, position = joints[index].position;
    const double room = sign > 0.0 ? joint.upper - position : position - joint.lower;
    if (joint.restitution <= 0.0 || room <= 0.0) continue;
    const ImpactPoint point = new_point(Vector3::UnitX(), room, joint.restitution);
    coordinates_[points_.size()].jacobian(0, unknown) = sign;
    add(step.step, problem, point);
  }
}

void LinkageImpacts::drop_separating(double step, const IslandProblem::Vector& velocity) {
  const auto separates = [&](const ImpactPoint& point) {
    const Vector3 relative = point.hand_velocity - point.b.joints->jacobian * velocity;
    return point.by_hand && point.gap + step * point.normal.dot(relative) > 0.0;
  };
  points_.erase(std::remove_if(points_.begin(), points_.end(), separates), points_.end());
}

void LinkageImpacts::note_limits(IslandProblem& problem) const {
  for (const ImpactPoint& point : points_) {
    if (point.total != nullptr) continue;
    Eigen::Index unknown = 0;
    point.b.joints->jacobian.row(0).cwiseAbs().maxCoeff(&unknown);
    problem.note_limit_impulse(unknown, -point.normal_impulse * point.b.joints->jacobian(0, unknown));
  }
}

}  // namespace mrhi
