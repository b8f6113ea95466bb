#include "crowd_problem.h"

#include <algorithm>
#include <cmath>

#include "spring_contact.h"

namespace mrhi {
namespace {

/// A crowd's budget: contacts relaxed to and fro in a step, but this many turns at least, and at most.
constexpr int kMostWork = 1000, kLeastTurns = 10, kMostTurns = 40;
/// Where nothing is faster than what falls for so many steps, there are more: what comes to rest should.
constexpr double kNearlyRests = 1.0;
constexpr int kTurnsAtRest = 60;
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
/// What is apart is looked at after so many turns.
constexpr int kLookRound = 4;
/// What will press if it closes faster by this part of what contacts have made of velocities is taken in.
constexpr double kIdle = 0.01;

/// W = 1/m - [r]x I^-1 [r]x: change of a point's velocity by an impulse there (Eq. 12 of the paper) [1/kg].
Matrix3 response_of(double inverse_mass, const Matrix3& inverse_inertia, const Vector3& arm) {
  const Matrix3 cross = cross_matrix(arm);
  return inverse_mass * Matrix3::Identity() - cross * inverse_inertia * cross;
}

/// The larger eigenvalue of W across n. Friction is relaxed by this one number for both directions: by less
/// of a mobility than there is it would overshoot, and to and fro between contacts it would not end.
///
///     T'WT = ( tt ts )      lambda = (tt + ss) / 2 + sqrt((tt - ss)^2 / 4 + ts^2)
///            ( ts ss )
///
/// A grip's spring has no n: there the trace bounds all three eigenvalues.
double most_across(const Matrix3& response, const Vector3& n) {
  if (n.isZero(0.0)) return response.trace();
  const Vector3 t = n.unitOrthogonal(), s = n.cross(t);
  const Vector3 by_s = response * s;
  const double tt = t.dot(response * t), ss = s.dot(by_s), ts = t.dot(by_s);
  return 0.5 * (tt + ss) + std::sqrt(0.25 * (tt - ss) * (tt - ss) + ts * ts);
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
  contacts_.clear();
  points_.clear();
  linked_.clear();
  apart_.clear();
  add_hands(step, island);
  add_grips(step, island);
  add_links(step, island, carried);
}

void CrowdProblem::add_body(const mrhi::Body& body, const BodyState& state, const ContactStep& step) {
  const Matrix3 inverse_inertia = world_inverse_inertia(body, state.pose.orientation);
  free_.push_back(
      {state.linear_momentum / body.mass + step_ * step.gravity, inverse_inertia * state.angular_momentum});
  bodies_.push_back({free_.back(), 1.0 / body.mass, inverse_inertia});
  longest_arm_ = std::max(longest_arm_, kRoom * body.bounding_radius);
}

template <typename Touch>
SpringContact<double>& CrowdProblem::add_spring(const ContactStep& step, const Touch& touch) {
  contacts_.emplace_back();
  make_spring(step, *configuration_, touch, contacts_.back());
  return contacts_.back();
}

void CrowdProblem::add_hands(const ContactStep& step, const Island& island) {
  const int still = static_cast<int>(free_.size());
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (step.contacts[i].ignored) continue;
      add_point(add_spring(step, step.contacts[i]), still, number_[body.body], Vector3::Zero());
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
      }
    }
  }
}

void CrowdProblem::add_links(const ContactStep& step, const Island& island,
                             const std::vector<Vector3>& carried) {
  for (const Link& link : island.links) {
    const Vector3& borne = carried[link.index];
    if (borne == Vector3::Zero()) {
      apart_.push_back(link.index);
      continue;
    }
    add_link(step, link.index);
    carry(borne, points_.back());
  }
  seen_.clear();
  least_missing_ = 0.0;
  // What rests has its velocities already, by what its contacts bore: beside it nothing is about to press.
  const double fall = step_ * step.gravity.norm();
  admit(step, nearly_rests(step) ? kIdle * fall : fall);
}

void CrowdProblem::add_link(const ContactStep& step, std::size_t index) {
  const BodyContact& touch = step.body_contacts[index];
  const int a = step.scene.bodies[touch.key.a].fixed ? static_cast<int>(free_.size()) : number_[touch.key.a];
  add_point(add_spring(step, touch), a, number_[touch.key.b], touch.arm_a);
  linked_.push_back(index);
}

