#include "contact_patch.h"

#include <algorithm>
#include <cmath>

#include "impact.h"

namespace mrhi {
namespace {

/// The normal force is linear if the finger complies only beyond this depth [m].
constexpr double kMaxYield = 1e6;
/// The release fade counts as 0 below this fraction of the release speed.
constexpr double kMinFade = 1e-3;
/// Iterations of Newton's method for one normal impulse.
constexpr int kMaxIterations = 12;
/// Largest number of contacts of a patch that are solved together.
constexpr int kMaxTogether = 4;
/// A patch that fails to be solved together this many times is relaxed contact by contact from then on.
constexpr int kMaxSeparations = 3;
/// Sweeps through the contacts of a patch that has open contacts.
constexpr int kInnerSweeps = 3;

/// Scales a friction impulse down to Coulomb's limit.
template <typename Friction>
void limit_friction(double limit, Friction& friction) {
  const double squared = friction.squaredNorm();
  if (squared > limit * limit) friction *= limit / std::sqrt(squared);
}

/// Adds the change of the motion at the point r of a body by an impulse and an angular impulse about it:
///
///     (  1/m - [r]A[r]   -[r]A  )      A = I^-1; its first block is collision_matrix()
///     (       A[r]          A   )
void add_mobility(double inverse_mass, const Matrix3& inverse_inertia, const Vector3& r, Mobility6& sum) {
  const Matrix3 across = cross_matrix(r), turned = across * inverse_inertia;
  sum.topLeftCorner<3, 3>() += inverse_mass * Matrix3::Identity() - turned * across;
  sum.topRightCorner<3, 3>() -= turned;
  sum.bottomLeftCorner<3, 3>() -= turned.transpose();
  sum.bottomRightCorner<3, 3>() += inverse_inertia;
}

/// Adds the impulses of a point to those about its patch's origin: r x (f, 0), and -p (r x n) by the lever
/// arm.
[[gnu::always_inline]] inline void add_normal(const PatchPoint& point, double normal, Motion6& impulse) {
  impulse[2] -= normal;
  impulse[3] -= normal * point.lever_u;
  impulse[4] -= normal * point.lever_v;
}
[[gnu::always_inline]] inline void add_friction(const PatchPoint& point, const Eigen::Vector2d& f,
                                                Motion6& impulse) {
  impulse[0] += f[0];
  impulse[1] += f[1];
  impulse[3] -= point.place.z() * f[1];
  impulse[4] += point.place.z() * f[0];
  impulse[5] += point.place.x() * f[1] - point.place.y() * f[0];
}

/// A spring p = k (d - e u), which looks ahead by e, acts on bodies with mobility w: u = u_0 + w p. Its
/// impulse is p = k / (1 + k e w) (d - e u_0), with u_0 the rate without it; the factor is `soft_stiffness`.
/// Friction follows likewise from the stretch, t = k (s + e u) and u = u_0 - w t. As a function of the rate u
/// that the last t has left: t' = kept t + stretch_impulse + damping u.
///
///     along n:   p = k (d - e u),   u = u_0 + w p:     p = k / (1 + k e w) (d - e u_0),   u_0 = u - w p_last
///     across:    t' = k (s + e (u + w t - w t')):      t' = (1 - softening) t + softening k (s + e u)
///                softening = 1 / (1 + k e w)
///
/// k includes the step (N s/m). Signs differ because n points from b to a. The normal impulse on b is -p n,
/// which separates the bodies; t is along the sliding, which it slows. Iterating t' = k (s + e u) with u by
/// the last t would diverge for k e w > 1, and stiff contacts are far beyond that. Across, w is the largest
/// in any direction.
PatchPoint make_point(double step, const SpringContact& row, const Mobility6& mobility,
                      const ContactPatch& patch) {
  const Spring& spring = row.spring;
  PatchPoint point;
  const Vector3 from_origin = vector(row.arm) - patch.arm_b;
  const Vector3 lever = patch.axes * (from_origin.cross(vector(spring.normal)) + vector(row.tilt));
  point.place = patch.axes * from_origin;
  point.lever_u = lever.x(), point.lever_v = lever.y();
  point.spring = static_cast<const NormalSpring&>(spring);
  point.closing = spring.depth / spring.ahead;
  point.friction = spring.friction;
  point.bond = step * spring.bond;
  point.nonlinear = spring.pad > 0.0 || spring.yields < kMaxYield;
  point.impulses.setZero();
  point.by_normal = mobility.col(2) + point.lever_u * mobility.col(3) + point.lever_v * mobility.col(4);
  const Vector3& r = point.place;
  point.by_friction.col(0) = r.y() * mobility.col(5) - r.z() * mobility.col(4) - mobility.col(0);
  point.by_friction.col(1) = r.z() * mobility.col(3) - r.x() * mobility.col(5) - mobility.col(1);
  point.normal_mobility = point.rate(point.by_normal);
  const Eigen::Vector2d u = point.sliding(point.by_friction.col(0)),
                        v = point.sliding(point.by_friction.col(1));
  const double tangential_mobility =
      patch.grips ? mobility.topLeftCorner<3, 3>().trace() : max_eigenvalue(-u[0], -v[0], -v[1]);
  const double stiffness = step * spring.stiffness, impulse = stiffness * spring.ahead;
  point.compliance = 1.0 / impulse;
  point.soft_stiffness = stiffness / (1.0 + impulse * point.normal_mobility);
  const double shear = step * spring.shear, drag = shear * spring.ahead;
  const double softening = 1.0 / (1.0 + drag * tangential_mobility);
  point.kept = 1.0 - softening;
  point.damping = softening * drag;
  point.stretch_impulse = (softening * shear) * (patch.axes * vector(spring.stretch));
  return point;
}

/// Normal impulses p of a patch change its rates by W p, and springs apply k (d - e u); k includes the step.
/// Returns the matrix of
///
///     (W + 1/(k e)) p = d / e - u_0,      W_ij = 1/m_a + 1/m_b + l_ai.I_a^-1 l_aj + l_bi.I_b^-1 l_bj,   l =
///     r x n
///
/// Unused rows are the identity's. 1/(k e) keeps the matrix regular, though four points have only three
/// independent normal loads.
Eigen::Matrix4d normal_system(const PatchPoint* points, int count) {
  Eigen::Matrix4d system = Eigen::Matrix4d::Identity();
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j <= i; ++j) system(i, j) = system(j, i) = points[i].rate(points[j].by_normal);
    system(i, i) += points[i].compliance;
  }
  return system;
}

