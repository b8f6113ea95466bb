#include "large_island_solver.h"

#include <algorithm>
#include <cmath>

#include "impact.h"

namespace mrhi {
namespace {

/// Number of contacts that all sweeps of a step relax together, and limits of the number of sweeps.
constexpr int kRelaxationBudget = 1000, kMinSweeps = 8, kMaxSweeps = 30;
/// An island is nearly at rest if no body is faster than a fall of this many steps. It may take more sweeps,
/// to come to rest.
constexpr double kRestFallSteps = 1.0;
constexpr int kMaxSweepsAtRest = 80;
/// Iteration ends when a sweep changes velocities by less than this ratio of the contacts' total change.
constexpr double kConverged = 1e-6;
/// Largest distance of a contact point from the body's centre, over the bounding radius; includes the margin.
constexpr double kRadiusMargin = 1.2;
constexpr double kMaxSpeed = 1e300;  // [m/s]
/// The normal force is linear if the finger complies only beyond this depth [m].
constexpr double kMaxYield = 1e6;
/// The release fade counts as 0 below this fraction of the release speed.
constexpr double kMinFade = 1e-3;
/// Iterations of Newton's method for one normal impulse.
constexpr int kMaxIterations = 12;
/// Largest number of contacts of a patch that are solved together.
constexpr int kMaxTogether = 4;
/// A patch that fails to be solved together this many times is relaxed contact by contact for the rest of the
/// step.
constexpr int kMaxSeparations = 3;
/// Sweeps through the contacts of a patch that has open contacts.
constexpr int kInnerSweeps = 3;

/// True if two contacts belong to one pair of shapes and share a normal.
bool same_patch(const BodyContact& x, const BodyContact& y) {
  return x.key.order() >> 8 == y.key.order() >> 8 && x.normal == y.normal;
}

/// Scales a friction impulse down to Coulomb's limit.
void limit_friction(double limit, Vector3& friction) {
  const double squared = friction.squaredNorm();
  if (squared > limit * limit) friction *= limit / std::sqrt(squared);
}

}  // namespace

// Free velocities are u* = (p / m + h g, I^-1 L). Impulses change them at once: unlike in IslandProblem, the
// unknowns are the contacts' impulses, and the velocities u* + M^-1 J' p are updated with each of them.
// Fixtures and hands share the last body, whose 1/m and I^-1 are 0.
void LargeIslandSolver::begin(const ContactStep& step, const Island& island,
                              const ContactConfiguration& configuration,
                              const std::vector<Vector3>& last_forces) {
  step_ = step.step;
  island_ = &island;
  configuration_ = &configuration;
  last_forces_ = &last_forces;
  bodies_.clear();
  free_.clear();
  points_.clear();
  patches_.clear();
  linked_.clear();
  open_.clear();
  max_arm_ = 0.0;
  for (const IslandBody& body : island.bodies)
    add_body(step.scene.bodies[body.body], step.bodies[body.body], step);
  bodies_.push_back({{Vector3::Zero(), Vector3::Zero()}, 0.0, Matrix3::Zero()});
  make_hand_rows(step, island, configuration, rows_);
  for (const SpringContact& row : rows_) {
    add_point(row);
    patches_.push_back({points_.size() - 1, 1, 0, {}, {}});
  }
  add_links(step, island);
}

void LargeIslandSolver::add_body(const mrhi::Body& body, const BodyState& state, const ContactStep& step) {
  const Matrix3 inverse_inertia = world_inverse_inertia(body, state.pose.orientation);
  free_.push_back(
      {state.linear_momentum / body.mass + step_ * step.gravity, inverse_inertia * state.angular_momentum});
  bodies_.push_back({free_.back(), 1.0 / body.mass, inverse_inertia});
  max_arm_ = std::max(max_arm_, kRadiusMargin * body.bounding_radius);
}

/// Adds the pairs of shapes that had a force in the last step, or that close fast enough for one. Contacts
/// are sorted, so those of a pair are adjacent.
void LargeIslandSolver::add_links(const ContactStep& step, const Island& island) {
  for (const Link* link = island.links.begin(); link != island.links.end();) {
    const BodyContact& first = step.body_contacts[link->index];
    Range range{link->index, link->index};
    bool acted = false;
    for (; link != island.links.end() && same_patch(step.body_contacts[link->index], first); ++link)
      acted = (*last_forces_)[range.last++] != Vector3::Zero() || acted;
    if (step.body_contacts[range.first].share <= 0.0) continue;  // strip too narrow for springs
    if (acted) {
      add_patch(step, range);
    } else {
      open_.push_back(range);
    }
  }
  checked_.clear();
  min_missing_speed_ = 0.0;
  admit_closing(step);
}

// The warm start is the last step's force f = t - p n, resolved along this step's normal: p = -n.f, cut off
// at 0.
void LargeIslandSolver::add_patch(const ContactStep& step, const Range& range) {
  Patch patch{points_.size(), static_cast<int>(range.last - range.first), 0, {}, {}};
  for (std::size_t index = range.first; index < range.last; ++index) {
    rows_.emplace_back();
    make_link_row(step, *island_, *configuration_, step.body_contacts[index], rows_.back());
    add_point(rows_.back());
    linked_.push_back(index);
    const Vector3& force = (*last_forces_)[index];
    if (force == Vector3::Zero()) continue;
    Point& point = points_.back();
    const double along = force.dot(point.normal);
    point.impulses = {step_ * std::max(0.0, -along), step_ * (force - along * point.normal), 0.0};
    apply(point, point.impulses.normal, point.impulses.friction);
  }
  prepare(patch);
  patches_.push_back(patch);
}

/// Returns the closing speed that the surfaces lack for a force [m/s].
///
///     missing = n.(c_a' - c_b') - d / e,      e the time that the spring looks ahead
///
/// A force needs d+ = d - e n.u > 0. e differs between the two signs of d (look_ahead in spring_contact.cpp).
double LargeIslandSolver::missing_speed(const ContactStep& step, const Range& range) const {
  double min_speed = kMaxSpeed;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const BodyContact& contact = step.body_contacts[i];
    const Motion& b = body(island_->place_of(contact.key.b)).motion;
    const int number = island_->place_of(contact.key.a);
    const Motion& a = number < 0 ? bodies_.back().motion : body(number).motion;
    const Vector3 velocity =
        a.velocity + a.spin.cross(contact.arm_a) - b.velocity - b.spin.cross(contact.arm_b);
    const double ahead = contact.depth > 0.0 ? look_ahead(step_, configuration_->damping) : step_;
    min_speed = std::min(min_speed, contact.normal.dot(velocity) - contact.depth / ahead);
  }
  return min_speed;
}

