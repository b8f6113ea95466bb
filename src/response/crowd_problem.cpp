#include "crowd_problem.h"

#include <algorithm>
#include <cmath>

#include "impact.h"
#include "spring_contact.h"

namespace mrhi {
namespace {

/// A crowd's budget: contacts relaxed to and fro in a step, but this many turns at least, and at most.
constexpr int kMostWork = 1000, kLeastTurns = 8, kMostTurns = 30;
/// Where nothing is faster than what falls for so many steps, there are more: what comes to rest should.
constexpr double kNearlyRests = 1.0;
constexpr int kTurnsAtRest = 80;
/// A turn that changes velocities by less, as a part of what contacts have made of them, is the last.
constexpr double kConverged = 1e-6;
/// A contact's point is within this part of its body's radius, margin and all.
constexpr double kRoom = 1.2;
constexpr double kNever = 1e300;  // [m/s]
/// A finger that yields has a push that is not simply proportional to depth.
constexpr double kNeverYields = 1e6;
/// Below this part of the speed at which a release gives no push any more, it takes nothing of it.
constexpr double kNotParting = 1e-3;
/// Newton's method for one push.
constexpr int kMostGuesses = 12;
/// Contacts of a patch that are solved together, at most.
constexpr int kMostTogether = 4;
/// A patch that parts in so many sweeps is relaxed contact by contact for the rest of the step.
constexpr int kMaxPartings = 3;
/// Sweeps through a patch some of whose contacts do not press.
constexpr int kInnerSweeps = 3;

/// Of one pair of shapes, with one normal.
bool same_patch(const BodyContact& x, const BodyContact& y) {
  return x.key.order() >> 8 == y.key.order() >> 8 && x.normal == y.normal;
}

}  // namespace

// u* = (p / m + h g, I^-1 L) of each body, on which impulses then act at once: unlike in BodyProblem what
// is sought are the contacts' impulses, and the velocities, u* + M^-1 J' of them, are kept up with each
// that changes. Fixtures and hands are the last body, with 1/m and I^-1 of 0.
void CrowdProblem::begin(const ContactStep& step, const Island& island,
                         const ContactConfiguration& configuration, const std::vector<Vector3>& carried) {
  step_ = step.step;
  bodies_.clear();
  free_.clear();
  longest_arm_ = 0.0;
  number_.assign(step.bodies.size(), -1);
  for (const IslandBody& body : island.bodies) {
    number_[body.body] = static_cast<int>(bodies_.size());
    add_body(step.scene.bodies[body.body], step.bodies[body.body], step);
  }
  bodies_.push_back({{Vector3::Zero(), Vector3::Zero()}, 0.0, Matrix3::Zero()});
  configuration_ = &configuration;
  carried_ = &carried;
  contacts_.clear();
  points_.clear();
  patches_.clear();
  linked_.clear();
  apart_.clear();
  add_hands(step, island);
  add_grips(step, island);
  add_links(step, island);
}

void CrowdProblem::add_body(const mrhi::Body& body, const BodyState& state, const ContactStep& step) {
  const Matrix3 inverse_inertia = world_inverse_inertia(body, state.pose.orientation);
  free_.push_back(
      {state.linear_momentum / body.mass + step_ * step.gravity, inverse_inertia * state.angular_momentum});
  bodies_.push_back({free_.back(), 1.0 / body.mass, inverse_inertia});
  longest_arm_ = std::max(longest_arm_, kRoom * body.bounding_radius);
}

template <typename AnyContact>
SpringContact& CrowdProblem::add_spring(const ContactStep& step, const AnyContact& contact) {
  contacts_.emplace_back();
  make_spring(step, *configuration_, contact, contacts_.back());
  return contacts_.back();
}

void CrowdProblem::add_hands(const ContactStep& step, const Island& island) {
  const int still = static_cast<int>(free_.size());
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (step.contacts[i].ignored) continue;
      add_point(add_spring(step, step.contacts[i]), still, number_[body.body], Vector3::Zero());
      patches_.push_back({points_.size() - 1, 1, 0, {}, {}});
    }
  }
}

