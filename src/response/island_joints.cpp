// The contact problem of an island with joints. Joints are solved in their own coordinates, without
// multipliers. So no constraint drifts or needs stabilisation (Baumgarte 1972), and M = J' M_b J is positive
// definite, with M_b the bodies' masses and J their Jacobian. J and M are those at the start of the step; the
// flight accounts for the rotation of axes in the step (LinkageFlight).
#include <algorithm>
#include <cmath>

#include "island_problem.h"
#include "penetration_model.h"

namespace mrhi {
namespace {

/// Fraction of the island's momentum, added to the scale of errors: smaller errors are rounding.
constexpr double kMomentumTolerance = 1e-6;
/// Largest error, over scale(), at which momenta are taken from the forces.
constexpr double kConsistencyTolerance = 1e-4;
/// Largest error, over scale(), at which the forces are a warm start of the next step.
constexpr double kMaxWarmStartError = 0.01;
/// Largest number of bodies that are solved without a bound on effort.
constexpr std::size_t kMaxUnboundedBodies = 4;

/// Number of unknowns from which sparse factors are cheaper.
constexpr Eigen::Index kSparseUnknowns = 100;

constexpr int kNoJoint = LinkageBody::kNone;

}  // namespace

void Factors::compute(const Eigen::MatrixXd& matrix) {
  sparse_ = matrix.rows() >= kSparseUnknowns;
  if (sparse_) {
    ordered_.compute(matrix.sparseView());
  } else {
    dense_.compute(matrix);
  }
}

void Factors::solve_in_place(Eigen::VectorXd& right_hand_side) const {
  if (sparse_) {
    right_hand_side = ordered_.solve(right_hand_side).eval();
  } else {
    dense_.solveInPlace(right_hand_side);
  }
}

// u0 = M^-1 sum J_b' p_b projects the bodies' momenta onto the joints. The remainder is the joints' reaction,
// not an error of this step. u* = u0 + h M^-1 J' m g.
void IslandProblem::begin(const ContactStep& step, const Island& island, const std::vector<Linkage>& linkages,
                          std::vector<LinkageMotion>& motions, const std::vector<JointState>& joints,
                          double regular_step) {
  begin(island.bodies.size(), true);
  step_ = step.step;
  regular_step_ = regular_step;
  scene_ = &step.scene;
  island_ = &island;
  acts_ = is_touched(step, island);
  effort_ = effort_in_joints();
  make_rows(step, island);
  number_unknowns(step, island, linkages, motions);
  mass_factors_.compute(mass_);
  start_momentum_ = std::sqrt(gradient_.squaredNorm());
  start_ = gradient_;
  solve_mass(start_);
  solve_mass(fall_);
  start_with(start_, step, joints);
}

/// Limits of the iteration. Those of many bodies are lower, and their error is bounded by visibility.
IslandProblem::Effort IslandProblem::effort_in_joints() const {
  Effort effort;
  effort.limits = 2;
  effort.held_iterations = 20;
  if (wrenches_.size() <= kMaxUnboundedBodies) return effort;
  effort.iterations = 12;
  effort.limits = 1;
  effort.held_iterations = 10;
  effort.full_steps = 0;
  effort.trials = 10;
  effort.converged = 1e-6;
  effort.restarts = false;
  return effort;
}

void IslandProblem::number_unknowns(const ContactStep& step, const Island& island,
                                    const std::vector<Linkage>& linkages,
                                    std::vector<LinkageMotion>& motions) {
  const auto has = [&](const Linkage& linkage) { return island.contains(linkage.bodies.front().body); };
  int count = 0;
  for (const Linkage& linkage : linkages) count += has(linkage) ? linkage.unknowns() : 0;
  for (const IslandBody& body : island.bodies) count += step.scene.bodies[body.body].flies ? 6 : 0;
  const auto rows = static_cast<Eigen::Index>(6 * island.bodies.size());
  jacobian_.setZero(rows, count);
  for (Vector* vector : {&body_velocity_, &body_impulse_}) vector->resize(rows);
  mass_.setZero(count, count);
  for (Vector* vector : {&gradient_, &fall_, &weights_}) vector->setZero(count);
  for (Vector* vector : {&direction_, &change_, &momentum_}) vector->resize(count);
  unknowns_.clear();
  parts_.clear();
  columns_.resize(island.bodies.size());
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < linkages.size(); ++i) {
    if (!has(linkages[i])) continue;
    add_linkage(step, island, linkages[i], motions[i], first);
    first += linkages[i].unknowns();
  }
  for (const IslandBody& body : island.bodies) {
    if (!step.scene.bodies[body.body].flies) continue;
    add_body_without_joint(step, island, body.body, first);
    first += 6;
  }
}