/// Upper bound of the increase in closing speed since open contacts were checked [m/s]. A point at the arm r
/// changes its velocity by |dv + dw x r| <= |dv| + |r| |dw|, and a pair of bodies by at most twice the
/// largest of these. No open contact has a force while this is below the smallest missing speed found then.
double LargeIslandSolver::max_speed_gain() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < checked_.size(); ++i) {
    const Motion change = bodies_[i].motion - checked_[i];
    largest = std::max(largest, change.velocity.norm() + max_arm_ * change.spin.norm());
  }
  return 2.0 * largest;
}

/// Adds open contacts that now have a force; returns true if there are any. They stay for the rest of the
/// step: one without a force costs little.
bool LargeIslandSolver::admit_closing(const ContactStep& step) {
  if (open_.empty() || max_speed_gain() < min_missing_speed_) return false;
  checked_.clear();
  for (const Body& body : bodies_) checked_.push_back(body.motion);
  min_missing_speed_ = kMaxSpeed;
  const std::size_t before = points_.size();
  const auto kept = std::remove_if(open_.begin(), open_.end(), [&](const Range& range) {
    const double missing_speeds = missing_speed(step, range);
    if (missing_speeds < 0.0) {
      add_patch(step, range);
      return true;
    }
    min_missing_speed_ = std::min(min_missing_speed_, missing_speeds);
    return false;
  });
  open_.erase(kept, open_.end());
  impulses_before_.resize(points_.size());
  impulse_directions_.resize(points_.size(), {0.0, Vector3::Zero(), 0.0});
  return points_.size() > before;
}