void CrowdProblem::add_grips(const ContactStep& step, const Island& island) {
  const int still = static_cast<int>(free_.size());
  for (const IslandBody& body : island.bodies) {
    for (const Grip& grip : step.grips) {
      if (!grip.active || grip.body != body.body) continue;
      for (int point = 0; point < kGripPoints; ++point) {
        contacts_.emplace_back();
        make_grip_spring(step, *configuration_, grip, point, contacts_.back());
        add_point(contacts_.back(), still, number_[body.body], Vector3::Zero());
        patches_.push_back({points_.size() - 1, 1, 0, {}, {}});
      }
    }
  }
}

/// Contacts come sorted, so those of a pair of shapes follow each other.
void CrowdProblem::add_links(const ContactStep& step, const Island& island) {
  const std::vector<Vector3>& carried = *carried_;
  for (const Link* link = island.links.begin(); link != island.links.end();) {
    const BodyContact& first = step.body_contacts[link->index];
    Touch touch{link->index, link->index};
    bool bore = false;
    for (; link != island.links.end() && same_patch(step.body_contacts[link->index], first); ++link) {
      bore = bore || carried[touch.last] != Vector3::Zero();
      ++touch.last;
    }
    if (step.body_contacts[touch.first].share <= 0.0) continue;  // too narrow a strip for springs
    if (bore) {
      add_patch(step, touch);
    } else {
      apart_.push_back(touch);
    }
  }
  seen_.clear();
  least_missing_ = 0.0;
  admit(step);
}

void CrowdProblem::add_patch(const ContactStep& step, const Touch& touch) {
  const std::vector<Vector3>& carried = *carried_;
  Patch patch{points_.size(), static_cast<int>(touch.last - touch.first), 0, {}, {}};
  for (std::size_t index = touch.first; index < touch.last; ++index) {
    const BodyContact& contact = step.body_contacts[index];
    const int a =
        step.scene.bodies[contact.key.a].fixed ? static_cast<int>(free_.size()) : number_[contact.key.a];
    add_point(add_spring(step, contact), a, number_[contact.key.b], contact.arm_a + contact.friction_offset);
    linked_.push_back(index);
    if (carried[index] != Vector3::Zero()) carry(carried[index], points_.back());
  }
  weigh(patch);
  patches_.push_back(patch);
}

/// How much faster the surfaces would have to close to press on each other [m/s].
///
///     missing = n.(c_a' - c_b') - d / e,      e the time that the spring looks ahead
///
/// as d+ = d - e n.u > 0 is what presses. e is not the same on both sides of d = 0 (look_ahead in
/// spring_contact.cpp).
double CrowdProblem::missing_speed(const ContactStep& step, const Touch& touch) const {
  double least = kNever;
  for (std::size_t i = touch.first; i < touch.last; ++i) {
    const BodyContact& contact = step.body_contacts[i];
    const Motion& b = bodies_[static_cast<std::size_t>(number_[contact.key.b])].motion;
    const int number = number_[contact.key.a];
    const Motion& a = (number < 0 ? bodies_.back() : bodies_[static_cast<std::size_t>(number)]).motion;
    const Vector3 velocity =
        a.velocity + a.spin.cross(contact.arm_a) - b.velocity - b.spin.cross(contact.arm_b);
    const double ahead = contact.depth > 0.0 ? look_ahead(step_, configuration_->damping) : step_;
    least = std::min(least, contact.normal.dot(velocity) - contact.depth / ahead);
  }
  return least;
}

/// By how much two surfaces may close faster than when contacts were last looked at, at most [m/s].
/// A point of a body at an arm r changes by |dv + dw x r| <= |dv| + |r| |dw|, and two bodies by twice the
/// most of one. So long as that is below the least that was missing then, nothing can press that did not,
/// and no contact is looked at.
double CrowdProblem::faster_since() const {
  double most = 0.0;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Motion &now = bodies_[i].motion, &then = seen_[i];
    most =
        std::max(most, (now.velocity - then.velocity).norm() + longest_arm_ * (now.spin - then.spin).norm());
  }
  return 2.0 * most;
}

