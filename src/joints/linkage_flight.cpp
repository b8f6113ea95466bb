#include "linkage.h"

#include <algorithm>
#include <cmath>

#include "../math/rotation.h"

namespace mrhi {
namespace {

/// Largest rotation of a joint, or fall, in one part of a step [rad]. The error of a part goes with its fifth
/// power (fourth order).
constexpr double kMaxPartAngle = 0.03;
constexpr double kMaxFlightParts = 1000.0;
/// Budget of a step, about 1 ms: evaluations of the motion of a linkage of n bodies, times n^2; and the usual
/// number of evaluations of a part.
constexpr double kMaxWork = 60'000.0, kTypicalPartWork = 24.0;
constexpr int kMinIterations = 4;
/// Largest energy gain of a step by its error, over the kinetic energy at its end.
constexpr double kMaxGain = 0.01;
/// Length of the pendulum that bounds the rate of a fall from rest, w = sqrt(g / l) [m]. By its present rate
/// alone, a linkage released from rest would take one part.
constexpr double kFallLength = 0.1;
constexpr int kMaxIterations = 60;
/// Relative change of the stages at which the iteration has converged.
constexpr double kConverged = 1e-16;

const BodyState& of(const Linkage& linkage, int i, const std::vector<BodyState>& bodies) {
  return bodies[linkage.bodies[i].body];
}

/// Rate of a rotation vector from the angular velocity in the fixed frame (Iserles et al., Lie-group methods,
/// Acta Numerica 2000, B.10).
///
///     theta' = w - 1/2 theta x w + (1/12 + |theta|^2 / 720) theta x (theta x w) + ...
///
/// This is the series of dexp^-1 with Bernoulli's numbers; four times theta x equals -|theta|^2 times two of
/// them. The remainder is of sixth order in theta, and a part rotates by about kMaxPartAngle at most.
Vector3 turn_rate(const Vector3& turn, const Vector3& spin) {
  const Vector3 once = turn.cross(spin);
  return spin - 0.5 * once + (1.0 / 12.0 + turn.squaredNorm() / 720.0) * turn.cross(once);
}

}  // namespace

LinkageFlight::LinkageFlight(const Scene& scene, const Linkage& linkage)
    : linkage_(linkage), motion_(scene, linkage), velocity_(linkage.unknowns()) {
  const auto count = static_cast<Eigen::Index>(linkage.joints());
  for (Point* point : {&now_, &next_, &guess_, &start_, &stages_[0].point, &stages_[0].rate,
                       &stages_[1].point, &stages_[1].rate})
    *point = {Vector::Zero(count), Vector::Zero(count), Vector3::Zero()};
}

void LinkageFlight::read(const std::vector<JointState>& joints, const std::vector<BodyState>& bodies) {
  int joint = 0;
  for (const LinkageBody& link : linkage_.bodies) {
    if (link.joint != LinkageBody::kNone) now_.positions[joint++] = joints[link.joint].position;
  }
  now_.turn.setZero();
  root_ = bodies[linkage_.bodies.front().body].pose.orientation;
}

/// Computes the unknowns' velocities; those of a floating linkage in the frame of its centre of mass.
///
///     M(q) u = p,      p = (0, L, p_joints) of one that floats
///
/// In that frame the momentum is 0 and L about the centre is constant, so neither is integrated and neither
/// can drift. The root's row of M is about its own centre: without momentum the angular momentum is the same
/// about any point.
void LinkageFlight::find_velocity(const Point& point) {
  motion_.place({Vector3::Zero(), rotation_by(point.turn) * root_}, point.positions);
  motion_.weigh();
  velocity_.tail(point.momenta.size()) = point.momenta;
  if (linkage_.floats()) velocity_.head<6>() << Vector3::Zero(), angular_momentum_;
  motion_.solve(velocity_);
  motion_.move(velocity_);
}

/// Hamilton's equations: q' = M(q)^-1 p, p' = -dH/dq, H = p' M^-1 p / 2 - sum m g.c. Momenta are integrated
/// instead of velocities. Inertial forces are then in M(q) and in the motion of axes (find_rates), and no
/// derivative of M is needed.
void LinkageFlight::find_rate(const Point& point, const Vector3& gravity, Point& rate) {
  find_velocity(point);
  motion_.find_rates(gravity, rate.momenta);
  rate.positions = velocity_.tail(point.momenta.size());
  if (linkage_.floats()) rate.turn = turn_rate(point.turn, velocity_.segment<3>(3));
}

/// Largest angular speed of the bodies: the rate at which axes and arms rotate.
double LinkageFlight::fastest() const {
  double rate = 0.0;
  for (int i = 0; i < motion_.size(); ++i) rate = std::max(rate, motion_.at(i).angular.norm());
  return rate;
}

void LinkageFlight::add_rates(const Point& from, double a, const Point& first, double b, const Point& second,
                              Point& to) {
  to.positions = from.positions + (a * first.positions + b * second.positions);
  to.momenta = from.momenta + (a * first.momenta + b * second.momenta);
  to.turn = from.turn + (a * first.turn + b * second.turn);
}

/// Largest relative difference.
double LinkageFlight::distance(const Point& a, const Point& b) {
  const auto of = [](const auto& x, const auto& y) {
    return (x - y).template lpNorm<Eigen::Infinity>() / (x.template lpNorm<Eigen::Infinity>() + 1e-300);
  };
  return std::max({of(a.positions, b.positions), of(a.momenta, b.momenta), of(a.turn, b.turn)});
}

/// Gauss's method of two stages, fourth order and symplectic (Hairer, Lubich & Wanner, Geometric Numerical
/// Integration, 2006, II.1.3). Stages are at the fractions 1/2 -+ sqrt(3)/6, by fixed-point iteration. It has
/// no energy drift, and conserves the momenta that the motion conserves.
///
///     Y_1 = y + h (1/4 f_1 + (1/4 - s) f_2),     Y_2 = y + h ((1/4 + s) f_1 + 1/4 f_2),     s = sqrt(3) / 6
///     y' = y + h (f_1 + f_2) / 2,                f_i = f(Y_i)
///
/// The method is symplectic only at the stages' fixed point. So iterations continue to rounding, or until the
/// change no longer decreases. Each reduces the error by about the part's rotation. The root's rotation
/// counts from the start of the part, so it stays small, and updates the quaternion at the end.
void LinkageFlight::advance(const Vector3& gravity, double seconds, int rounds) {
  static const double kThird = std::sqrt(3.0) / 6.0;
  Stage &one = stages_[0], &two = stages_[1];
  two.rate = one.rate;  // at the start of the part
  double last = 1.0;
  for (int round = 0; round < rounds; ++round) {
    guess_ = two.point;
    add_rates(now_, 0.25 * seconds, one.rate, (0.25 - kThird) * seconds, two.rate, one.point);
    add_rates(now_, (0.25 + kThird) * seconds, one.rate, 0.25 * seconds, two.rate, two.point);
    const double change = round == 0 ? 1.0 : distance(guess_, two.point);
    if (change <= kConverged || (round > 8 && change >= last)) break;
    last = change;
    find_rate(one.point, gravity, one.rate);
    find_rate(two.point, gravity, two.rate);
  }
  add_rates(now_, 0.5 * seconds, one.rate, 0.5 * seconds, two.rate, next_);
  root_ = (rotation_by(next_.turn) * root_).normalized();
  next_.turn.setZero();
  std::swap(now_, next_);
}

/// Always the same sums over the state, so that rounding does not accumulate over the steps.
///
///     C = sum m c / m,     P = sum p,     L = sum (l + (c - C) x (p - m v)),      v = P / m
///
/// Subtracting the drift from p only affects rounding: sum m (c - C) x v = 0.
LinkageFlight::Whole LinkageFlight::whole(const std::vector<BodyState>& bodies) const {
  Whole whole{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (int i = 0; i < motion_.size(); ++i) {
    const BodyState& state = of(linkage_, i, bodies);
    whole.centre += motion_.body(i).mass * state.pose.position;
    whole.linear += state.linear_momentum;
  }
  whole.centre /= motion_.total_mass();
  const Vector3 drift = whole.linear / motion_.total_mass();
  for (int i = 0; i < motion_.size(); ++i) {
    const BodyState& state = of(linkage_, i, bodies);
    const Vector3 own = state.linear_momentum - motion_.body(i).mass * drift;
    whole.angular += state.angular_momentum + (state.pose.position - whole.centre).cross(own);
  }
  return whole;
}

/// Computes the joints' momenta in a frame with the velocity `drift`: p_joints = J' (p - m drift, l), by the
/// poses at the start of the step.
void LinkageFlight::gather(const Vector3& drift, const std::vector<BodyState>& bodies) {
  motion_.place(of(linkage_, 0, bodies).pose, now_.positions);
  velocity_.setZero();
  for (int i = 0; i < motion_.size(); ++i) {
    const BodyState& state = of(linkage_, i, bodies);
    motion_.impulses()[i] = {state.linear_momentum - motion_.body(i).mass * drift, state.angular_momentum};
  }
  motion_.push(velocity_);
  now_.momenta = velocity_.tail(now_.momenta.size());
}

/// Energy of the joints and the rotation, after find_velocity() at the point [J].
///
///     H = p.u / 2 - sum m g.c,      p.u with L.w of one that floats
double LinkageFlight::energy(const Point& point, const Vector3& gravity) const {
  double twice = point.momenta.dot(velocity_.tail(point.momenta.size()));
  if (linkage_.floats()) twice += angular_momentum_.dot(velocity_.segment<3>(3));
  return 0.5 * twice - motion_.total_mass() * gravity.dot(motion_.centre_of_mass());
}

/// Writes the joints' momenta with all joints locked, at the same angular momentum, to next_. Returns the
/// kinetic energy, the least of any motion here [J].
double LinkageFlight::lock_joints() {
  next_.momenta.setZero(now_.momenta.size());
  if (!linkage_.floats()) return 0.0;
  Eigen::Matrix<double, 6, 1> twist;
  twist << Vector3::Zero(), angular_momentum_;
  twist = motion_.mass().topLeftCorner<6, 6>().ldlt().solve(twist);
  next_.momenta = motion_.mass().bottomLeftCorner(now_.momenta.size(), 6) * twist;
  return 0.5 * angular_momentum_.dot(twist.tail<3>());
}

/// Call after find_velocity(now_). A rotation too fast for its budget of parts may gain energy, or have no
/// finite result. Joints are then slowed until no energy is gained.
///
///     T(s) = T_locked + s^2 (T - T_locked)      of momenta p_locked + s (p - p_locked)
///
/// with p_locked the momenta of locked joints. A result that is not finite, or where even locked joints have
/// more energy than there was, is dropped: joints stop where the step began.
void LinkageFlight::keep_to_energy(const Vector3& gravity, double before) {
  const double weight = motion_.total_mass() * gravity.dot(motion_.centre_of_mass());
  const double after = energy(now_, gravity), moving = after + weight;
  if (after - before <= kMaxGain * moving) return;  // false for NaN too
  const double locked = lock_joints();
  double ratio = (before + weight - locked) / (moving - locked);
  if (!(ratio > 0.0) || !now_.positions.allFinite() || !root_.coeffs().allFinite()) {
    now_ = start_;
    root_ = start_root_;
    find_velocity(now_);
    lock_joints();
    ratio = 0.0;
  }
  now_.momenta = next_.momenta + std::sqrt(ratio) * (now_.momenta - next_.momenta);
  find_velocity(now_);
}

// parts = 1 + h max(w, sqrt(g / l)) / kMaxPartAngle within the budget, with w the fastest of any body at the
// start.
void LinkageFlight::advance_by_parts(const Vector3& gravity, double step) {
  start_ = now_;
  start_root_ = root_;
  find_rate(now_, gravity, stages_[0].rate);
  const double before = energy(now_, gravity);
  const double travel = step * std::max(fastest(), std::sqrt(gravity.norm() / kFallLength));
  const double bodies = motion_.size(), work = kMaxWork / (bodies * bodies);
  const int parts =
      1 + static_cast<int>(std::min({travel / kMaxPartAngle, kMaxFlightParts, work / kTypicalPartWork}));
  const int rounds = std::clamp(static_cast<int>(0.5 * work / parts), kMinIterations, kMaxIterations);
  for (int part = 0; part < parts; ++part) {
    if (part > 0) find_rate(now_, gravity, stages_[0].rate);
    advance(gravity, step / parts, rounds);
  }
  find_velocity(now_);
  keep_to_energy(gravity, before);
}

void LinkageFlight::fly(const Vector3& gravity, double step, std::vector<JointState>& joints,
                        std::vector<BodyState>& bodies) {
  read(joints, bodies);
  if (linkage_.floats()) return fly_free(gravity, step, joints, bodies);
  gather(Vector3::Zero(), bodies);
  advance_by_parts(gravity, step);
  write(Vector3::Zero(), Vector3::Zero(), joints, bodies);
}

/// A floating linkage: its centre falls and its angular momentum about it is constant. Only shape and
/// orientation are integrated, in the frame of the centre of mass. The root takes the rounding errors.
///
///     C(h) = C + h v + h^2 g / 2,     P(h) = P + m h g,      L about C stays
void LinkageFlight::fly_free(const Vector3& gravity, double step, std::vector<JointState>& joints,
                             std::vector<BodyState>& bodies) {
  const Whole start = whole(bodies);
  const Vector3 drift = start.linear / motion_.total_mass();
  angular_momentum_ = start.angular;
  gather(drift, bodies);
  advance_by_parts(Vector3::Zero(), step);
  const Vector3 centre = start.centre + step * drift + (0.5 * step * step) * gravity;
  write(centre - motion_.centre_of_mass(), drift + step * gravity, joints, bodies);
  BodyState& root = bodies[linkage_.bodies.front().body];
  root.linear_momentum += start.linear + (motion_.total_mass() * step) * gravity - whole(bodies).linear;
  root.angular_momentum += start.angular - whole(bodies).angular;
}

void LinkageFlight::write(const Vector3& place, const Vector3& velocity, std::vector<JointState>& joints,
                          std::vector<BodyState>& bodies) {
  int joint = 0;
  for (int i = 0; i < motion_.size(); ++i) {
    const LinkageBody& link = linkage_.bodies[i];
    if (link.joint != LinkageBody::kNone) joints[link.joint].position = now_.positions[joint++];
    const LinkageMotion::Placed& placed = motion_.at(i);
    BodyState& state = bodies[link.body];
    state.pose = {placed.pose.position + place, placed.pose.orientation};
    state.linear_momentum = motion_.body(i).mass * (placed.linear + velocity);
    state.angular_momentum = placed.inertia * placed.angular;
  }
}

}  // namespace mrhi