void LargeIslandSolver::add_point(const SpringContact& row) {
  const Spring& spring = row.spring;
  points_.emplace_back();
  Point& point = points_.back();  // impulses replace forces: stiffness is times the step
  point.a = row.a == SpringContact::kNone ? static_cast<int>(free_.size()) : row.a, point.b = row.b;
  point.normal = vector(spring.normal);
  point.arm_a = vector(row.arm_a), point.arm_b = vector(row.arm);
  point.drive = vector(row.drive);
  point.depth = spring.depth, point.ahead = spring.ahead, point.fade = spring.fade;
  point.stiffness = step_ * spring.stiffness;
  point.friction = spring.friction;
  point.bond = step_ * spring.bond;
  point.nonlinear = spring.pad > 0.0 || spring.yields < kMaxYield;
  point.twists = spring.twist_stiffness > 0.0;
  point.impulses = {0.0, Vector3::Zero(), 0.0};
  prepare(row, point);
}

/// A spring p = k (d - e u), which looks ahead by e, acts on bodies with mobility w: u = u_0 + w p. Its
/// impulse is p = k / (1 + k e w) (d - e u_0), with u_0 the rate without it; the factor is `soft_stiffness`.
/// Friction follows likewise from the stretch, t = k (s + e u) and u = u_0 - w t. As a function of the rate u
/// that the last t has left: t' = kept t + stretch_impulse + damping u.
///
///     along n:   p = k (d - e u),   u = u_0 + w p:     p = k / (1 + k e w) (d - e u_0),   u_0 = u - w p_last
///     across:    t' = k (s + e (u + w t - w t')):      t' = (1 - give) t + give k (s + e u)
///                give = 1 / (1 + k e w)
///
/// k includes the step (N s/m). Signs differ because n points from b to a. The normal impulse on b is -p n,
/// which separates the bodies; t is along the sliding, which it slows. Iterating t' = k (s + e u) with u by
/// the last t would diverge for k e w > 1, and stiff contacts are far beyond that.
void LargeIslandSolver::prepare(const SpringContact& row, Point& point) const {
  const Body &a = body(point.a), &b = body(point.b);
  const Matrix3 response = collision_matrix(a.inverse_mass, a.inverse_inertia, point.arm_a) +
                           collision_matrix(b.inverse_mass, b.inverse_inertia, point.arm_b);
  const Vector3 &n = point.normal, tilt = vector(row.tilt);
  point.lever_a = point.arm_a.cross(n) + tilt, point.lever_b = point.arm_b.cross(n) + tilt;
  point.turned_a = a.inverse_inertia * point.lever_a, point.turned_b = b.inverse_inertia * point.lever_b;
  point.normal_mobility = (a.inverse_mass + b.inverse_mass) * n.squaredNorm() +
                          point.lever_a.dot(point.turned_a) + point.lever_b.dot(point.turned_b);
  // A normal impulse also makes the surfaces slide if its arm is not along n.
  const Vector3 response_to_normal = point.turned_a.cross(point.arm_a) + point.turned_b.cross(point.arm_b);
  point.sliding_response = response_to_normal - n.dot(response_to_normal) * n;
  const double tangential_mobility = max_tangential_response(response, point.normal);
  point.compliance = 1.0 / (point.stiffness * point.ahead);
  point.soft_stiffness = point.stiffness / (1.0 + point.stiffness * point.ahead * point.normal_mobility);
  const double give = 1.0 / (1.0 + point.stiffness * point.ahead * tangential_mobility);
  point.kept = 1.0 - give;
  point.damping = give * point.stiffness * point.ahead;
  point.stretch_impulse = (give * point.stiffness) * vector(row.spring.stretch);
}

/// Normal impulses p of a patch change its rates by W p, and springs give k (d - e u); k includes the step:
///
///     (W + 1/(k e)) p = d / e - u_0,      W_ij = 1/m_a + 1/m_b + l_ai.I_a^-1 l_aj + l_bi.I_b^-1 l_bj,   l =
///     r x n
///
/// Unused rows are the identity's. 1/(k e) keeps the matrix regular, though four points have only three
/// independent normal loads.
void LargeIslandSolver::prepare(Patch& patch) const {
  if (patch.count < 2 || patch.count > kMaxTogether) return;
  Eigen::Matrix4d& system = patch.system;
  system.setIdentity();
  for (int i = 0; i < patch.count; ++i) {
    const Point& x = points_[patch.first + static_cast<std::size_t>(i)];
    const double inverse_mass = body(x.a).inverse_mass + body(x.b).inverse_mass;
    for (int j = 0; j <= i; ++j) {
      const Point& y = points_[patch.first + static_cast<std::size_t>(j)];
      system(i, j) = system(j, i) = inverse_mass + x.lever_a.dot(y.turned_a) + x.lever_b.dot(y.turned_b);
    }
    system(i, i) += x.compliance;
  }
  patch.inverse = system.inverse();
}