/// Takes in what was apart and will now press; true if there is any.
/// What is taken in is not left out again in this step: it may come to bear nothing, which costs little.
bool CrowdProblem::admit(const ContactStep& step) {
  if (apart_.empty() || faster_since() < least_missing_) return false;
  seen_.clear();
  for (const Body& body : bodies_) seen_.push_back(body.motion);
  least_missing_ = kNever;
  const std::size_t before = points_.size();
  const auto kept = std::remove_if(apart_.begin(), apart_.end(), [&](const Touch& touch) {
    const double missing = missing_speed(step, touch);
    const bool presses = missing < 0.0;
    if (presses) add_patch(step, touch);
    if (!presses) least_missing_ = std::min(least_missing_, missing);
    return presses;
  });
  apart_.erase(kept, apart_.end());
  given_before_.resize(points_.size());
  given_along_.resize(points_.size(), {0.0, Vector3::Zero(), 0.0});
  return points_.size() > before;
}

CrowdProblem::Point& CrowdProblem::add_point(const SpringContact& contact, int a, int b,
                                             const Vector3& arm_a) {
  const Spring& spring = contact.spring;
  points_.emplace_back();
  Point& point = points_.back();  // with impulses in place of forces: stiffness is times the step
  point.a = a, point.b = b;
  point.normal = vector(spring.normal);
  point.arm_a = arm_a, point.arm_b = vector(contact.arm);
  point.drive = vector(contact.drive);
  point.depth = spring.depth, point.ahead = spring.ahead, point.fade = spring.fade;
  point.stiffness = step_ * spring.stiffness;
  point.friction = spring.friction;
  point.bond = step_ * spring.bond;
  point.soft = spring.pad > 0.0 || spring.yields < kNeverYields;
  point.twists = spring.twist_stiffness > 0.0;
  point.given = {0.0, Vector3::Zero(), 0.0};
  weigh(contact, point);
  return point;
}

/// A spring with the law p = k (d - e u), which looks ahead by e, on bodies that give way by u = u0 + w p,
/// has p = k / (1 + k e w) * (d - e u0), with u0 the rate without it: `firm`. Along the surface the same with
/// the stretch, for t = k (s + e u) and u = u0 - w t, in terms of the rate u that there is with the last t:
/// t' = kept t + pulled + pull u.
///
///     along n:   p = k (d - e u),   u = u_0 + w p:     p = k / (1 + k e w) (d - e u_0),   u_0 = u - w p_last
///     across:    t' = k (s + e (u + w t - w t')):      t' = (1 - give) t + give k (s + e u)
///                give = 1 / (1 + k e w)
///
/// k has the step in it (N s/m). Signs differ because n points from b to a and the push on b is -p n, which
/// parts them, while t is along the sliding, which it slows down. Put in as it stands t' = k (s + e u),
/// with u by the last t, would not converge for k e w > 1, which stiff contacts are far beyond.
void CrowdProblem::weigh(const SpringContact& contact, Point& point) const {
  const Body &a = bodies_[static_cast<std::size_t>(point.a)], &b = bodies_[static_cast<std::size_t>(point.b)];
  const Matrix3 response = collision_matrix(a.inverse_mass, a.inverse_inertia, point.arm_a) +
                           collision_matrix(b.inverse_mass, b.inverse_inertia, point.arm_b);
  const Vector3 &n = point.normal, tilt = vector(contact.tilt);
  point.lever_a = point.arm_a.cross(n) + tilt, point.lever_b = point.arm_b.cross(n) + tilt;
  point.turned_a = a.inverse_inertia * point.lever_a, point.turned_b = b.inverse_inertia * point.lever_b;
  point.normal_mobility = (a.inverse_mass + b.inverse_mass) * n.squaredNorm() +
                          point.lever_a.dot(point.turned_a) + point.lever_b.dot(point.turned_b);
  // A push makes the surfaces slide as well, where its arm is not along n.
  const Vector3 by_push = point.turned_a.cross(point.arm_a) + point.turned_b.cross(point.arm_b);
  point.slides = by_push - n.dot(by_push) * n;
  const double tangential_mobility = max_tangential_response(response, point.normal);
  point.compliance = 1.0 / (point.stiffness * point.ahead);
  point.firm = point.stiffness / (1.0 + point.stiffness * point.ahead * point.normal_mobility);
  const double give = 1.0 / (1.0 + point.stiffness * point.ahead * tangential_mobility);
  point.kept = 1.0 - give;
  point.pull = give * point.stiffness * point.ahead;
  point.pulled = (give * point.stiffness) * vector(contact.spring.stretch);
}

