#include "impact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../math/rotation.h"

namespace mrhi {
namespace {

constexpr double kInfiniteTime = std::numeric_limits<double>::infinity();

}  // namespace

// An impulse p at r changes v by p / m and w by I^-1 (r x p), and so the velocity at r by p / m + (I^-1 [r]x
// p) x r = p / m - [r]x I^-1 [r]x p.
//
//     K = 1/m + [r]x I^-1 [r]x'             [r]x' = -[r]x: positive definite, as 1/m is
//
// This is Mirtich's (1996) collision matrix. The paper has `K determined by the mass` (Eq. 12) and Eq. 15
// without an angular part: with K = 1/m alone an eccentric impact would cause no spin.
Matrix3 collision_matrix(double inverse_mass, const Matrix3& world_inverse_inertia, const Vector3& r) {
  const Matrix3 arm = cross_matrix(r);
  return inverse_mass * Matrix3::Identity() - arm * world_inverse_inertia * arm;
}

double max_eigenvalue(double tt, double ts, double ss) {
  return 0.5 * (tt + ss) + std::sqrt(0.25 * (tt - ss) * (tt - ss) + ts * ts);
}

//     T'KT = ( tt ts )      lambda = (tt + ss) / 2 + sqrt((tt - ss)^2 / 4 + ts^2)
//            ( ts ss )
double max_tangential_response(const Matrix3& k, const Vector3& n) {
  if (n.isZero(0.0)) return k.trace();
  const Vector3 t = n.unitOrthogonal(), s = n.cross(t), k_s = k * s;
  return max_eigenvalue(t.dot(k * t), t.dot(k_s), s.dot(k_s));
}

// p += J, L += r x J: Eq. 15 for momenta, which are the state, with its angular part.
void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state) {
  state.linear_momentum += impulse;
  state.angular_momentum += (point - state.pose.position).cross(impulse);
}

// c1' - c2' with c2' = v + w x r (Eqs. 7, 8).
Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state) {
  return contact.hand_velocity - object_velocity(twist_of(body, state), state.pose.position, contact.point);
}

// An impulse J on 2 and -J on 1 does the work J.(v_2 + v_2') / 2 - J.(v_1 + v_1') / 2, by the mean velocities
// before and after (Thomson & Tait 1867). This is -J.(w + w') / 2 with w = v_1 - v_2. If body 1 is a driven
// hand, J.v_1 is its work, and the result is the object's energy beyond it.
double energy_gained(const Vector3& approach, const Vector3& impulse, const Vector3& after) {
  return -0.5 * impulse.dot(approach + after);
}

// With s the weight of Newton's impact, J(s) = J_0 + s dJ and w'(s) = w_0' + s dw', where 0 is the impact
// without restitution:
//
//     G(s) = -1/2 sum J(s).(w + w'(s)) = least + linear s + square s^2,      least <= 0 < G(1)
//     linear = -1/2 sum (dJ.(w + w_0') + J_0.dw'),       square = -1/2 sum dJ.dw'
//
// and s the positive zero of G. All points have one weight, as they act on each other. The blend of two
// solutions has an impact's momenta, and friction within Coulomb's disc, which is convex.
void keep_from_gaining(std::vector<ImpactLaws>& points) {
  double min_gain = 0.0, exchanged = 0.0;
  for (const ImpactLaws& point : points) {
    min_gain += energy_gained(point.approach, point.plastic, point.after_plastic);
    exchanged += point.plastic.norm() * point.approach.norm();
  }
  if (min_gain > kGainTolerance * exchanged) {
    for (ImpactLaws& point : points) {
      point.newtons = point.plastic, point.after_newtons = point.after_plastic;
      point.plastic.setZero(), point.after_plastic = point.approach;
    }
    min_gain = 0.0;
  }
  // Impulses and velocities are linear in the weight, so the energy gained is quadratic.
  double linear = 0.0, square = 0.0;
  for (const ImpactLaws& point : points) {
    const Vector3 more = point.newtons - point.plastic, faster = point.after_newtons - point.after_plastic;
    linear -= 0.5 * (more.dot(point.approach + point.after_plastic) + point.plastic.dot(faster));
    square -= 0.5 * more.dot(faster);
  }
  // Its zero in the form without cancellation: (-b + root) / 2a, or the equal -2c / (b + root), whichever
  // adds numbers of one sign.
  const double root = std::sqrt(std::max(0.0, linear * linear - 4.0 * square * min_gain));
  double weight = 0.0;
  if (linear > 0.0)
    weight = -2.0 * min_gain / (linear + root);
  else if (square > 0.0)
    weight = (root - linear) / (2.0 * square);
  weight = min_gain <= 0.0 ? std::clamp(weight, 0.0, 1.0) : 0.0;
  for (ImpactLaws& point : points) point.newtons = point.plastic + weight * (point.newtons - point.plastic);
}

