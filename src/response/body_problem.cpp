#include "body_problem.h"

namespace mrhi {
namespace {

/// Lower triangle of a sum of weighted outer products w w' of lanes.
class OuterProducts {
 public:
  OuterProducts() {
    for (Lanes& entry : entries_) entry.setZero();
  }
  void add(const Lanes& weight, const std::array<Lanes, 6>& w) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const Lanes weighted = weight * w[i];
      for (std::size_t j = 0; j <= i; ++j) entries_[at++] += weighted * w[j];
    }
  }
  void add_to(Eigen::Matrix<double, 6, 6>& matrix) const {
    std::size_t at = 0;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j <= i; ++j) matrix(i, j) += sum(entries_[at++]);
    }
  }

 private:
  std::array<Lanes, 21> entries_;
};

/// J' f of a force at an arm from the body's centre.
std::array<Lanes, 6> wrench_of(const Triple<Lanes>& force, const Triple<Lanes>& arm) {
  const Triple<Lanes> torque = arm.cross(force);
  return {{force.x, force.y, force.z, torque.x, torque.y, torque.z}};
}

}  // namespace

void BodyProblem::begin(const ContactStep& step, std::size_t index,
                        const std::vector<IslandContact>& contacts) {
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  contacts_ = &contacts;
  step_ = step.step;
  mass_ = body.mass;
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  inertia_ = rotation * body.inertia * rotation.transpose();
  gyration_squared_ = body.inertia.trace() / (3.0 * body.mass);
  start_.head<3>() = state.linear_momentum / body.mass;
  start_.tail<3>() = rotation * (body.inverse_inertia * (rotation.transpose() * state.angular_momentum));
  free_ = start_;
  free_.head<3>() += step.step * step.gravity;

  fours_.resize((contacts.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < kLanes * fours_.size(); ++i) {
    // A lane too many is a copy that has no stiffness.
    const bool real = i < contacts.size();
    const IslandContact& contact = contacts[real ? i : contacts.size() - 1];
    const Spring<double>& from = contact.spring;
    Four& four = fours_[i / kLanes];
    Spring<Lanes>& spring = four.spring;
    const int lane = static_cast<int>(i % kLanes);
    set_lane(lane, vector(from.normal), spring.normal);
    set_lane(lane, vector(from.stretch), spring.stretch);
    spring.depth[lane] = from.depth;
    spring.twist[lane] = from.twist;
    spring.ahead[lane] = from.ahead;
    spring.stiffness[lane] = real ? from.stiffness : 0.0;
    spring.twist_stiffness[lane] = real ? from.twist_stiffness : 0.0;
    spring.friction[lane] = from.friction;
    spring.patch_friction[lane] = from.patch_friction;
    set_lane(lane, contact.arm_b, four.arm);
    set_lane(lane, contact.drive, four.drive);
    four.drive_spin[lane] = contact.drive_spin;
  }
}

void BodyProblem::evaluate(bool renew_limits) {
  const Triple<Lanes> linear = everywhere(velocity_.head<3>()), angular = everywhere(velocity_.tail<3>());
  const Lanes zero = Lanes::Zero();
  Triple<Lanes> force{zero, zero, zero}, torque = force;
  Lanes push = zero;
  for (Four& four : fours_) {
    SpringResponse<Lanes>& response = four.response;
    const Triple<Lanes>& n = four.spring.normal;
    const Triple<Lanes> u = four.drive - linear - angular.cross(four.arm);
    four.spring.respond(u, four.drive_spin - n.dot(angular), renew_limits, response);
    force = force + response.force;
    torque = torque + four.arm.cross(response.force) + response.torque * n;
    push += response.push;
  }
  const Vector6 change = velocity_ - free_;
  gradient_.head<3>() = mass_ * change.head<3>() - step_ * sum(force);
  gradient_.tail<3>() = inertia_ * change.tail<3>() - step_ * sum(torque);
  scale_ = step_ * sum(push);
}

void BodyProblem::factorise() {
  // J' S J of the slopes S: their part that is alike in all directions by its moments about the centre.
  const Lanes zero = Lanes::Zero();
  OuterProducts products;
  Lanes alike = zero;
  Triple<Lanes> first{zero, zero, zero};
  std::array<Lanes, 6> second{{zero, zero, zero, zero, zero, zero}}, twists = second;
  for (const Four& four : fours_) {
    const SpringResponse<Lanes>& response = four.response;
    const Triple<Lanes>& n = four.spring.normal;
    const Triple<Lanes>& r = four.arm;
    const Triple<Lanes> moment = response.along * r, turn = response.torque_slope * n;
    alike += response.along;
    first = first + moment;
    const std::array<Lanes, 6> squares{
        {moment.x * r.x, moment.y * r.y, moment.z * r.z, moment.x * r.y, moment.x * r.z, moment.y * r.z}};
    const std::array<Lanes, 6> turns{
        {turn.x * n.x, turn.y * n.y, turn.z * n.z, turn.x * n.y, turn.x * n.z, turn.y * n.z}};
    for (std::size_t i = 0; i < 6; ++i) second[i] += squares[i], twists[i] += turns[i];
    products.add(response.across - response.along, wrench_of(n, r));
    if (!any_above(response.slip, zero)) continue;
    products.add(-response.slip / greater(response.drawn_squared, constant<Lanes>(1e-300)),
                 wrench_of(response.drawn, r));
  }
  hessian_.setZero();
  products.add_to(hessian_);
  hessian_.diagonal().head<3>().array() += sum(alike);
  hessian_.bottomLeftCorner<3, 3>() += cross_matrix(sum(first));
  const double xx = sum(second[0]), yy = sum(second[1]), zz = sum(second[2]);
  hessian_.diagonal().tail<3>() +=
      Vector3(yy + zz, xx + zz, xx + yy) + Vector3(sum(twists[0]), sum(twists[1]), sum(twists[2]));
  hessian_(4, 3) += sum(twists[3]) - sum(second[3]);
  hessian_(5, 3) += sum(twists[4]) - sum(second[4]);
  hessian_(5, 4) += sum(twists[5]) - sum(second[5]);
  hessian_ *= step_;
  hessian_.diagonal().head<3>().array() += mass_;
  hessian_.bottomRightCorner<3, 3>() += inertia_;
  factors_.compute(hessian_);  // reads the lower triangle
}

double BodyProblem::error() const {
  return std::sqrt(gradient_.head<3>().squaredNorm() + gradient_.tail<3>().squaredNorm() / gyration_squared_);
}

double BodyProblem::energy() const {
  const Vector6 change = velocity_ - free_;
  double energy =
      0.5 * (mass_ * change.head<3>().squaredNorm() + change.tail<3>().dot(inertia_ * change.tail<3>()));
  for (std::size_t i = 0; i < contacts_->size(); ++i) {
    const IslandContact& contact = (*contacts_)[i];
    const Spring<Lanes>& limits = fours_[i / kLanes].spring;
    const int lane = static_cast<int>(i % kLanes);
    Spring<double> spring = contact.spring;
    spring.slip_limit = limits.slip_limit[lane];
    spring.twist_limit = limits.twist_limit[lane];
    const Vector3 u = contact.drive - velocity_.head<3>() - velocity_.tail<3>().cross(contact.arm_b);
    const double spin = contact.drive_spin - vector(spring.normal).dot(velocity_.tail<3>());
    energy += step_ * potential(spring, u, spin);
  }
  return energy;
}

void BodyProblem::finish(bool agree, std::vector<IslandContact>& contacts, BodyState& state) const {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Four& four = fours_[i / kLanes];
    const int lane = static_cast<int>(i % kLanes);
    Spring<double>& spring = contacts[i].spring;
    spring.slip_limit = four.spring.slip_limit[lane];
    spring.twist_limit = four.spring.twist_limit[lane];
    SpringResponse<double>& response = contacts[i].response;
    response.force = triple(lane_of(lane, four.response.force));
    response.drawn = triple(lane_of(lane, four.response.drawn));
    response.push = four.response.push[lane];
    response.wanted = four.response.wanted[lane];
    response.torque = four.response.torque[lane];
  }
  state.linear_momentum = mass_ * velocity_.head<3>();
  state.angular_momentum = inertia_ * velocity_.tail<3>();
  if (!agree) return;
  state.linear_momentum -= gradient_.head<3>();
  state.angular_momentum -= gradient_.tail<3>();
}

}  // namespace mrhi