/// Adds a linkage's unknowns. The gradient collects the momenta at the start of the step, the fall those of
/// gravity.
///
/// A joint's weight converts its torque to a force by k^2 = M_ii / m of its child body. For a prismatic joint
/// this has no unit: the moved mass over the child's.
void IslandProblem::add_linkage(const ContactStep& step, const Island& island, const Linkage& linkage,
                                LinkageMotion& motion, Eigen::Index first) {
  const Eigen::Index count = linkage.unknowns();
  mass_.block(first, first, count, count) = motion.mass();
  parts_.push_back({{first, count}, &motion, &linkage, 0});
  std::vector<LinkageMotion::Impulse>& impulses = motion.impulses();
  for (int i = 0; i < motion.size(); ++i) {
    const BodyState& state = step.bodies[linkage.bodies[i].body];
    impulses[i] = {state.linear_momentum, state.angular_momentum};
  }
  motion.push(gradient_.segment(first, count));
  for (int i = 0; i < motion.size(); ++i)
    impulses[i] = {(step_ * motion.body(i).mass) * step.gravity, Vector3::Zero()};
  motion.push(fall_.segment(first, count));
  for (int i = 0; i < motion.size(); ++i) {
    const LinkageBody& link = linkage.bodies[i];
    const Body& body = motion.body(i);
    const auto index = static_cast<std::size_t>(link.body);
    columns_[island.number_of(index)] = {first, count};
    motion.add_jacobian(i, jacobian_.block(6 * island.number_of(index), first, 6, count));
    if (link.joint == LinkageBody::kNone) {
      weights_.segment<3>(first).setOnes();
      weights_.segment<3>(first + 3).setConstant(3.0 * body.mass / body.inertia.trace());
      unknowns_.push_back({kNoJoint, link.body, first});
    } else {
      const Eigen::Index column = first + linkage.column(i);
      weights_[column] = body.mass / mass_(column, column);
      unknowns_.push_back({link.joint, link.body, column});
    }
  }
}

void IslandProblem::add_body_without_joint(const ContactStep& step, const Island& island, std::size_t index,
                                           Eigen::Index first) {
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  const int number = island.number_of(index);
  columns_[number] = {first, 6};
  parts_.push_back({{first, 6}, nullptr, nullptr, number});
  jacobian_.block<6, 6>(6 * number, first).setIdentity();
  mass_.block<3, 3>(first, first).diagonal().setConstant(body.mass);
  mass_.block<3, 3>(first + 3, first + 3) = rotation * body.inertia * rotation.transpose();
  gradient_.segment<6>(first) << state.linear_momentum, state.angular_momentum;
  fall_.segment<3>(first) = (step_ * body.mass) * step.gravity;
  weights_.segment<3>(first).setOnes();
  weights_.segment<3>(first + 3).setConstant(3.0 * body.mass / body.inertia.trace());
  unknowns_.push_back({kNoJoint, static_cast<int>(index), first});
}

void IslandProblem::start_with(const Vector& velocity, const ContactStep& step,
                               const std::vector<JointState>& joints) {
  start_ = velocity;  // `velocity` may be start_ itself
  free_ = start_ + fall_;
  velocity_ = free_;
  laws_.resize(velocity.size());
  for (const Unknown& unknown : unknowns_) {
    const Eigen::Index row = unknown.row;
    if (unknown.joint == kNoJoint) {
      const Twist& pushed = step.bodies[unknown.body].pushed;
      velocity_.segment<3>(row) += step_ * pushed.linear;
      velocity_.segment<3>(row + 3) += step_ * pushed.angular;
      continue;
    }
    laws_[row].begin(scene_->joints[unknown.joint], joints[unknown.joint], mass_(row, row), step_,
                     regular_step_);
    acts_ = acts_ || laws_[row].acts(std::max(std::abs(start_[row]), std::abs(free_[row])));
    velocity_[row] += step_ * joints[unknown.joint].pushed;
  }
}