/// Newton's method, safeguarded by a bracket, with p(u) = h Spring::normal_force().
///
///     g(u) = u - u_0 - w p(u) = 0,     g' = 1 - w dp/du >= 1       in u_0 <= u <= u_0 + w p_plain
///
/// g increases, so it has one zero, and there p = (u - u_0) / w. The upper bound is the solution of the plain
/// spring: pad and fade only reduce its force. A Newton step that leaves the bracket is replaced by
/// bisection: beyond the release speed p is 0, and its slope does not show where it begins.
double find_faded_impulse(double step, const PatchPoint& point, double rate, double plain) {
  const double mobility = point.normal_mobility, response = step * mobility;
  double low = rate, high = rate + mobility * plain, at = high;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    double slope;
    const double residual = at - rate - response * point.spring.normal_force(at, slope);
    (residual > 0.0 ? high : low) = at;
    const double next = at - residual / (1.0 + response * slope);
    if (std::abs(next - at) <= 1e-9 * (high - rate)) break;
    at = next > low && next < high ? next : 0.5 * (low + high);
  }
  return std::max(0.0, (at - rate) / mobility);
}

/// Normal impulse by the contact's law, if the rate is `rate` without it. Closed form if neither fade nor pad
/// acts. The rate with this impulse is the highest possible; where even that hardly separates, the quadratic
/// fade takes at most a millionth.
[[gnu::always_inline]] inline double find_normal_impulse(double step, const PatchPoint& point, double rate) {
  const double deep = point.spring.depth - point.spring.ahead * rate;
  if (deep <= 0.0) return 0.0;
  const double plain = point.soft_stiffness * deep;
  if (!point.nonlinear && (rate + point.normal_mobility * plain) * point.spring.fade <= kMinFade)
    return plain;
  return find_faded_impulse(step, point, rate, plain);
}

[[gnu::always_inline]] inline void relax_normal(double step, PatchPoint& point, Motion6& motion,
                                                Motion6& impulse) {
  double& last = point.impulses[kNormal];
  const double normal = find_normal_impulse(step, point, point.rate(motion) - point.normal_mobility * last);
  if (normal == last) return;
  motion += (normal - last) * point.by_normal;
  add_normal(point, normal - last, impulse);
  last = normal;
}