[[gnu::always_inline]] inline Vector3 LargeIslandSolver::relative_velocity(const Point& point) const {
  const Motion &a = body(point.a).motion, &b = body(point.b).motion;
  return point.drive + a.velocity + a.spin.cross(point.arm_a) - b.velocity - b.spin.cross(point.arm_b);
}

/// Rate of the gap at the point of action of the normal force [m/s].
[[gnu::always_inline]] inline double LargeIslandSolver::rate_of(const Point& point) const {
  const Motion &a = body(point.a).motion, &b = body(point.b).motion;
  return point.normal.dot(point.drive + a.velocity - b.velocity) + point.lever_a.dot(a.spin) -
         point.lever_b.dot(b.spin);
}

//     J = t - p n:    v_b += J / m_b,  w_b += I_b^-1 (b x t - p l_b),      v_a and w_a by -J
[[gnu::always_inline]] inline void LargeIslandSolver::apply(const Point& point, double normal,
                                                            const Vector3& friction) {
  Body &a = body(point.a), &b = body(point.b);
  const Vector3 impulse = friction - normal * point.normal;
  b.motion.velocity += b.inverse_mass * impulse;
  b.motion.spin += b.inverse_inertia * point.arm_b.cross(friction) - normal * point.turned_b;
  if (a.inverse_mass == 0.0) return;
  a.motion.velocity -= a.inverse_mass * impulse;
  a.motion.spin -= a.inverse_inertia * point.arm_a.cross(friction) - normal * point.turned_a;
}

/// Normal impulse by the contact's law, if the rate is `rate` without it. Closed form if neither fade nor pad
/// acts. The rate with this impulse is the highest possible; where even that hardly separates, the quadratic
/// fade takes at most a millionth.
[[gnu::always_inline]] inline double LargeIslandSolver::find_normal_impulse(std::size_t i,
                                                                            double rate) const {
  const Point& point = points_[i];
  const double deep = point.depth - point.ahead * rate;
  if (deep <= 0.0) return 0.0;
  const double plain = point.soft_stiffness * deep;
  if (!point.nonlinear && (rate + point.normal_mobility * plain) * point.fade <= kMinFade) return plain;
  return find_faded_impulse(i, rate, plain);
}

/// Newton's method, safeguarded by a bracket, with p(u) = h Spring::normal_force().
///
///     g(u) = u - u_0 - w p(u) = 0,     g' = 1 - w dp/du >= 1       in u_0 <= u <= u_0 + w p_plain
///
/// g increases, so it has one zero, and there p = (u - u_0) / w. The upper bound is the solution of the plain
/// spring: pad and fade only reduce its force. A Newton step that leaves the bracket is replaced by
/// bisection: beyond the release speed p is 0, and its slope does not show where it begins.
double LargeIslandSolver::find_faded_impulse(std::size_t i, double rate, double plain) const {
  const double mobility = points_[i].normal_mobility, response = step_ * mobility;
  double low = rate, high = rate + mobility * plain, at = high;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    double slope;
    const double residual = at - rate - response * rows_[i].spring.normal_force(at, slope);
    (residual > 0.0 ? high : low) = at;
    const double next = at - residual / (1.0 + response * slope);
    if (std::abs(next - at) <= 1e-9 * (high - rate)) break;
    at = next > low && next < high ? next : 0.5 * (low + high);
  }
  return std::max(0.0, (at - rate) / mobility);
}

/// Friction impulse that would keep the tangential spring from slipping at this sliding velocity: t' of
/// prepare().
[[gnu::always_inline]] inline Vector3 LargeIslandSolver::trial_friction(const Point& point,
                                                                        const Vector3& sliding) {
  return point.kept * point.impulses.friction + point.stretch_impulse + point.damping * sliding;
}