/// Pushes p of a patch change its rates by W p, and springs bear k (d - e u), k with the step in it:
///
///     (W + 1/(k e)) p = d / e - u_0,      W_ij = 1/m_a + 1/m_b + l_ai.I_a^-1 l_aj + l_bi.I_b^-1 l_bj,   l =
///     r x n
///
/// Unused rows are the identity's. 1/(k e) keeps it regular, though four points bear three loads.
void CrowdProblem::weigh(Patch& patch) const {
  if (patch.count < 2 || patch.count > kMostTogether) return;
  Eigen::Matrix4d& system = patch.system;
  system.setIdentity();
  for (int i = 0; i < patch.count; ++i) {
    const Point& x = points_[patch.first + static_cast<std::size_t>(i)];
    const double inverse_mass = bodies_[static_cast<std::size_t>(x.a)].inverse_mass +
                                bodies_[static_cast<std::size_t>(x.b)].inverse_mass;
    for (int j = 0; j <= i; ++j) {
      const Point& y = points_[patch.first + static_cast<std::size_t>(j)];
      system(i, j) = system(j, i) = inverse_mass + x.lever_a.dot(y.turned_a) + x.lever_b.dot(y.turned_b);
    }
    system(i, i) += x.compliance;
  }
  patch.inverse = system.inverse();
}

// The last step's force, by this step's normal, as the first guess: f = t - p n, so p = -n.f. One that
// would pull by now is cut off. What is at rest is solved by it to begin with.
void CrowdProblem::carry(const Vector3& borne, Point& point) {
  const double along = borne.dot(point.normal);
  point.given = {step_ * std::max(0.0, -along), step_ * (borne - along * point.normal), 0.0};
  apply(point, point.given.push, point.given.drag);
}

[[gnu::always_inline]] inline Vector3 CrowdProblem::relative_velocity(const Point& point) const {
  const Motion& a = bodies_[static_cast<std::size_t>(point.a)].motion;
  const Motion& b = bodies_[static_cast<std::size_t>(point.b)].motion;
  return point.drive + a.velocity + a.spin.cross(point.arm_a) - b.velocity - b.spin.cross(point.arm_b);
}

/// Rate of the gap where the push acts.
[[gnu::always_inline]] inline double CrowdProblem::rate_of(const Point& point) const {
  const Motion& a = bodies_[static_cast<std::size_t>(point.a)].motion;
  const Motion& b = bodies_[static_cast<std::size_t>(point.b)].motion;
  return point.normal.dot(point.drive + a.velocity - b.velocity) + point.lever_a.dot(a.spin) -
         point.lever_b.dot(b.spin);
}

//     J = t - p n:    v_b += J / m_b,  w_b += I_b^-1 (b x t - p l_b),      v_a and w_a by -J
[[gnu::always_inline]] inline void CrowdProblem::apply(const Point& point, double push, const Vector3& drag) {
  Body &a = bodies_[static_cast<std::size_t>(point.a)], &b = bodies_[static_cast<std::size_t>(point.b)];
  const Vector3 impulse = drag - push * point.normal;
  a.motion.velocity -= a.inverse_mass * impulse;
  a.motion.spin -= a.inverse_inertia * point.arm_a.cross(drag) - push * point.turned_a;
  b.motion.velocity += b.inverse_mass * impulse;
  b.motion.spin += b.inverse_inertia * point.arm_b.cross(drag) - push * point.turned_b;
}