double time_to_close(double gap, double rate, double acceleration) {
  if (gap <= 0.0) return 0.0;
  // Zero of gap + rate t + a t^2 / 2 in the form without cancellation.
  //
  //     t = (-r - root) / a = 2 g / (-r + root),     root = sqrt(r^2 - 2 a g)
  //
  // The first form excludes a = 0, and subtracts nearly equal numbers for a small a. Without a real root the
  // gap reverses before it closes. If the denominator is not positive it opens for good.
  const double discriminant = rate * rate - 2.0 * acceleration * gap;
  if (discriminant < 0.0) return kInfiniteTime;
  const double closing = -rate + std::sqrt(discriminant);
  return closing > 0.0 ? 2.0 * gap / closing : kInfiniteTime;
}

/// Eq. 8's v is hardly ever exactly 0: rounding of speeds near 1 m/s is some 1e-16 m/s.
Approach classify(double normal_velocity) {
  constexpr double kRestingSpeed = 1e-9;  // largest speed of a contact at rest [m/s]
  if (normal_velocity < -kRestingSpeed) return Approach::colliding;
  return normal_velocity > kRestingSpeed ? Approach::separating : Approach::resting;
}

/// Eq. 7: o' + w x (c - o).
Vector3 object_velocity(const Twist& twist, const Vector3& centre, const Vector3& point) {
  return twist.linear + twist.angular.cross(point - centre);
}

namespace {

/// First time at which two points `apart`, with the relative velocity `velocity`, are `distance` from each
/// other [s].
double time_to_reach(const Vector3& apart, const Vector3& velocity, double distance) {
  // |apart + t velocity| = distance has two roots; this is the first, in the form without cancellation.
  //
  //     v^2 t^2 - 2 c t + o = 0,    o = x^2 - d^2,  c = -x.v:    t = (c - root) / v^2 = o / (c + root)
  const double outside = apart.squaredNorm() - distance * distance, closing = -apart.dot(velocity);
  if (outside <= 0.0) return 0.0;
  const double discriminant = closing * closing - velocity.squaredNorm() * outside;
  if (closing <= 0.0 || discriminant < 0.0) return kInfiniteTime;
  return outside / (closing + std::sqrt(discriminant));
}

}  // namespace

Vector3 ImpactPoint::Partner::velocity_of_centre() const {
  if (state == nullptr) return Vector3::Zero();
  return inverse_mass * state->linear_momentum;
}

// A capsule of the hand is a point mass. 1/m is 0 for the paper's hand and for fixtures.
Matrix3 ImpactPoint::Partner::inverse_effective_mass() const {
  if (joints != nullptr) return joints->jacobian.lazyProduct(joints->response);
  if (state == nullptr) return inverse_mass * Matrix3::Identity();
  return collision_matrix(inverse_mass, inverse_inertia, arm);
}

// The gap closes at t + wait. Surfaces that have separated by then, or are at rest on each other, do not
// collide (Eq. 8's cases).
double ImpactPoint::collision_time() const {
  const double wait =
      is_of_balls()
          ? time_to_reach(b.arm - a.arm, a.velocity_of_centre() - b.velocity_of_centre(), radius_a + radius_b)
          : time_to_close(gap, rate() + time * acceleration, acceleration);
  if (wait == kInfiniteTime) return kInfiniteTime;
  ImpactPoint then = *this;
  then.advance_to(time + wait);
  const double speed = then.rate() + then.time * acceleration;
  return classify(speed) == Approach::colliding ? then.time : kInfiniteTime;
}

void ImpactPoint::advance_to(double later) {
  const double wait = later - time;
  time = later;
  if (!is_of_balls()) {
    // rate() is that at the start of the step. Gravity has added a t, on average over the wait a (t - wait /
    // 2).
    const double closed = -wait * (rate() + acceleration * (time - 0.5 * wait));
    gap -= closed;
    advance_arms(wait, closed);
    return;
  }
  // Balls: the line of centres is followed exactly, whatever their spin, and the point divides it by the
  // radii. The normal at the start of the step would make a later impact spin smooth balls.
  const Vector3 apart = b.arm - a.arm + wait * (a.velocity_of_centre() - b.velocity_of_centre());
  const double distance = apart.norm(), radii = radius_a + radius_b;
  gap = distance - radii;
  normal = apart / distance;
  a.arm = -(radius_a / radii) * apart;
  b.arm = (radius_b / radii) * apart;
}