[[gnu::always_inline]] inline void relax_friction(PatchPoint& point, Motion6& motion, Motion6& impulse) {
  const double limit = point.friction * point.impulses[kNormal] + point.bond;
  const Eigen::Vector2d last = point.impulses.head<2>();
  if (limit == 0.0 && last == Eigen::Vector2d::Zero()) return;
  Eigen::Vector2d friction =
      point.kept * last + point.stretch_impulse.head<2>() + point.damping * point.sliding(motion);
  limit_friction(limit, friction);
  const Eigen::Vector2d more = friction - last;
  motion += more[0] * point.by_friction.col(0) + more[1] * point.by_friction.col(1);
  add_friction(point, more, impulse);
  point.impulses.head<2>() = friction;
}

/// Solves a point of a grip: as friction, in all three directions.
void relax_grip(PatchPoint& point, const Motion6& motion, Motion6& impulse) {
  const Vector3 last = point.impulse();
  Vector3 next = point.kept * last + point.stretch_impulse + point.damping * motion.head<3>();
  limit_friction(point.bond, next);
  impulse.head<3>() += next - last;
  point.impulses.head<3>() << next.x(), next.y(), -next.z();
}

}  // namespace

void PatchPoint::add_impulses(Motion6& sum) const {
  add_normal(*this, impulses[kNormal], sum);
  add_friction(*this, impulses.head<2>(), sum);
  sum[5] += impulses[kTwist];
}

// The immovable body is the last one.
ContactPatch make_patch(double step, const SpringContact* rows, int count,
                        const std::vector<PatchBody>& bodies, std::vector<PatchPoint>& points) {
  ContactPatch patch;
  const SpringContact& row = rows[0];
  const Vector3 n = vector(row.spring.normal);
  patch.first = points.size(), patch.count = count, patch.separations = 0;
  patch.a = row.a == SpringContact::kNone ? static_cast<int>(bodies.size()) - 1 : row.a, patch.b = row.b;
  patch.grips = n.isZero(0.0), patch.twists = row.spring.twist_stiffness > 0.0;
  patch.axes.row(2) = patch.grips ? Vector3::UnitZ() : n;
  patch.axes.row(0) = patch.axes.row(2).unitOrthogonal();
  patch.axes.row(1) = patch.axes.row(2).cross(patch.axes.row(0));
  patch.arm_a = vector(row.arm_a), patch.arm_b = vector(row.arm);
  patch.drive << patch.axes * vector(row.drive), 0.0, 0.0, row.drive_spin;
  Mobility6 mobility = Mobility6::Zero();
  const auto add = [&](int number, const Vector3& arm) {
    const PatchBody& body = bodies[number];
    const Matrix3 inverse_inertia = patch.axes * body.inverse_inertia * patch.axes.transpose();
    add_mobility(body.inverse_mass, inverse_inertia, patch.axes * arm, mobility);
  };
  add(patch.b, patch.arm_b);
  if (row.a != SpringContact::kNone) add(patch.a, patch.arm_a);
  patch.by_twist = -mobility.col(5);
  for (int i = 0; i < count; ++i) points.push_back(make_point(step, rows[i], mobility, patch));
  if (count > 1 && count <= kMaxTogether)
    patch.inverse = normal_system(&points[patch.first], count).inverse();
  return patch;
}

void ContactPatch::start_from(const Vector3& force, const Spring& spring, double step, PatchPoint& point,
                              PatchBody& of_a, PatchBody& of_b) const {
  if (grips) {
    Vector3 pull = point.stretch_impulse / (1.0 - point.kept);  // at rest t' = kept t + stretch_impulse is t
    limit_friction(point.bond, pull);
    point.impulses << pull.x(), pull.y(), -pull.z(), 0.0;
  } else {
    if (force == Vector3::Zero()) return;
    const Vector3 last = step * (axes * force);
    point.impulses << last.x(), last.y(), std::max(0.0, -last.z()), 0.0;
  }
  if (twists) {
    const double limit = spring.patch_friction * point.impulses[kNormal];
    point.impulses[kTwist] = std::max(-limit, std::min(step * spring.twist_stiffness * spring.twist, limit));
  }
  Motion6 impulse = Motion6::Zero();
  point.add_impulses(impulse);
  apply(impulse, of_a, of_b);
}

// Contact by contact if the normal impulses cannot be solved together.
//
//     p' = find_normal_impulse(u.n - w p),   t' = disc(kept t + stretch_impulse + damping P u, mu p' + bond)
//
// The limit of friction is by the new normal impulse, not the last iterate's. This minimises no convex
// function, but its fixed point is Coulomb's law itself.
void ContactPatch::relax(double step, PatchPoint* points, const Spring* twisted, Motion6& motion,
                         Motion6& impulse) {
  if (grips) return relax_grip(*points, motion, impulse);
  const bool together = relax_normals_together(points, motion, impulse);
  for (int i = 0; i < count; ++i) {
    if (!together) relax_normal(step, points[i], motion, impulse);
    relax_friction(points[i], motion, impulse);
  }
  if (twists) relax_twist(step, *twisted, *points, motion, impulse);
}