/// Impulse that the spring gives at a rate, and how fast that falls with it: p = k d (1 - (u / u_f)^2) where
/// the surfaces part at u, so that what is let go is not thrown off (docs/contact.md, release).
///
///     -dp/du = k (p'(d+) e (1 - r^2) + 2 p(d+) r / u_f),      r = u / u_f, no fading left where r = 1
double CrowdProblem::push_at(std::size_t i, double rate, double& slope) const {
  const Point& point = points_[i];
  const double deep = std::max(0.0, point.depth - point.ahead * rate);
  const double parting = std::min(std::max(rate, 0.0) * point.fade, 1.0), kept = 1.0 - parting * parting;
  double pressed = deep, steepness = deep > 0.0 ? 1.0 : 0.0;
  if (point.soft) contacts_[i].spring.press(deep, pressed, steepness);
  const double fading = parting < 1.0 ? 2.0 * pressed * parting * point.fade : 0.0;
  slope = point.stiffness * (steepness * point.ahead * kept + fading);
  return point.stiffness * pressed * kept;
}

/// The push that its own law asks for, where without it the rate would be `rate`.
/// By its own law without fade and pulp it is in closed form, `firm`. The rate with that push is the
/// highest there can be; where even that hardly parts, the fade, which goes by the square, takes a
/// millionth at most.
[[gnu::always_inline]] inline double CrowdProblem::find_push(std::size_t i, double rate) const {
  const Point& point = points_[i];
  const double deep = point.depth - point.ahead * rate;
  if (deep <= 0.0) return 0.0;
  const double plain = point.firm * deep;
  if (!point.soft && (rate + point.normal_mobility * plain) * point.fade <= kNotParting) return plain;
  return find_faded_push(i, rate, plain);
}

/// Newton's method, kept between what is known to be too little and too much.
///
///     g(u) = u - u_0 - w p(u) = 0,     g' = 1 - w dp/du >= 1       in u_0 <= u <= u_0 + w k_firm d+
///
/// g grows, so there is one zero, and p at it follows from p = (u - u_0) / w. The upper end is where the
/// plain spring has it: pulp and fade only give less. A step of Newton's that leaves the bracket gives way
/// to halving it: beyond the release speed p is 0, and tells nothing of where it begins.
double CrowdProblem::find_faded_push(std::size_t i, double rate, double plain) const {
  const double mobility = points_[i].normal_mobility;
  double low = rate, high = rate + mobility * plain, at = high;
  for (int guess = 0; guess < kMostGuesses; ++guess) {
    double slope;
    const double off = at - rate - mobility * push_at(i, at, slope);
    (off > 0.0 ? high : low) = at;
    const double next = at - off / (1.0 + mobility * slope);
    if (std::abs(next - at) <= 1e-9 * (high - rate)) break;
    at = next > low && next < high ? next : 0.5 * (low + high);
  }
  return std::max(0.0, (at - rate) / mobility);
}

/// What friction would need to be for the tangential spring to be held, where the surfaces slide so.
/// t' of weigh().
[[gnu::always_inline]] inline Vector3 CrowdProblem::wanted_drag(const Point& point, const Vector3& sliding) {
  return point.kept * point.given.drag + point.pulled + point.pull * sliding;
}

/// Gives a contact what it asks for.
///
///     p' = find_push(u.n - w p),      t' = disc(wanted_drag(P u + (p' - p) P W n), mu p' + bond)
///
/// The sliding that the new push makes is foreseen, so that push and friction are of one moment. Limits are
/// those of the new push, not of the last iterate's: no convex function is behind this, but the fixed point
/// is Coulomb's law itself.
[[gnu::always_inline]] inline void CrowdProblem::relax(std::size_t i) {
  Point& point = points_[i];
  const double rate = rate_of(point);
  const double wanted = find_push(i, rate - point.normal_mobility * point.given.push);
  const double limit = point.friction * wanted + point.bond;
  const bool open = limit == 0.0 && point.given.push == 0.0 && point.given.drag == Vector3::Zero() &&
                    point.given.twist == 0.0;
  if (open && wanted == 0.0) return;
  const double more = wanted - point.given.push;
  const Vector3 velocity = relative_velocity(point);
  const Vector3 sliding = velocity - point.normal.dot(velocity) * point.normal;
  Vector3 drag = wanted_drag(point, sliding + more * point.slides);
  const double squared = drag.squaredNorm();
  if (squared > limit * limit) drag *= limit / std::sqrt(squared);
  apply(point, more, drag - point.given.drag);
  point.given.push = wanted;
  point.given.drag = drag;
  if (point.twists) twist(i);
}

