#include "implicit_contact.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/response/penetration_force.h"

namespace mrhi {
namespace {

/// The contact's own damping, as the time by which a spring with a dashpot beside it (Kelvin-Voigt) looks
/// ahead. A step solved at its end damps as much as half the step does, so only the rest is added: a held
/// object comes to rest equally fast at every step length [s].
constexpr double kRelaxation = 0.005;

/// Lever at which the tangential springs of a fingertip's contact patch resist twisting about the normal [m].
constexpr double kTwistLever = 0.025;

/// Friction torque of a patch of radius a that presses evenly: 2/3 mu N a.
constexpr double kPatchTorque = 2.0 / 3.0;

/// Integral of min(k q, limit) from 0 to q: energy of a spring that yields.
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

}  // namespace

ImplicitContact::ImplicitContact(Contact& contact, const Material& material, bool torsion,
                                 const Vector3& centre, double step)
    : contact_(contact),
      normal_(contact.normal),
      arm_(contact.point - centre),
      step_(step),
      ahead_(step + std::max(0.0, kRelaxation - 0.5 * step)),
      stiffness_(material.stiffness * contact.share),
      twist_stiffness_(torsion ? stiffness_ * kTwistLever * kTwistLever : 0.0),
      friction_(contact.friction == Friction::sticking ? material.static_friction
                                                       : material.dynamic_friction),
      dynamic_friction_(material.dynamic_friction) {
  const Vector3 reach = contact.hand_point - contact.point + contact.lever;
  stretch_ = reach - normal_.dot(reach) * normal_;
}

Vector3 ImplicitContact::relative_velocity(const Vector3& linear, const Vector3& angular) const {
  return contact_.hand_velocity - linear - angular.cross(arm_);
}

double ImplicitContact::depth_ahead(double normal_velocity) const {
  return std::max(0.0, contact_.depth - ahead_ * normal_velocity);
}

double ImplicitContact::push(double normal_velocity) const {
  const double kept = std::clamp(1.0 - normal_velocity / kReleaseSpeed, 0.0, 1.0);
  return stiffness_ * depth_ahead(normal_velocity) * kept;
}

Vector3 ImplicitContact::stretch_ahead(const Vector3& relative) const {
  return stretch_ + ahead_ * (relative - normal_.dot(relative) * normal_);
}

double ImplicitContact::twist_ahead(const Vector3& angular) const {
  return contact_.twist + ahead_ * (contact_.hand_spin - normal_.dot(angular));
}

void ImplicitContact::limit_friction(const Vector3& linear, const Vector3& angular) {
  const double force = push(normal_.dot(relative_velocity(linear, angular)));
  slip_limit_ = friction_ * force;
  twist_limit_ = kPatchTorque * friction_ * contact_.patch * force;
}

ImplicitContact::Response ImplicitContact::evaluate(const Vector3& linear, const Vector3& angular) const {
  const Vector3 relative = relative_velocity(linear, angular);
  const double v = normal_.dot(relative);
  const double depth = depth_ahead(v);
  Response response;
  response.push = push(v);
  double slope = 0.0;
  if (depth > 0.0 && v < kReleaseSpeed) {
    slope = v <= 0.0 ? stiffness_ * ahead_
                     : stiffness_ * (ahead_ * (1.0 - v / kReleaseSpeed) + depth / kReleaseSpeed);
  }
  const Matrix3 across = normal_ * normal_.transpose();
  const Matrix3 along = Matrix3::Identity() - across;
  response.force = -response.push * normal_;
  response.force_slope = slope * across;

  const Vector3 stretch = stretch_ahead(relative);
  const double length = stretch.norm();
  if (stiffness_ * length <= slip_limit_) {
    response.force += stiffness_ * stretch;
    if (slip_limit_ > 0.0) response.force_slope += (stiffness_ * ahead_) * along;
  } else {
    const Vector3 direction = stretch / length;
    response.force += slip_limit_ * direction;
    response.force_slope += (slip_limit_ * ahead_ / length) * (along - direction * direction.transpose());
  }

  const double wanted = twist_stiffness_ * twist_ahead(angular);
  const bool holds = std::abs(wanted) < twist_limit_;
  response.torque = std::clamp(wanted, -twist_limit_, twist_limit_);
  response.torque_slope = holds ? twist_stiffness_ * ahead_ : 0.0;
  return response;
}

double ImplicitContact::potential(const Vector3& linear, const Vector3& angular) const {
  const Vector3 relative = relative_velocity(linear, angular);
  const double v = normal_.dot(relative);
  // Integral of the push from v up: where it is released, that of a line times a line.
  const auto released = [this](double from, double to) {
    const auto antiderivative = [this](double x) {
      const double d = contact_.depth, r = 1.0 / kReleaseSpeed;
      return stiffness_ * (d * x - 0.5 * (ahead_ + d * r) * x * x + ahead_ * r * x * x * x / 3.0);
    };
    return to > from ? antiderivative(to) - antiderivative(from) : 0.0;
  };
  const double gone = contact_.depth / ahead_;  // the relative velocity at which the surfaces just part
  double energy = released(std::max(v, 0.0), std::min(gone, kReleaseSpeed));
  const double below = std::min(gone, 0.0);
  if (v < below) {
    const double from = depth_ahead(v), to = depth_ahead(0.0);
    energy += 0.5 * stiffness_ * (from * from - to * to) / ahead_;
  } else if (v < 0.0 && gone > 0.0) {
    const double from = depth_ahead(v), to = depth_ahead(0.0);
    energy += 0.5 * stiffness_ * (from * from - to * to) / ahead_;
  }
  energy += yielding_energy(stiffness_, stretch_ahead(relative).norm(), slip_limit_) / ahead_;
  energy += yielding_energy(twist_stiffness_, std::abs(twist_ahead(angular)), twist_limit_) / ahead_;
  return energy;
}

void ImplicitContact::finish(const Vector3& linear, const Vector3& angular, const BodyState& state) {
  const Response response = evaluate(linear, angular);
  const Vector3 relative = relative_velocity(linear, angular);
  const Vector3 along = relative - normal_.dot(relative) * normal_;
  contact_.force = response.force;

  const double wanted = stiffness_ * stretch_ahead(relative).norm();
  const bool sticks =
      contact_.friction == Friction::sticking ? wanted <= slip_limit_ : wanted <= kStickAgain * slip_limit_;
  contact_.friction = sticks ? Friction::sticking : Friction::slipping;
  // What slides is what the spring and its damping, in line with the friction, do not follow.
  const double followed = step_ / ahead_;
  if (!sticks && response.push > 0.0) {
    const Vector3 tangential = response.force + response.push * normal_;
    const double rim = std::min(1.0, dynamic_friction_ * response.push / tangential.norm());
    const Vector3 kept = stretch_ + followed * (rim * tangential / stiffness_ - stretch_);
    contact_.god_object =
        state.pose.to_local(contact_.point + stretch_ - contact_.lever + step_ * along - kept);
  }
  if (twist_stiffness_ > 0.0) {
    contact_.twist += followed * (response.torque / twist_stiffness_ - contact_.twist);
  }
}

}  // namespace mrhi