/// Solves one contact with all others fixed.
///
///     p' = find_normal_impulse(u.n - w p),   t' = disc(trial_friction(P u + (p' - p) P W n), mu p' + bond)
///
/// Friction anticipates the sliding that the new normal impulse causes, so both belong to one iterate. Its
/// limit is by the new normal impulse, not the last iterate's. This minimises no convex function, but its
/// fixed point is Coulomb's law itself.
[[gnu::always_inline]] inline void LargeIslandSolver::relax(std::size_t i) {
  Point& point = points_[i];
  Impulses& impulses = point.impulses;
  const double rate = rate_of(point);
  const double unlimited = find_normal_impulse(i, rate - point.normal_mobility * impulses.normal);
  const double limit = point.friction * unlimited + point.bond;
  const bool open =
      limit == 0.0 && impulses.normal == 0.0 && impulses.friction == Vector3::Zero() && impulses.twist == 0.0;
  if (open && unlimited == 0.0) return;
  const double more = unlimited - impulses.normal;
  const Vector3 velocity = relative_velocity(point);
  const Vector3 sliding = velocity - point.normal.dot(velocity) * point.normal;
  Vector3 friction = trial_friction(point, sliding + more * point.sliding_response);
  limit_friction(limit, friction);
  apply(point, more, friction - impulses.friction);
  impulses.normal = unlimited;
  impulses.friction = friction;
  if (point.twists) relax_twist(i);
}

/// Solves a patch's normal impulses simultaneously if the fade of none acts; otherwise returns false and
/// changes nothing.
///
///     p' = p + (W + 1/(k e))^-1 (d / e - u - p / (k e)),     u with p in it
///
/// Contacts relaxed one after the other would tip a box back and forth, also against its neighbours. Solved
/// together, a centred load on a face causes no rotation.
bool LargeIslandSolver::relax_normals_together(const Patch& patch) {
  Point* const points = &points_[patch.first];
  Body &a = body(points->a), &b = body(points->b);
  const double along = points->normal.dot(a.motion.velocity - b.motion.velocity);
  Eigen::Vector4d missing_speeds = Eigen::Vector4d::Zero();
  bool open = true;
  for (int i = 0; i < patch.count; ++i) {
    const Point& point = points[i];
    const double rate = along + point.lever_a.dot(a.motion.spin) - point.lever_b.dot(b.motion.spin);
    missing_speeds[i] = point.depth / point.ahead - rate - point.compliance * point.impulses.normal;
    open = open && missing_speeds[i] <= 0.0 && point.impulses.normal == 0.0;
  }
  if (open) return true;
  Eigen::Vector4d more = patch.inverse * missing_speeds;
  bool pulls = false;
  for (int i = 0; i < patch.count; ++i) pulls = pulls || points[i].impulses.normal + more[i] < 0.0;
  if (pulls) {
    // Some contacts are open: projected Gauss-Seidel, so that none pulls.
    more.setZero();
    for (int sweep = 0; sweep < kInnerSweeps; ++sweep) {
      for (int i = 0; i < patch.count; ++i) {
        const double change =
            std::max(missing_speeds[i] / patch.system(i, i), -(points[i].impulses.normal + more[i]));
        more[i] += change;
        missing_speeds -= change * patch.system.col(i);
      }
    }
  }
  for (int i = 0; i < patch.count; ++i) {
    const Point& point = points[i];
    const double normal = point.impulses.normal + more[i];
    if (normal > 0.0 && (point.depth / point.ahead - point.compliance * normal) * point.fade > kMinFade)
      return false;
  }
  double sum = 0.0;
  Vector3 turn_a = Vector3::Zero(), turn_b = Vector3::Zero();
  for (int i = 0; i < patch.count; ++i) {
    points[i].impulses.normal += more[i];
    sum += more[i];
    turn_a += more[i] * points[i].turned_a;
    turn_b += more[i] * points[i].turned_b;
  }
  a.motion.velocity += (sum * a.inverse_mass) * points->normal;
  a.motion.spin += turn_a;
  b.motion.velocity -= (sum * b.inverse_mass) * points->normal;
  b.motion.spin -= turn_b;
  return true;
}

/// Solves a contact's friction under its normal impulse.
[[gnu::always_inline]] inline void LargeIslandSolver::relax_friction(Point& point) {
  const double limit = point.friction * point.impulses.normal + point.bond;
  if (limit == 0.0 && point.impulses.friction == Vector3::Zero()) return;
  const Vector3 velocity = relative_velocity(point);
  Vector3 friction = trial_friction(point, velocity - point.normal.dot(velocity) * point.normal);
  limit_friction(limit, friction);
  apply(point, 0.0, friction - point.impulses.friction);
  point.impulses.friction = friction;
}