/// Gives a patch's pushes what they ask for together, where none of them would pull and nothing parts;
/// returns false and changes nothing otherwise.
///
///     p' = p + (W + 1/(k e))^-1 (d / e - u - p / (k e)),     u with p in it
///
/// So a load on a face turns nothing that it would not turn at the end: points solved one after the other tip
/// a box to and fro, and against what is beside it.
bool CrowdProblem::push_together(const Patch& patch) {
  Point* const points = &points_[patch.first];
  const Body &a = bodies_[static_cast<std::size_t>(points->a)],
             &b = bodies_[static_cast<std::size_t>(points->b)];
  const double along = points->normal.dot(a.motion.velocity - b.motion.velocity);
  Eigen::Vector4d missing = Eigen::Vector4d::Zero();
  bool open = true;
  for (int i = 0; i < patch.count; ++i) {
    const Point& point = points[i];
    const double rate = along + point.lever_a.dot(a.motion.spin) - point.lever_b.dot(b.motion.spin);
    missing[i] = point.depth / point.ahead - rate - point.compliance * point.given.push;
    open = open && missing[i] <= 0.0 && point.given.push == 0.0;
  }
  if (open) return true;
  Eigen::Vector4d more = patch.inverse * missing;
  bool pulls = false;
  for (int i = 0; i < patch.count; ++i) pulls = pulls || points[i].given.push + more[i] < 0.0;
  if (pulls) {
    // Not all four press: one after the other, none pulling (projected Gauss-Seidel).
    more.setZero();
    for (int sweep = 0; sweep < kInnerSweeps; ++sweep) {
      for (int i = 0; i < patch.count; ++i) {
        const double change = std::max(missing[i] / patch.system(i, i), -(points[i].given.push + more[i]));
        more[i] += change;
        missing -= change * patch.system.col(i);
      }
    }
  }
  for (int i = 0; i < patch.count; ++i) {
    const Point& point = points[i];
    const double push = point.given.push + more[i];
    if (push > 0.0 && (point.depth / point.ahead - point.compliance * push) * point.fade > kNotParting)
      return false;
  }
  double sum = 0.0;
  Vector3 turn_a = Vector3::Zero(), turn_b = Vector3::Zero();
  for (int i = 0; i < patch.count; ++i) {
    Point& point = points[i];
    point.given.push += more[i];
    sum += more[i];
    turn_a += more[i] * point.turned_a;
    turn_b += more[i] * point.turned_b;
  }
  Motion &of_a = bodies_[static_cast<std::size_t>(points->a)].motion,
         &of_b = bodies_[static_cast<std::size_t>(points->b)].motion;
  of_a.velocity += (sum * a.inverse_mass) * points->normal;
  of_a.spin += turn_a;
  of_b.velocity -= (sum * b.inverse_mass) * points->normal;
  of_b.spin -= turn_b;
  return true;
}

/// Gives a contact the drag that it asks for under its push.
[[gnu::always_inline]] inline void CrowdProblem::drag(Point& point) {
  const double limit = point.friction * point.given.push + point.bond;
  if (limit == 0.0 && point.given.drag == Vector3::Zero()) return;
  const Vector3 velocity = relative_velocity(point);
  Vector3 drag = wanted_drag(point, velocity - point.normal.dot(velocity) * point.normal);
  const double squared = drag.squaredNorm();
  if (squared > limit * limit) drag *= limit / std::sqrt(squared);
  apply(point, 0.0, drag - point.given.drag);
  point.given.drag = drag;
}

void CrowdProblem::relax(Patch& patch) {
  const auto count = static_cast<std::size_t>(patch.count);
  if (patch.count >= 2 && patch.count <= kMostTogether && patch.partings < kMaxPartings) {
    if (push_together(patch)) {
      for (std::size_t i = 0; i < count; ++i) drag(points_[patch.first + i]);
      return;
    }
    ++patch.partings;
  }
  for (std::size_t i = 0; i < count; ++i) relax(patch.first + i);
}