// r += t (c' - v), the rate of an arm from a moving centre to a moving point c. Both arms end at the same c,
// so the impact conserves angular momentum. Two points would rotate the pair by (c_b - c_a) x J.
void ImpactPoint::advance_arms(double seconds, double closed) {
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

// I^-1 <- R I^-1 R', R by t w. An impulse that conserves energy with the inertia at the start of the step
// does not at the time of impact: an elongated body that spins gained up to 0.2 % in an elastic impact.
void ImpactPoint::turn_inertia() {
  const double wait = time - inertia_time;
  inertia_time = time;
  for (Partner* partner : {&a, &b}) {
    if (partner->state == nullptr) continue;
    const Vector3 turn = wait * (partner->inverse_inertia * partner->state->angular_momentum);
    const Matrix3 rotation = rotation_by(turn).toRotationMatrix();
    partner->inverse_inertia = rotation * partner->inverse_inertia * rotation.transpose();
  }
}

//     m_n = 1 / n'Kn  (Eq. 14's denominator),     m_t = 1 / lambda_max(T'KT),     K = K_a + K_b
//
// A single effective mass serves both tangential directions, though K is not isotropic: with a matrix the
// fixed point of relax() would not oppose the sliding. The largest eigenvalue avoids overshoot. Joints may
// leave a point no direction of motion; its effective mass is then 0.
void ImpactPoint::begin() {
  normal_impulse = 0.0;
  friction_impulse.setZero();
  if (a.recoil != nullptr) a.recoil->setZero();
  // Eq. 12 of both bodies: an impulse p changes the relative velocity by (K_a + K_b) p.
  const Matrix3 k = a.inverse_effective_mass() + b.inverse_effective_mass();
  const auto mass = [](double response) { return response > 0.0 ? 1.0 / response : 0.0; };
  normal_response = k * normal;
  normal_mass = mass(normal.dot(normal_response));
  if (friction > 0.0) tangential_mass = mass(max_tangential_response(k, normal));
}

// A row of projected Gauss-Seidel (Catto 2005): the accumulated normal impulse must not pull, a single change
// may.
//
//     j <- max(0, j + m_n (target - u)),                 u = n.w with all impulses so far
//     d <- disc(d + m_t (w - n n.w)),    |d| <= mu j,    on b, along the sliding of a over it
//
// For a single point the first is Eq. 14 at once. On convergence 0 <= j, target <= u, and one of them is an
// equality: Newton's law for many points in Moreau's (1988) form. Friction uses j and w after the normal
// impulse, w + (j' - j) K n, and both directions at once. Limited separately they would form a square, with
// friction 1.4 times too strong at its corners. Impacts use static friction, the limit of Coulomb's law.
double ImpactPoint::relax() {
  Vector3 velocity = relative_velocity();
  const double change =
      std::max(0.0, normal_impulse + normal_mass * (target - normal.dot(velocity))) - normal_impulse;
  normal_impulse += change;
  Vector3 impulse = -change * normal;
  double error = std::abs(change);
  if (friction > 0.0) {
    velocity += change * normal_response;
    Vector3 unlimited = friction_impulse + tangential_mass * (velocity - normal.dot(velocity) * normal);
    const double limit = friction * normal_impulse, length = unlimited.norm();
    if (length > limit) unlimited *= limit / length;
    error = std::max(error, (unlimited - friction_impulse).norm());
    impulse += unlimited - friction_impulse;
    friction_impulse = unlimited;
  }
  a.apply(-impulse);
  b.apply(impulse);
  return normal_mass > 0.0 ? error / normal_mass : 0.0;
}

void ImpactPoint::undo() {
  a.apply(impulse());
  b.apply(-impulse());
}

void ImpactPoint::set_impulse(const Vector3& impulse) {
  const Vector3 more = impulse - this->impulse();
  const double more_normal = -normal.dot(more);
  normal_impulse += more_normal;
  friction_impulse += more + more_normal * normal;
  a.apply(-more);
  b.apply(more);
}

}  // namespace mrhi