void LargeIslandSolver::relax(Patch& patch) {
  const auto count = static_cast<std::size_t>(patch.count);
  if (patch.count >= 2 && patch.count <= kMaxTogether && patch.separations < kMaxSeparations) {
    if (relax_normals_together(patch)) {
      for (std::size_t i = 0; i < count; ++i) relax_friction(points_[patch.first + i]);
      return;
    }
    ++patch.separations;
  }
  for (std::size_t i = 0; i < count; ++i) relax(patch.first + i);
}

// As friction, but about n: T' = T + give (k (theta + e w_n) - T) with give = 1 / (1 + k e n'I^-1 n), clamped
// to 2/3 mu a p. Body a is a hand, whose motion is prescribed.
void LargeIslandSolver::relax_twist(std::size_t i) {
  Point& point = points_[i];
  const SpringContact& row = rows_[i];
  const Spring& spring = row.spring;
  Body& b = body(point.b);
  const Vector3 turned = b.inverse_inertia * point.normal;
  const double spin = row.drive_spin - point.normal.dot(b.motion.spin);
  const double stiffness = step_ * spring.twist_stiffness;
  const double limit = spring.patch_friction * point.impulses.normal;
  const double give = 1.0 / (1.0 + stiffness * spring.ahead * point.normal.dot(turned));
  const double unlimited =
      point.impulses.twist + give * (stiffness * (spring.twist + spring.ahead * spin) - point.impulses.twist);
  const double kept = std::max(-limit, std::min(unlimited, limit));
  b.motion.spin += (kept - point.impulses.twist) * turned;
  point.impulses.twist = kept;
}

bool LargeIslandSolver::acts() const {
  return std::any_of(points_.begin(), points_.end(),
                     [](const Point& point) { return point.impulses.normal > 0.0 || point.bond > 0.0; });
}

// Symmetric sweep: a stack's load spreads through it in either direction within one sweep. Sweeps in one
// direction only would spread it by one body a sweep in the other. Conjugate directions also need a symmetric
// sweep (SSOR).
void LargeIslandSolver::sweep() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) motions_before_[i] = bodies_[i].motion;
  for (std::size_t i = 0; i < points_.size(); ++i) impulses_before_[i] = points_[i].impulses;
  for (Patch& patch : patches_) relax(patch);
  for (std::size_t i = patches_.size(); i-- > 0;) relax(patches_[i]);
}

/// Extrapolates along the previous search direction, made conjugate by Fletcher and Reeves' rule. The factor
/// is the ratio of the squared changes of two sweeps, or 0 if they have grown. `last` is the squared change
/// of the previous sweep; returns that of this one.
///
///     d_k = x_sweep - x_before,     beta = |d_k|^2 / |d_k-1|^2 < 1, else 0,      s_k = d_k + beta s_k-1
///     x <- x_sweep + beta s_k-1
///
/// This holds for all impulses, and for velocities, which depend on them linearly. It precedes a sweep and
/// never follows the last: extrapolated normal impulses may pull, and friction may leave its disc, until
/// contacts are relaxed.
double LargeIslandSolver::accelerate(double last) {
  double square = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Impulses change = points_[i].impulses - impulses_before_[i];
    square += change.normal * change.normal + change.friction.squaredNorm();
  }
  const double ratio = last > 0.0 && square < last ? square / last : 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Impulses& now = points_[i].impulses;
    const Impulses on = ratio * impulse_directions_[i];
    impulse_directions_[i] = on + now - impulses_before_[i];
    now = now + on;
  }
  for (std::size_t i = 0; i < free_.size(); ++i) {
    Motion& now = bodies_[i].motion;
    const Motion on = ratio * motion_directions_[i];
    motion_directions_[i] = on + now - motions_before_[i];
    now = now + on;
  }
  return square;
}

/// True if no body is faster than a fall of kRestFallSteps steps.
bool LargeIslandSolver::is_nearly_at_rest(const ContactStep& step) const {
  const double slow = kRestFallSteps * step_ * step.gravity.norm();
  return std::all_of(bodies_.begin(), bodies_.end(),
                     [slow](const Body& body) { return body.motion.velocity.norm() < slow; });
}

