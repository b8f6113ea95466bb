#include "impact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../collision/god_object.h"

namespace mrhi {

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
  double share = 0.0;
  if (linear > 0.0)
    share = -2.0 * min_gain / (linear + root);
  else if (square > 0.0)
    share = (root - linear) / (2.0 * square);
  share = min_gain <= 0.0 ? std::clamp(share, 0.0, 1.0) : 0.0;
  for (ImpactLaws& point : points) point.newtons = point.plastic + share * (point.newtons - point.plastic);
}

double time_to_close(double gap, double rate, double acceleration) {
  constexpr double kInfiniteTime = std::numeric_limits<double>::infinity();
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

}  // namespace mrhi