// As the drag, about n: T' = T + give (k (theta + e w_n) - T) with give = 1 / (1 + k e n'I^-1 n), clamped
// to 2/3 mu a p. Body a is a hand, which nothing turns.
void CrowdProblem::twist(std::size_t i) {
  Point& point = points_[i];
  const SpringContact& contact = contacts_[i];
  const Spring& spring = contact.spring;
  Body& b = bodies_[static_cast<std::size_t>(point.b)];
  const Vector3 turned = b.inverse_inertia * point.normal;
  const double spin = contact.drive_spin - point.normal.dot(b.motion.spin);
  const double stiffness = step_ * spring.twist_stiffness, limit = spring.patch_friction * point.given.push;
  const double give = 1.0 / (1.0 + stiffness * spring.ahead * point.normal.dot(turned));
  const double wanted =
      point.given.twist + give * (stiffness * (spring.twist + spring.ahead * spin) - point.given.twist);
  const double kept = std::max(-limit, std::min(wanted, limit));
  b.motion.spin += (kept - point.given.twist) * turned;
  point.given.twist = kept;
}

bool CrowdProblem::pressed() const {
  return std::any_of(points_.begin(), points_.end(),
                     [](const Point& point) { return point.given.push > 0.0 || point.bond > 0.0; });
}

// To and fro: what a stack bears runs down it in one sweep and up it in the other, where sweeps one way
// would carry it by one body a sweep in the other direction. And such a turn is symmetric (SSOR), as
// conjugate directions ask of what they go on from.
void CrowdProblem::turn() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) motions_before_[i] = bodies_[i].motion;
  for (std::size_t i = 0; i < points_.size(); ++i) given_before_[i] = points_[i].given;
  for (Patch& patch : patches_) relax(patch);
  for (std::size_t i = patches_.size(); i-- > 0;) relax(patches_[i]);
}

/// Of the bodies' velocities in the last turn, at most [m/s].
double CrowdProblem::changed() const {
  double most = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    most = std::max(most, (bodies_[i].motion.velocity - motions_before_[i].velocity).squaredNorm());
  return std::sqrt(most);
}

double CrowdProblem::made_by_contacts() const {
  double most = 0.0;
  for (std::size_t i = 0; i < free_.size(); ++i)
    most = std::max(most, (bodies_[i].motion.velocity - free_[i].velocity).squaredNorm());
  return std::sqrt(most);
}

/// Carries on in the direction of the turns before, conjugate to this one by Fletcher and Reeves' rule (the
/// ratio of the squares of what two turns have changed; none where that has grown); `last` is the square of
/// what the turn before has changed. Returns that of this one.
///
///     d_k = x_turn - x_before,     beta = |d_k|^2 / |d_k-1|^2 < 1, else 0,      s_k = d_k + beta s_k-1
///     x <- x_turn + beta s_k-1
///
/// of all that is given and of velocities alike, which hang on it linearly. It comes before a turn and never
/// after the last: a push may be negative and a drag outside its disc until contacts have been relaxed.
double CrowdProblem::keep_going(double last) {
  double square = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Given &now = points_[i].given, &before = given_before_[i];
    square += (now.push - before.push) * (now.push - before.push) + (now.drag - before.drag).squaredNorm();
  }
  const double part = last > 0.0 && square < last ? square / last : 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Given &now = points_[i].given, &before = given_before_[i], &along = given_along_[i];
    const Given on{part * along.push, part * along.drag, part * along.twist};
    along = {on.push + now.push - before.push, on.drag + now.drag - before.drag,
             on.twist + now.twist - before.twist};
    now = {now.push + on.push, now.drag + on.drag, now.twist + on.twist};
  }
  for (std::size_t i = 0; i < free_.size(); ++i) {
    Motion &now = bodies_[i].motion, &before = motions_before_[i], &along = motions_along_[i];
    const Motion on{part * along.velocity, part * along.spin};
    along = {on.velocity + now.velocity - before.velocity, on.spin + now.spin - before.spin};
    now = {now.velocity + on.velocity, now.spin + on.spin};
  }
  return square;
}