// Ends when a sweep changes no velocity by more than kConverged of the contacts' total change, or with the
// budget. The remaining error is an impulse that both bodies lack, so it changes no momentum; the next step
// solves for it.
void LargeIslandSolver::solve(const ContactStep& step) {
  impulses_before_.resize(points_.size());
  impulse_directions_.assign(points_.size(), {0.0, Vector3::Zero(), 0.0});
  motions_before_.resize(bodies_.size());
  motion_directions_.assign(bodies_.size(), {Vector3::Zero(), Vector3::Zero()});
  // Largest change of a body's velocity since `then` [m/s].
  const auto max_change = [this](const std::vector<Motion>& then) {
    double largest = 0.0;
    for (std::size_t i = 0; i < free_.size(); ++i)
      largest = std::max(largest, (bodies_[i].motion.velocity - then[i].velocity).squaredNorm());
    return std::sqrt(largest);
  };
  const auto points = static_cast<int>(points_.size());
  const int max_sweeps = std::clamp(kRelaxationBudget / std::max(1, points), kMinSweeps, kMaxSweeps);
  double last = 0.0;
  for (int i = 1; i <= max_sweeps || (i <= kMaxSweepsAtRest && is_nearly_at_rest(step)); ++i) {
    if (i > 1) last = accelerate(last);
    sweep();
    const bool converged = max_change(motions_before_) <= kConverged * max_change(free_);
    if (!admit_closing(step) && converged) break;
  }
}

/// Writes the response that settle() reads. Forces are impulses over the step. The trial force is
/// that of trial_friction(). At the fixed point it is k q+ where the contact sticks. It exceeds the limit
/// where k q+ does, as t' - t = give (k q+ - t).
void LargeIslandSolver::fill_response(std::size_t i) {
  const Point& point = points_[i];
  const Vector3 velocity = relative_velocity(point);
  const Vector3 sliding = velocity - point.normal.dot(velocity) * point.normal;
  SpringContact& row = rows_[i];
  row.response = {};
  row.response.force = triple((point.impulses.friction - point.impulses.normal * point.normal) / step_);
  row.response.normal_force = point.impulses.normal / step_;
  row.response.torque = point.impulses.twist / step_;
  row.response.trial_squared = trial_friction(point, sliding).squaredNorm() / (step_ * step_);
  row.response.drawn = triple(vector(row.spring.stretch) + point.ahead * sliding);
  row.spring.slip_limit = (point.friction * point.impulses.normal + point.bond) / step_;
}

//     p += h m g + sum +-J,     L += sum +-(r x t - p l + T n)
//
// Momenta are summed from the impulses, not taken from the velocities. So b gains what a loses up to rounding
// of the sums, however far sweeps have converged.
void LargeIslandSolver::finish(ContactStep& step, const Island& island) {
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const std::size_t index = island.bodies.begin()[k].body;
    BodyState& state = step.bodies[index];
    state.linear_momentum += (step_ * step.scene.bodies[index].mass) * step.gravity;
    state.pushed.linear = (bodies_[k].motion.velocity - free_[k].velocity) / step_;
    state.pushed.angular = (bodies_[k].motion.spin - free_[k].spin) / step_;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const Impulses& impulses = point.impulses;
    const Vector3 impulse = impulses.friction - impulses.normal * point.normal;
    const auto give = [&](int body, double sign, const Vector3& arm, const Vector3& lever) {
      BodyState& state = step.bodies[island.bodies.begin()[body].body];
      state.linear_momentum += sign * impulse;
      state.angular_momentum +=
          sign * (arm.cross(impulses.friction) - impulses.normal * lever + impulses.twist * point.normal);
    };
    give(point.b, 1.0, point.arm_b, point.lever_b);
    if (point.a != static_cast<int>(free_.size())) give(point.a, -1.0, point.arm_a, point.lever_a);
    fill_response(i);
  }
  const SpringContact* row = settle_hand_rows(step, island, rows_.data());
  for (const std::size_t index : linked_) settle(step, *row++, step.body_contacts[index]);
  for (const Range& range : open_) {
    for (std::size_t i = range.first; i < range.last; ++i)
      step.body_contacts[i].friction = Friction::sticking;
  }
}

}  // namespace mrhi