/// Projects the bodies' impulses onto the joints, and adds the joints' own forces t(u).
///
///     g = M (u - u*) - h J' f(J u) - h t(u)
///
/// scale: contact and joint forces, plus a little of the momentum, so that a relative error exists where no
/// force acts.
void IslandProblem::add_joint_forces() {
  for (const Part& part : parts_) {
    auto momenta = gradient_.segment(part.columns.first, part.columns.count);
    if (part.motion == nullptr) {
      momenta += body_impulse_.segment<6>(6 * part.number);
      continue;
    }
    for (int i = 0; i < part.motion->size(); ++i) {
      const int row = 6 * island_->number_of(part.linkage->bodies[i].body);
      part.motion->impulses()[i] = {body_impulse_.segment<3>(row), body_impulse_.segment<3>(row + 3)};
    }
    part.motion->push(momenta);
  }
  scale_ += kMomentumTolerance * start_momentum_;
  for (const auto& [joint, body, row] : unknowns_) {
    if (joint == kNoJoint) continue;
    gradient_[row] -= step_ * laws_[row].force(velocity_[row]);
    scale_ += step_ * laws_[row].size(velocity_[row]) * std::sqrt(weights_[row]);
  }
}

/// V = J u, from parent to child.
void IslandProblem::find_body_velocities() {
  for (const Part& part : parts_) {
    const auto velocity = velocity_.segment(part.columns.first, part.columns.count);
    if (part.motion == nullptr) {
      body_velocity_.segment<6>(6 * part.number) = velocity;
      continue;
    }
    part.motion->move(velocity);
    for (int i = 0; i < part.motion->size(); ++i)
      body_velocity_.segment<6>(6 * island_->number_of(part.linkage->bodies[i].body))
          << part.motion->at(i).linear,
          part.motion->at(i).angular;
  }
}

/// Potential of the joints' own forces: h sum e_i(u_i), de_i/du = -t_i. It is convex, as each joint's force
/// falls while its velocity grows.
double IslandProblem::joint_energy() const {
  double sum = 0.0;
  for (const auto& [joint, body, row] : unknowns_)
    if (joint != kNoJoint) sum += step_ * laws_[row].energy(velocity_[row]);
  return sum;
}

/// c' = v + w x r = (J_v - [r]x J_w) u
void IslandProblem::add_point_jacobian(int number, const Vector3& arm, double sign,
                                       Eigen::Ref<PointJacobian> own) const {
  const Columns& of = columns_of(number);
  const auto linear = jacobian_.block(6 * number, of.first, 3, of.count),
             angular = jacobian_.block(6 * number + 3, of.first, 3, of.count);
  own += sign * linear - (sign * cross_matrix(arm)).lazyProduct(angular);
}

/// Of a body's contacts with fixtures and hands, whose slopes are summed: J' (sum J_c' S J_c) J. Unknowns
/// come from the root to the tips, so that those beyond the body's own do not move it.
void IslandProblem::add_body_slope(int number) {
  const Lower6& sum = body_slopes_[static_cast<std::size_t>(number)];
  if (sum[Cholesky6::at(0, 0)] + sum[Cholesky6::at(1, 1)] + sum[Cholesky6::at(2, 2)] <= 0.0) return;
  Eigen::Matrix<double, 6, 6> slope;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) slope(i, j) = slope(j, i) = step_ * sum[Cholesky6::at(i, j)];
  const Columns& of = columns_of(number);
  const auto jacobian = jacobian_.middleRows<6>(6 * number).middleCols(of.first, of.count);
  Eigen::Index moving = of.count;
  while (moving > 0 && jacobian.col(moving - 1).isZero(0.0)) --moving;
  for (Eigen::Index j = 0; j < moving; ++j) {
    const Eigen::Matrix<double, 6, 1> product = slope * jacobian.col(j);
    for (Eigen::Index i = j; i < moving; ++i)
      hessian_(of.first + i, of.first + j) += jacobian.col(i).dot(product);
  }
}

