#include "strike.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../collision/god_object.h"
#include "impact.h"

namespace mrhi {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// When two points `apart` that part by `velocity` are `distance` from each other for the first time [s].
double time_to_reach(const Vector3& apart, const Vector3& velocity, double distance) {
  // |apart + t velocity| = distance has two roots: the first, in the form that does not cancel.
  //
  //     v^2 t^2 - 2 c t + o = 0,    o = x^2 - d^2,  c = -x.v:    t = (c - root) / v^2 = o / (c + root)
  const double outside = apart.squaredNorm() - distance * distance, closing = -apart.dot(velocity);
  if (outside <= 0.0) return 0.0;
  const double discriminant = closing * closing - velocity.squaredNorm() * outside;
  if (closing <= 0.0 || discriminant < 0.0) return kNever;
  return outside / (closing + std::sqrt(discriminant));
}

}  // namespace

Vector3 Strike::Partner::velocity_of_centre() const {
  if (state == nullptr) return Vector3::Zero();
  return inverse_mass * state->linear_momentum;
}

// v + w x r (Eq. 7). A hand's own velocity is in `drive`; what is left of it here is by how much it has
// given way.
Vector3 Strike::Partner::velocity() const {
  if (state == nullptr) return recoil;
  return velocity_of_centre() + (inverse_inertia * state->angular_momentum).cross(arm);
}

void Strike::Partner::push(const Vector3& by) {
  if (state == nullptr) {
    recoil += inverse_mass * by;
    return;
  }
  state->linear_momentum += by;
  state->angular_momentum += arm.cross(by);
}

// A phalanx counts as a point that has its mass alone; 1/m is 0 of the paper's hand and of fixtures.
Matrix3 Strike::Partner::inverse_effective_mass() const {
  if (state == nullptr) return inverse_mass * Matrix3::Identity();
  return collision_matrix(inverse_mass, inverse_inertia, arm);
}

// The gap closes at t + wait, and there surfaces that part again, or only rest on each other, do not strike
// (Eq. 8's cases).
double Strike::meeting() const {
  const double wait =
      is_of_balls()
          ? time_to_reach(b.arm - a.arm, a.velocity_of_centre() - b.velocity_of_centre(), radius_a + radius_b)
          : time_to_close(gap, rate() + time * acceleration, acceleration);
  if (wait == kNever) return kNever;
  Strike then = *this;
  then.move_to(time + wait);
  const double speed = then.rate() + then.time * acceleration;
  return classify(speed) == Approach::colliding ? then.time : kNever;
}

void Strike::move_to(double later) {
  const double wait = later - time;
  time = later;
  if (!is_of_balls()) {
    // rate() is the step's start's: by gravity it has grown by a t, in the mean of the wait by a (t - wait /
    // 2).
    const double closed = -wait * (rate() + acceleration * (time - 0.5 * wait));
    gap -= closed;
    move_arms(wait, closed);
    return;
  }
  // Balls: the line of centres is followed exactly, whatever they spin, and the point divides it by the
  // radii. On a normal of the step's start a blow that falls later would turn smooth balls.
  const Vector3 apart = b.arm - a.arm + wait * (a.velocity_of_centre() - b.velocity_of_centre());
  const double distance = apart.norm(), radii = radius_a + radius_b;
  gap = distance - radii;
  normal = apart / distance;
  a.arm = -(radius_a / radii) * apart;
  b.arm = (radius_b / radii) * apart;
}

// r += t (c' - v), the rate of an arm from a moving centre to a moving point c. Both arms end at the same
// c: with two of them J and -J would turn the pair by (c_b - c_a) x J.
void Strike::move_arms(double seconds, double closed) {
  if (radius_a > 0.0 || radius_b > 0.0) {
    // The point of a ball moves with its centre, and from the middle of the gap to its surface as the gap
    // closes.
    const Partner& ball = radius_b > 0.0 ? b : a;
    const Vector3 to_surface = (radius_b > 0.0 ? -0.5 : 0.5) * closed * normal;
    for (Partner* partner : {&a, &b}) {
      if (partner->state == nullptr) continue;
      partner->arm += seconds * (ball.velocity_of_centre() - partner->velocity_of_centre()) + to_surface;
    }
    return;
  }
  const Vector3 point = 0.5 * (a.velocity() + b.velocity());
  for (Partner* partner : {&a, &b}) {
    if (partner->state != nullptr) partner->arm += seconds * (point - partner->velocity_of_centre());
  }
}

//     m_n = 1 / n'Kn  (Eq. 14's denominator),     M_t = (T'KT)^-1,     K = K_a + K_b,  T = two tangents
//
// K is not isotropic off the centre, so M_t is a matrix: a single number would steer friction off the
// sliding.
void Strike::prepare() {
  magnitude = 0.0;
  drag.setZero();
  a.recoil.setZero();
  // Eq. 12 of both: an impulse p parts the points by (K_a + K_b) p. Along n its effective mass is 1 / n.K n.
  const Matrix3 k = a.inverse_effective_mass() + b.inverse_effective_mass();
  normal_mass = 1.0 / normal.dot(k * normal);
  if (friction <= 0.0) return;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  tangential_mass = (tangents.transpose() * k * tangents).inverse();
}

// A row of projected Gauss-Seidel (Catto 2005): the sum of the impulses must not pull, a single one may.
//
//     j <- max(0, j + m_n (target - u)),      u = n.w with all impulses so far
//
// which for a single strike is Eq. 14 at once. At the end 0 <= j, target <= u, and one of them with =:
// Newton's law for many points as Moreau (1988) has it.
double Strike::relax_normal() {
  const double velocity = normal.dot(relative_velocity());
  const double wanted = std::max(0.0, magnitude + normal_mass * (target - velocity));
  const double change = wanted - magnitude;
  magnitude = wanted;
  a.push(change * normal);
  b.push(-change * normal);
  return std::abs(change) / normal_mass;
}

// Likewise, within Coulomb's disc of radius mu j. Both directions at once: limited one by one they would make
// a square, and friction at its corners be 1.4 times too strong.
//
//     d <- disc(d + M_t T'w),    |d| <= mu j,    on b, along the sliding of a over it
//
// j is the last one of the same sweep. A blow's friction is static friction, the most that there may be.
double Strike::relax_tangential() {
  if (friction <= 0.0) return 0.0;
  const Eigen::Vector2d needed = tangential_mass * (tangents.transpose() * relative_velocity());
  Vector3 wanted = drag + tangents * needed;
  const double most = friction * magnitude, length = wanted.norm();
  if (length > most) wanted *= most / length;
  const Vector3 change = wanted - drag;
  drag = wanted;
  a.push(-change);
  b.push(change);
  return change.norm() / normal_mass;
}

}  // namespace mrhi