/// Solves a patch's normal impulses simultaneously if the fade of none acts; otherwise returns false and
/// changes nothing.
///
///     p' = p + (W + 1/(k e))^-1 (d / e - u - p / (k e)),     u with p in it
///
/// Contacts relaxed one after the other would tip a box back and forth, also against its neighbours. Solved
/// together, a centred load on a face causes no rotation.
[[gnu::always_inline]] inline bool ContactPatch::relax_normals_together(PatchPoint* points, Motion6& motion,
                                                                        Motion6& impulse) {
  if (count < 2 || count > kMaxTogether || separations >= kMaxSeparations) return false;
  Eigen::Vector4d missing_speeds = Eigen::Vector4d::Zero();
  bool open = true;
  for (int i = 0; i < count; ++i) {
    const PatchPoint& point = points[i];
    missing_speeds[i] = point.closing - point.rate(motion) - point.compliance * point.impulses[kNormal];
    open = open && missing_speeds[i] <= 0.0 && point.impulses[kNormal] == 0.0;
  }
  if (open) return true;
  Eigen::Vector4d more = inverse * missing_speeds;
  bool pulls = false;
  for (int i = 0; i < count; ++i) pulls = pulls || points[i].impulses[kNormal] + more[i] < 0.0;
  if (pulls) {
    // Some contacts are open: projected Gauss-Seidel, so that none pulls.
    more.setZero();
    const Eigen::Matrix4d system = normal_system(points, count);
    for (int sweep = 0; sweep < kInnerSweeps; ++sweep) {
      for (int i = 0; i < count; ++i) {
        const double change =
            std::max(missing_speeds[i] / system(i, i), -(points[i].impulses[kNormal] + more[i]));
        more[i] += change;
        missing_speeds -= change * system.col(i);
      }
    }
  }
  for (int i = 0; i < count; ++i) {
    const PatchPoint& point = points[i];
    const double normal = point.impulses[kNormal] + more[i];
    if (normal > 0.0 && (point.closing - point.compliance * normal) * point.spring.fade > kMinFade) {
      ++separations;
      return false;
    }
  }
  for (int i = 0; i < count; ++i) {
    points[i].impulses[kNormal] += more[i];
    motion += more[i] * points[i].by_normal;
    add_normal(points[i], more[i], impulse);
  }
  return true;
}

// As friction, but about n: T' = T + softening (k (theta + e w_n) - T) with softening = 1 / (1 + k e n'I^-1
// n), clamped to 2/3 mu a p.
void ContactPatch::relax_twist(double step, const Spring& spring, PatchPoint& point, Motion6& motion,
                               Motion6& impulse) const {
  double& last = point.impulses[kTwist];
  const double stiffness = step * spring.twist_stiffness;
  const double limit = spring.patch_friction * point.impulses[kNormal];
  const double softening = 1.0 / (1.0 - stiffness * spring.ahead * by_twist[5]);
  const double unlimited = last + softening * (stiffness * (spring.twist + spring.ahead * motion[5]) - last);
  const double twist = std::max(-limit, std::min(unlimited, limit));
  motion += (twist - last) * by_twist;
  impulse[5] += twist - last;
  last = twist;
}

// Forces are impulses over the step. The trial force is that which
// would keep the tangential spring from slipping: at the fixed point k q+ where the contact sticks. It
// exceeds the limit where k q+ does, as t' - t = softening (k q+ - t).
void ContactPatch::fill_response(double step, const PatchPoint& point, const Motion6& motion,
                                 SpringContact& row) const {
  const double normal = grips ? 0.0 : point.impulses[kNormal];
  Vector3 sliding = motion.head<3>(), friction = point.impulse();
  if (!grips) sliding << point.sliding(motion), 0.0;
  if (!grips) friction.z() = 0.0;
  const Vector3 trial = point.kept * friction + point.stretch_impulse + point.damping * sliding;
  row.response = {};
  row.response.force = triple(axes.transpose() * point.impulse() / step);
  row.response.normal_force = normal / step;
  row.response.torque = point.impulses[kTwist] / step;
  row.response.trial_squared = trial.squaredNorm() / (step * step);
  row.response.drawn = triple(vector(row.spring.stretch) + point.spring.ahead * (axes.transpose() * sliding));
  row.spring.slip_limit = (point.friction * normal + point.bond) / step;
}

}  // namespace mrhi
