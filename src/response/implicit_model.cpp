#include "implicit_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "implicit_contact.h"
#include "mr_hand_interaction/response/impact.h"

namespace mrhi {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kMaxContacts = 96;  // on one body
constexpr int kMaxIterations = 40;
constexpr int kMaxHeldIterations = 60;
constexpr int kMaxLimits = 8;
constexpr int kMaxHalvings = 12;
/// The first full steps need no check: they are exact while contacts neither open nor slip, and what is wrong
/// with them shows in the next iterate.
constexpr int kUncheckedIterations = 2;
constexpr double kConverged = 1e-10;  // of the forces' impulse

/// The problem of one body: find the velocity V at the end of the step.
class BodyProblem {
 public:
  BodyProblem(const ContactStep& step, const Body& body, const BodyState& state)
      : step_(step.step), state_(state), mass_(body.mass) {
    const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
    inertia_ = rotation * body.inertia * rotation.transpose();
    radius_squared_ = body.inertia.trace() / (3.0 * body.mass);
    const Twist twist = twist_of(body, state);
    start_ << twist.linear, twist.angular;
    free_ = start_;
    free_.head<3>() += step.step * step.gravity;
  }

  void add(Contact& contact, const Material& material, bool torsion) {
    if (count_ == kMaxContacts) return;
    contacts_[count_++].emplace(contact, material, torsion, state_.pose.position, step_);
  }

  /// Newton's method with the friction limits of the last iterate; each iterate's problem is convex.
  Vector6 solve() {
    Vector6 velocity = start_;
    for (int i = 0; i < kMaxIterations; ++i) {
      limit_friction(velocity);
      assemble(velocity);
      if (solved()) return velocity;
      advance(i >= kUncheckedIterations, velocity);
    }
    return solve_with_held_limits();
  }

  void finish(const Vector6& velocity) {
    for (std::size_t i = 0; i < count_; ++i)
      contacts_[i]->finish(velocity.head<3>(), velocity.tail<3>(), state_);
  }

  bool anything_acts() const { return impulse_scale_ > 0.0; }
  Vector3 angular_momentum(const Vector6& velocity) const { return inertia_ * velocity.tail<3>(); }

 private:
  /// Where the limits keep chasing the velocity: they are held while the convex problem is solved to its end,
  /// then renewed. The solution for any limits is passive, so whenever this stops nothing is thrown.
  Vector6 solve_with_held_limits() {
    Vector6 velocity = start_;
    for (int renewed = 0; renewed < kMaxLimits; ++renewed) {
      limit_friction(velocity);
      for (int i = 0; i < kMaxHeldIterations; ++i) {
        assemble(velocity);
        if (solved()) break;
        advance(true, velocity);
      }
    }
    return velocity;
  }

  bool solved() const { return error() <= kConverged * impulse_scale_ + 1e-18; }

  void advance(bool checked, Vector6& velocity) const {
    const Vector6 direction = -hessian_.llt().solve(gradient_);
    velocity += (checked ? line_search(velocity, direction) : 1.0) * direction;
  }

  void limit_friction(const Vector6& velocity) {
    for (std::size_t i = 0; i < count_; ++i)
      contacts_[i]->limit_friction(velocity.head<3>(), velocity.tail<3>());
  }

  void assemble(const Vector6& velocity) {
    const Vector6 change = velocity - free_;
    gradient_.head<3>() = mass_ * change.head<3>();
    gradient_.tail<3>() = inertia_ * change.tail<3>();
    hessian_.setZero();
    hessian_.topLeftCorner<3, 3>() = mass_ * Matrix3::Identity();
    hessian_.bottomRightCorner<3, 3>() = inertia_;
    impulse_scale_ = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const ImplicitContact& contact = *contacts_[i];
      const ImplicitContact::Response response = contact.evaluate(velocity.head<3>(), velocity.tail<3>());
      if (response.push <= 0.0 && !contact.rubs()) continue;
      const Vector3& r = contact.arm();
      const Vector3& n = contact.normal();
      gradient_.head<3>() -= step_ * response.force;
      gradient_.tail<3>() -= step_ * (r.cross(response.force) + response.torque * n);
      const Matrix3 arm = cross_matrix(r);
      const Matrix3 slope = step_ * response.force_slope;
      const Matrix3 coupling = arm * slope;
      hessian_.topLeftCorner<3, 3>() += slope;
      hessian_.bottomLeftCorner<3, 3>() += coupling;
      hessian_.bottomRightCorner<3, 3>() +=
          (step_ * response.torque_slope) * n * n.transpose() - coupling * arm;
      impulse_scale_ += step_ * response.push;
    }
    hessian_.topRightCorner<3, 3>() = hessian_.bottomLeftCorner<3, 3>().transpose();
  }

  /// Impulse that is missing, a torque counted at the body's radius of gyration [N s].
  double error() const {
    return std::sqrt(gradient_.head<3>().squaredNorm() + gradient_.tail<3>().squaredNorm() / radius_squared_);
  }

  double energy(const Vector6& velocity) const {
    const Vector6 change = velocity - free_;
    double sum =
        0.5 * (mass_ * change.head<3>().squaredNorm() + change.tail<3>().dot(inertia_ * change.tail<3>()));
    for (std::size_t i = 0; i < count_; ++i) {
      sum += step_ * contacts_[i]->potential(velocity.head<3>(), velocity.tail<3>());
    }
    return sum;
  }

  /// Part of the way that lowers the energy.
  double line_search(const Vector6& velocity, const Vector6& direction) const {
    const double before = energy(velocity), descent = gradient_.dot(direction);
    double part = 1.0;
    for (int i = 0; i < kMaxHalvings; ++i, part *= 0.5) {
      if (energy(velocity + part * direction) <= before + 1e-4 * part * descent) break;
    }
    return part;
  }

  double step_;
  const BodyState& state_;
  double mass_;
  double radius_squared_ = 0.0;
  Matrix3 inertia_;
  Vector6 start_, free_;
  std::array<std::optional<ImplicitContact>, kMaxContacts> contacts_;
  std::size_t count_ = 0;
  Vector6 gradient_;
  Matrix6 hessian_;
  double impulse_scale_ = 0.0;
};

}  // namespace

void ImplicitModel::respond(ContactStep& step) const {
  impulse_phase(step, ImpactFriction::coulomb);
  auto first = step.contacts.begin();
  while (first != step.contacts.end()) {
    const std::size_t index = first->key.body;
    const auto last = std::find_if(first, step.contacts.end(),
                                   [index](const Contact& contact) { return contact.key.body != index; });
    const Body& body = step.scene.bodies[index];
    BodyState& state = step.bodies[index];
    BodyProblem problem(step, body, state);
    for (auto contact = first; contact != last; ++contact) {
      contact->force.setZero();
      contact->struck = contact->struck || contact->depth > 0.0;
      if (!contact->ignored) problem.add(*contact, body.material, torsion_);
    }
    first = last;
    if (body.fixed) continue;
    const Vector6 velocity = problem.solve();
    if (!problem.anything_acts()) continue;
    problem.finish(velocity);
    state.linear_momentum = body.mass * velocity.head<3>();
    state.angular_momentum = problem.angular_momentum(velocity);
    step.solved[index] = true;
  }
}

}  // namespace mrhi
