#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "fuzz/target.h"
#include "mr_hand_interaction/simulation.h"
#include "response/spring_contact.h"
#include "text/text.h"

namespace mrhi::fuzzing {

/// Of what has flowed: where the solvers of a step end.
constexpr double kRounding = 1e-5;
/// The same where a grip bears, whose springs are the stiffest by far.
constexpr double kGripRounding = 1e-4;
/// Part of its energy by which a body that is struck may be wrong, as it turns on within the step [1/s].
constexpr double kTurning = 20.0;

/// Part of its energy by which what hangs on joints may be wrong, for each radian that it turns in a step:
/// what acts on joints is given as the step begins, and then they swing.
constexpr double kSwing = 0.25;
/// Part of what a grip's springs can bear by which what is told of them may be off: where the last step of
/// the solver is not looked at again (newton.cpp), forces are those before it. What becomes of bodies is not.
constexpr double kTold = 1e-4;
/// What holds a joint (friction, a latch, limits) is a spring so much stiffer than its inertia within a step
/// (joint_law.cpp); steps of other lengths find it otherwise loaded.
constexpr double kHolds = 1e4;

inline double detent_stiffness(const Joint& joint) {
  if (!joint.detents) return 0.0;
  const std::vector<double>& at = joint.detents->at;
  double least = at.back() - at.front();
  for (std::size_t i = 1; i < at.size(); ++i) least = std::min(least, at[i] - at[i - 1]);
  return joint.detents->force / (0.5 * least);
}

inline double stored_by_detents(const Joint& joint, double position) {
  if (!joint.detents) return 0.0;
  double away = std::abs(joint.detents->at[0] - position);
  for (const double at : joint.detents->at) away = std::min(away, std::abs(at - position));
  return 0.5 * detent_stiffness(joint) * away * away;
}

/// What a joint's springs, detents and latch have stored where it is [J].
inline double stored(const Joint& joint, double position) {
  double energy = 0.0;
  const auto spring = [&](double stiffness, double rest) {
    energy += 0.5 * stiffness * (position - rest) * (position - rest);
  };
  if (joint.spring) spring(joint.spring->stiffness, joint.spring->rest);
  energy += stored_by_detents(joint, position);
  if (joint.latch)
    energy += joint.latch->force * std::min(std::abs(position - joint.latch->at), joint.latch->reach);
  return energy;
}

/// Energy and momentum of the free bodies, and what the hands have done to them since nothing was touched: a
/// spring that is pressed has taken work that it gives back later. What acts is taken down as a step's
/// response ends (see Simulation::watch): what is told of a grip's contacts later is no sum of springs.
class Ledger {
 public:
  explicit Ledger(const Simulation& simulation)
      : simulation_(simulation),
        before_(present()),
        largest_(before_.size),
        begun_(simulation.state().bodies) {
    for (std::size_t j = 0; j < simulation.scene().joints.size(); ++j) note_held(j);
  }

  /// As the response ends.
  void see() {
    contacts_ = simulation_.state().contacts;
    grips_ = simulation_.state().grips;
  }

  /// After a step of `seconds`.
  void note(double seconds) {
    bool struck = false;
    touched_.swap(touched_before_);
    touched_.clear();
    for (const Contact& contact : contacts_) {
      note_contact(contact, seconds);
      struck = struck || !contact.impulse.isZero(0.0);
    }
    for (const Grip& grip : grips_) note_grip(grip, seconds);
    for (const BodyContact& contact : simulation_.state().body_contacts)
      struck = struck || !contact.impulse.isZero(0.0);
    if (struck) work_ += kTurning * seconds * present().size;
    for (const Body& body : simulation_.scene().bodies)
      if (!body.fixed) impulse_ += body.mass * seconds * simulation_.scene().gravity;
    for (std::size_t j = 0; j < simulation_.state().joints.size(); ++j) note_joint(j, seconds);
    if (!simulation_.scene().joints.empty()) note_weight(seconds);
    largest_ = std::max(largest_, present().size);
    begun_ = simulation_.state().bodies;
  }

  /// By how much more energy there is than the hands' work explains, over the energy that there was at most
  /// and all that has flowed.
  double surplus() const {
    const double size = largest_ + flow_;
    const double known = held_ + weighed_ + kSwing * swing_ * largest_;
    return size > 0.0 ? (present().energy - before_.energy - work_ - known) / size : 0.0;
  }
  void check_energy() const {
    require(surplus() <= rounding(), "energy " + text::number(present().energy) + " J is at most " +
                                         text::number(before_.energy) + " J and the hands' work, " +
                                         text::number(work_) + " J");
  }
  void check_momentum() const {
    const double off = (present().momentum - before_.momentum - impulse_).norm();
    require(off <= rounding() * (largest_ + flow_) + kTold * gripped_,
            "momentum is what the hands gave, but for " + text::number(off) + " of " +
                text::number(largest_ + flow_) + " N s");
  }

 private:
  struct Sum {
    double energy = 0.0, size = 0.0;
    Vector3 momentum = Vector3::Zero();
  };
  double rounding() const { return borne_ ? kGripRounding : kRounding; }
  struct Touched {
    std::uint64_t key;
    double compliance;
  };