/// True if no body is faster than a fall of a few steps.
bool CrowdProblem::nearly_rests(const ContactStep& step) const {
  const double slow = kNearlyRests * step_ * step.gravity.norm();
  return std::all_of(bodies_.begin(), bodies_.end(),
                     [slow](const Body& body) { return body.motion.velocity.norm() < slow; });
}

// Ends where a turn changes no velocity by more than 1e-6 of what contacts have made of them, or with the
// budget. What is undone then is an impulse that both bodies lack, hence no momentum, and is the next
// step's.
void CrowdProblem::solve(const ContactStep& step) {
  given_before_.resize(points_.size());
  given_along_.assign(points_.size(), {0.0, Vector3::Zero(), 0.0});
  motions_before_.resize(bodies_.size());
  motions_along_.assign(bodies_.size(), {Vector3::Zero(), Vector3::Zero()});
  const auto points = static_cast<int>(points_.size());
  const int most = std::clamp(kMostWork / std::max(1, points), kLeastTurns, kMostTurns);
  double last = 0.0;
  for (int i = 1; i <= most || (i <= kTurnsAtRest && nearly_rests(step)); ++i) {
    if (i > 1) last = keep_going(last);
    turn();
    const double made = made_by_contacts();
    const bool done = changed() <= kConverged * made;
    if (!admit(step) && done) break;
  }
}

/// What the springs' settling looks at.
/// Impulses over the step are forces. `wanted` is that of wanted_drag(): at the fixed point k q+ where a
/// contact sticks, and as k q+ beyond the limit where it slips, as t' - t = give (k q+ - t).
void CrowdProblem::report(std::size_t i) {
  const Point& point = points_[i];
  const Vector3 velocity = relative_velocity(point);
  const Vector3 sliding = velocity - point.normal.dot(velocity) * point.normal;
  SpringContact& contact = contacts_[i];
  contact.response = {};
  contact.response.force = triple((point.given.drag - point.given.push * point.normal) / step_);
  contact.response.push = point.given.push / step_;
  contact.response.torque = point.given.twist / step_;
  contact.response.wanted_squared = wanted_drag(point, sliding).squaredNorm() / (step_ * step_);
  contact.response.drawn = triple(vector(contact.spring.stretch) + point.ahead * sliding);
  contact.spring.slip_limit = (point.friction * point.given.push + point.bond) / step_;
}

//     p += h m g + sum +-J,     L += sum +-(r x t - p l + T n)
//
// Momenta are summed from the impulses, not taken from the velocities: what b gets a loses to the last bit
// but rounding of the sums, wherever turns have ended.
void CrowdProblem::finish(ContactStep& step, const Island& island) {
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const std::size_t index = island.bodies.begin()[k].body;
    BodyState& state = step.bodies[index];
    state.linear_momentum += (step_ * step.scene.bodies[index].mass) * step.gravity;
    state.pushed.linear = (bodies_[k].motion.velocity - free_[k].velocity) / step_;
    state.pushed.angular = (bodies_[k].motion.spin - free_[k].spin) / step_;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const Vector3 impulse = point.given.drag - point.given.push * point.normal;
    const auto give = [&](int body, double sign, const Vector3& arm, const Vector3& lever) {
      BodyState& state = step.bodies[island.bodies.begin()[body].body];
      state.linear_momentum += sign * impulse;
      state.angular_momentum +=
          sign * (arm.cross(point.given.drag) - point.given.push * lever + point.given.twist * point.normal);
    };
    give(point.b, 1.0, point.arm_b, point.lever_b);
    if (point.a != static_cast<int>(free_.size())) give(point.a, -1.0, point.arm_a, point.lever_a);
    report(i);
  }
  auto contact = settle_hands(step, island, contacts_.begin());
  for (const std::size_t index : linked_) settle(step, *contact++, step.body_contacts[index]);
  for (const Touch& touch : apart_) {
    for (std::size_t i = touch.first; i < touch.last; ++i)
      step.body_contacts[i].friction = Friction::sticking;
  }
}

}  // namespace mrhi