/// H = M + h sum (J_c' S J_c + s_T j_c' j_c) - h dt/du, with J_c and j_c the Jacobians of a row's relative
/// velocity and spin. -dt/du is diagonal and not negative. Only the lower triangle is computed.
void IslandProblem::factorise_joints() {
  hessian_ = mass_;
  body_slopes_.assign(wrenches_.size(), Lower6{});
  for (const SpringContact& row : rows_) {
    const SpringResponse& response = row.response;
    if (response.normal_slope <= 0.0 && response.tangential_slope <= 0.0) continue;
    if (row.a == SpringContact::kNone) {
      add_slope(row, point_slope(row), row.arm, body_slopes_[row.b]);
      continue;
    }
    const Vector3 n = vector(row.spring.normal), tilt = vector(row.tilt);
    // Of the unknowns only those of the two bodies, or of their linkages, move the point.
    const Columns b = columns_of(row.b), a = columns_of(row.a);
    const Columns &low = a.first < b.first ? a : b, &high = a.first < b.first ? b : a;
    const Eigen::Index count = low.count + (low.first == high.first ? 0 : high.count);
    point_jacobian_.setZero(3, count);
    spin_jacobian_.setZero(count);
    const auto add = [&](int number, const Columns& columns, const Triple& arm, double sign) {
      const Eigen::Index at = columns.first == low.first ? 0 : low.count;
      const auto angular = jacobian_.block(6 * number + 3, columns.first, 3, columns.count);
      auto of_point = point_jacobian_.middleCols(at, columns.count);
      add_point_jacobian(number, vector(arm), sign, of_point);
      if (row.tilts) of_point += (sign * n * tilt.transpose()).lazyProduct(angular);
      spin_jacobian_.segment(at, columns.count) += (sign * n.transpose()).lazyProduct(angular);
    };
    add(row.b, b, row.arm, 1.0);
    add(row.a, a, row.arm_a, -1.0);
    const Matrix3 slope = step_ * point_slope(row).matrix();
    point_product_ = slope.lazyProduct(point_jacobian_);
    const auto entry = [&](Eigen::Index i) {
      return i < low.count ? low.first + i : high.first + (i - low.count);
    };
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index i = j; i < count; ++i)
        hessian_(entry(i), entry(j)) += point_jacobian_.col(i).dot(point_product_.col(j)) +
                                        step_ * response.torque_slope * spin_jacobian_[i] * spin_jacobian_[j];
  }
  for (std::size_t body = 0; body < body_slopes_.size(); ++body) add_body_slope(static_cast<int>(body));
  for (const auto& [joint, body, row] : unknowns_)
    if (joint != kNoJoint) hessian_(row, row) += step_ * laws_[row].slope(velocity_[row]);
  factors_.compute(hessian_);
}

/// Contacts dissipate energy, and return at most that of their release speed; hands add that of their own
/// speed. The joints' springs keep their forces: their energy is small by comparison, as Newton's method
/// fails only where a linkage moves violently.
void IslandProblem::keep_to_energy(const ContactStep& step, const Island& island) {
  double fastest = kReleaseSpeed, mass = 0.0;
  for (const IslandBody& body : island.bodies) {
    mass += step.scene.bodies[body.body].mass;
    for (std::size_t i = body.first; i < body.last; ++i)
      fastest = std::max(fastest, step.contacts[i].hand_velocity.norm());
  }
  const double allowed =
      std::max(kinetic_energy(start_), kinetic_energy(free_)) + 0.5 * mass * fastest * fastest;
  const double found = kinetic_energy(velocity_);
  if (found <= allowed) return;
  velocity_ = std::isfinite(found) ? Vector(std::sqrt(allowed / found) * velocity_) : start_;
  evaluate(true);
}

// Bodies get M_b J u. Joints react to the remainder of the contacts' impulses, which does not enter the
// momenta. So J' of the bodies' momenta is M u, from which the flight continues.
void IslandProblem::finish(bool agree, ContactStep& step, const Island& island,
                           std::vector<JointState>& joints) {
  settle_rows(step, island);
  // Forces are the warm start of the next step, unless their error is large.
  const bool lasts = agree || error_below(kMaxWarmStartError);
  for (const Unknown& unknown : unknowns_) {
    const Eigen::Index row = unknown.row;
    if (unknown.joint == kNoJoint) {
      Twist& pushed = step.bodies[unknown.body].pushed;
      pushed = Twist();
      if (!lasts) continue;
      pushed.linear = (velocity_.segment<3>(row) - free_.segment<3>(row)) / step_;
      pushed.angular = (velocity_.segment<3>(row + 3) - free_.segment<3>(row + 3)) / step_;
      continue;
    }
    JointState& joint = joints[unknown.joint];
    joint.pushed = lasts ? (velocity_[row] - free_[row]) / step_ : 0.0;
    laws_[row].settle(velocity_[row], joint);
  }
  // u minus M^-1 times the residual: momenta then agree with the reported forces.
  if (agree || error_below(kConsistencyTolerance)) {
    direction_ = gradient_;
    solve_mass(direction_);
    velocity_ -= direction_;
  }
  find_body_velocities();
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const std::size_t index = island.bodies.begin()[i].body;
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Body& body = step.scene.bodies[index];
    BodyState& state = step.bodies[index];
    const Quaternion& q = state.pose.orientation;
    state.linear_momentum = body.mass * body_velocity_.segment<3>(row);
    state.angular_momentum =
        q * (body.inertia * (q.conjugate() * Vector3(body_velocity_.segment<3>(row + 3))));
    if (body.flies) step.changes.mark_solved(static_cast<int>(index));
  }
}

}  // namespace mrhi