  void note_contact(const Contact& contact, double seconds) {
    const Material& material = simulation_.scene().bodies[contact.key.body].material;
    const Vector3 impulse = contact.force * seconds + contact.impulse;
    impulse_ += impulse;
    flow_ += impulse.norm() * (1.0 + contact.hand_velocity.norm());
    // A fingertip that turns does work by torsion, which Coulomb's law bounds.
    work_ += impulse.dot(contact.hand_velocity) +
             material.static_friction * contact.patch * impulse.norm() * std::abs(contact.hand_spin);
    if (contact.touching() && has_springs()) note_pressed(contact, material.stiffness);
  }
  /// What a finger is in the body already when the touch begins, its spring has without having been seen to
  /// take it; and a finger that had given way comes to press of itself.
  void note_pressed(const Contact& contact, double stiffness) {
    const std::uint64_t key = contact.key.order();
    touched_.push_back({key, contact.compliance});
    const auto before = std::find_if(touched_before_.begin(), touched_before_.end(),
                                     [key](const Touched& touched) { return touched.key == key; });
    if (before == touched_before_.end()) {
      work_ += 0.5 * stiffness * contact.depth * contact.depth;
    } else if (contact.compliance < before->compliance) {
      work_ += stiffness * std::max(contact.pressed(), 0.0) * (before->compliance - contact.compliance);
    }
  }
  /// Its force with the mean of where its springs end in the hand, and at most what each of them can give
  /// with that end's motion against the mean, as the hand turns.
  void note_grip(const Grip& grip, double seconds) {
    if (!grip.active) return;
    borne_ = true;
    const Pose& pose = begun_[grip.body].pose;
    const double ahead = look_ahead(seconds, simulation_.configuration().contact.damping);
    Vector3 mean = Vector3::Zero();
    for (const Vector3& velocity : grip.velocity) mean += velocity / kGripPoints;
    double power = grip.force.dot(mean);
    for (std::size_t i = 0; i < kGripPoints; ++i) {
      const Vector3 stretch = grip.point[i] + ahead * grip.velocity[i] - pose * grip.in_body[i];
      const double most = std::min(grip.bond, grip.stiffness * stretch.norm());
      power += std::max(most, grip.force.norm() / kGripPoints) * (grip.velocity[i] - mean).norm();
      gripped_ += seconds * grip.bond;
    }
    work_ += seconds * power;
    flow_ += seconds * (grip.force.norm() + std::abs(power));
    impulse_ += seconds * grip.force;
  }
  /// Where contacts or joints push, gravity pushes as the step begins, and things fall by the velocity that
  /// comes of it: their energy comes and goes by its work within a step.
  void note_weight(double seconds) {
    double power = 0.0;
    for (std::size_t b = 0; b < begun_.size(); ++b) {
      if (simulation_.scene().bodies[b].fixed) continue;
      const Vector3 faster = begun_[b].linear_momentum.cwiseAbs().cwiseMax(
          simulation_.state().bodies[b].linear_momentum.cwiseAbs());
      power += simulation_.scene().gravity.cwiseAbs().dot(faster);
    }
    weighed_ = std::max(weighed_, seconds * power);
  }
  void note_joint(std::size_t j, double seconds) {
    const Joint& joint = simulation_.scene().joints[j];
    const Body& child = simulation_.scene().bodies[static_cast<std::size_t>(joint.child)];
    const BodyState& state = simulation_.state().bodies[static_cast<std::size_t>(joint.child)];
    flow_ += std::abs(simulation_.state().joints[j].effort) * seconds;
    swing_ = std::max(swing_, seconds * twist_of(child, state).angular.norm());
    note_held(j);
  }
  /// The joint may move the child or all that is before it: the lightest body is what it moves at least.
  double least_inertia(JointKind kind) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Body& body : simulation_.scene().bodies) {
      if (body.fixed) continue;
      const Vector3 inertias = Eigen::SelfAdjointEigenSolver<Matrix3>(body.inertia).eigenvalues();
      least = std::min(least, kind == JointKind::sliding ? body.mass : inertias[0]);
    }
    return least;
  }
  void note_held(std::size_t j) {
    const Joint& joint = simulation_.scene().joints[j];
    const double position = simulation_.state().joints[j].position;
    const double effort = std::abs(simulation_.state().joints[j].effort);
    const double drawn = std::sqrt(2.0 * stored_by_detents(joint, position) * detent_stiffness(joint));
    const double force =
        effort + joint.friction + drawn + (joint.latch ? joint.latch->force : 0.0) +
        (joint.spring ? joint.spring->stiffness * std::abs(position - joint.spring->rest) : 0.0);
    const double longest = simulation_.configuration().step;
    held_ = std::max(held_, force * force * longest * longest / (kHolds * least_inertia(joint.kind)));
  }
  bool has_springs() const { return simulation_.configuration().contact_model != ContactModelKind::impulse; }
  Sum present() const {
    const Scene& scene = simulation_.scene();
    Sum sum;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const Body& body = scene.bodies[b];
      const BodyState& state = simulation_.state().bodies[b];
      if (body.fixed) continue;
      const double kinetic = kinetic_energy(body, state);
      const double height = -body.mass * scene.gravity.dot(state.pose.position);
      sum.energy += kinetic + height;
      sum.size += kinetic + std::abs(height) + state.linear_momentum.norm();
      sum.momentum += state.linear_momentum;
    }
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const double energy = stored(scene.joints[j], simulation_.state().joints[j].position);
      sum.energy += energy;
      sum.size += energy;
    }
    return sum;
  }

  const Simulation& simulation_;
  const Sum before_;
  double work_ = 0.0, flow_ = 0.0, largest_;
  bool borne_ = false;               // by a grip
  double held_ = 0.0, swing_ = 0.0;  // of joints [J], [rad]
  double weighed_ = 0.0;             // work of gravity in a step, at most [J]
  double gripped_ = 0.0;             // by springs of grips [N s]
  Vector3 impulse_ = Vector3::Zero();
  std::vector<Contact> contacts_;
  std::vector<Grip> grips_;
  std::vector<BodyState> begun_;  // as the step begins
  std::vector<Touched> touched_, touched_before_;
};

}  // namespace mrhi::fuzzing