/// How much faster the surfaces would have to close to press on each other [m/s].
///
///     missing = n.(c_a' - c_b') - d / e,      e the time that the spring looks ahead
///
/// as d+ = d - e n.u > 0 is what presses. e is not the same on both sides of d = 0 (look_ahead in
/// spring_contact.cpp).
double CrowdProblem::missing_speed(const BodyContact& touch) const {
  const Motion& b = bodies_[static_cast<std::size_t>(number_[touch.key.b])].motion;
  const int number = number_[touch.key.a];
  const Motion& a = (number < 0 ? bodies_.back() : bodies_[static_cast<std::size_t>(number)]).motion;
  const Vector3 velocity = a.velocity + a.spin.cross(touch.arm_a) - b.velocity - b.spin.cross(touch.arm_b);
  const double ahead = touch.depth > 0.0 ? look_ahead(step_, configuration_->damping) : step_;
  return touch.normal.dot(velocity) - touch.depth / ahead;
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

/// Takes in what was apart and will now press, or would if it closed faster by `slow`; true if there is any.
/// What is taken in is not left out again in this step: it may come to bear nothing, which costs little.
bool CrowdProblem::admit(const ContactStep& step, double slow) {
  if (apart_.empty() || faster_since() + slow < least_missing_) return false;
  seen_.clear();
  for (const Body& body : bodies_) seen_.push_back(body.motion);
  least_missing_ = kNever;
  const std::size_t before = points_.size();
  const auto kept = std::remove_if(apart_.begin(), apart_.end(), [&](std::size_t index) {
    const double missing = missing_speed(step.body_contacts[index]);
    const bool presses = missing < slow;
    if (presses) add_link(step, index);
    if (!presses) least_missing_ = std::min(least_missing_, missing);
    return presses;
  });
  apart_.erase(kept, apart_.end());
  given_before_.resize(points_.size());
  given_along_.resize(points_.size(), {0.0, Vector3::Zero(), 0.0});
  return points_.size() > before;
}

CrowdProblem::Point& CrowdProblem::add_point(const SpringContact<double>& contact, int a, int b,
                                             const Vector3& arm_a) {
  const Spring<double>& spring = contact.spring;
  points_.emplace_back();
  Point& point = points_.back();  // with impulses in place of forces: stiffness is times the step
  point.a = a, point.b = b;
  point.normal = vector(spring.normal);
  point.arm_a = arm_a, point.arm_b = vector(contact.arm);
  point.drive = vector(contact.drive);
  point.stretch = vector(spring.stretch);
  point.depth = spring.depth, point.ahead = spring.ahead, point.fade = spring.fade;
  point.stiffness = step_ * spring.stiffness;
  point.friction = spring.friction;
  point.bond = step_ * spring.bond;
  point.soft = spring.pad > 0.0 || spring.yields < kNeverYields;
  point.twists = spring.twist_stiffness > 0.0;
  point.given = {0.0, Vector3::Zero(), 0.0};
  weigh(point);
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
void CrowdProblem::weigh(Point& point) const {
  const Body &a = bodies_[static_cast<std::size_t>(point.a)], &b = bodies_[static_cast<std::size_t>(point.b)];
  const Matrix3 response = response_of(a.inverse_mass, a.inverse_inertia, point.arm_a) +
                           response_of(b.inverse_mass, b.inverse_inertia, point.arm_b);
  const Vector3 by_push = response * point.normal;
  point.normal_mobility = point.normal.dot(by_push);
  // W n has a part across n where the arm is not along it: a push makes the surfaces slide as well.
  point.slides = by_push - point.normal_mobility * point.normal;
  point.tangential_mobility = most_across(response, point.normal);
  point.firm = point.stiffness / (1.0 + point.stiffness * point.ahead * point.normal_mobility);
  const double give = 1.0 / (1.0 + point.stiffness * point.ahead * point.tangential_mobility);
  point.kept = 1.0 - give;
  point.pull = give * point.stiffness * point.ahead;
  point.pulled = (give * point.stiffness) * point.stretch;
  point.turn_a = a.inverse_inertia * cross_matrix(point.arm_a);
  point.turn_b = b.inverse_inertia * cross_matrix(point.arm_b);
}

// The last step's force, by this step's normal, as the first guess: f = t - p n, so p = -n.f. One that
// would pull by now is cut off. What is at rest is solved by it to begin with.
void CrowdProblem::carry(const Vector3& borne, Point& point) {
  const double along = borne.dot(point.normal);
  point.given = {step_ * std::max(0.0, -along), step_ * (borne - along * point.normal), 0.0};
  push(point, point.given.drag - point.given.push * point.normal);
}

[[gnu::always_inline]] inline Vector3 CrowdProblem::relative_velocity(const Point& point) const {
  const Motion& a = bodies_[static_cast<std::size_t>(point.a)].motion;
  const Motion& b = bodies_[static_cast<std::size_t>(point.b)].motion;
  return point.drive + a.velocity + a.spin.cross(point.arm_a) - b.velocity - b.spin.cross(point.arm_b);
}

//     v_b += J / m_b,  w_b += I_b^-1 (b x J),      v_a and w_a by -J
//
// The turns' matrices I^-1 [r]x are made once for all turns.
[[gnu::always_inline]] inline void CrowdProblem::push(const Point& point, const Vector3& impulse) {
  Body &a = bodies_[static_cast<std::size_t>(point.a)], &b = bodies_[static_cast<std::size_t>(point.b)];
  a.motion.velocity -= a.inverse_mass * impulse;
  a.motion.spin -= point.turn_a * impulse;
  b.motion.velocity += b.inverse_mass * impulse;
  b.motion.spin += point.turn_b * impulse;
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
  const Vector3 velocity = relative_velocity(point);
  const double rate = point.normal.dot(velocity);
  const double wanted = find_push(i, rate - point.normal_mobility * point.given.push);
  const double limit = point.friction * wanted + point.bond;
  const bool open = limit == 0.0 && point.given.push == 0.0 && point.given.drag == Vector3::Zero() &&
                    point.given.twist == 0.0;
  if (open && wanted == 0.0) return;
  const double more = wanted - point.given.push;
  Vector3 drag = wanted_drag(point, velocity - rate * point.normal + more * point.slides);
  const double squared = drag.squaredNorm();
  if (squared > limit * limit) drag *= limit / std::sqrt(squared);
  push(point, drag - point.given.drag - more * point.normal);
  point.given.push = wanted;
  point.given.drag = drag;
  if (point.twists) twist(i);
}

// As the drag, about n: T' = T + give (k (theta + e w_n) - T) with give = 1 / (1 + k e n'I^-1 n), clamped
// to 2/3 mu a p. Body a is a hand, which nothing turns.
void CrowdProblem::twist(std::size_t i) {
  Point& point = points_[i];
  const SpringContact<double>& contact = contacts_[i];
  const Spring<double>& spring = contact.spring;
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
  for (std::size_t i = 0; i < points_.size(); ++i) relax(i);
  for (std::size_t i = points_.size(); i-- > 0;) relax(i);
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
    const bool more = (done || i % kLookRound == 0) && admit(step, kIdle * made);
    if (done && !more) break;
  }
}

/// What the springs' settling looks at.
/// Impulses over the step are forces. `wanted` is that of wanted_drag(): at the fixed point k q+ where a
/// contact sticks, and as k q+ beyond the limit where it slips, as t' - t = give (k q+ - t).
void CrowdProblem::report(std::size_t i) {
  const Point& point = points_[i];
  const Vector3 velocity = relative_velocity(point);
  const Vector3 sliding = velocity - point.normal.dot(velocity) * point.normal;
  SpringContact<double>& contact = contacts_[i];
  contact.response = {};
  contact.response.force = triple((point.given.drag - point.given.push * point.normal) / step_);
  contact.response.push = point.given.push / step_;
  contact.response.torque = point.given.twist / step_;
  contact.response.wanted_squared = wanted_drag(point, sliding).squaredNorm() / (step_ * step_);
  contact.response.drawn = triple(point.stretch + point.ahead * sliding);
  contact.spring.slip_limit = (point.friction * point.given.push + point.bond) / step_;
}

//     p += h m g + sum +-J,     L += sum +-(r x J + T n)
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
    const auto give = [&](int body, double sign, const Vector3& arm) {
      BodyState& state = step.bodies[island.bodies.begin()[body].body];
      state.linear_momentum += sign * impulse;
      state.angular_momentum += sign * (arm.cross(impulse) + point.given.twist * point.normal);
    };
    give(point.b, 1.0, point.arm_b);
    if (point.a != static_cast<int>(free_.size())) give(point.a, -1.0, point.arm_a);
    report(i);
  }
  auto contact = settle_hands(step, island, contacts_.begin());
  for (const std::size_t index : linked_) settle(step, *contact++, step.body_contacts[index]);
  for (const std::size_t index : apart_) step.body_contacts[index].friction = Friction::sticking;
}

}  // namespace mrhi
