#pragma once

#include <vector>

#include "impact.h"
#include "linkage_problem.h"

namespace mrhi {

/// The impulse phase of an island with joints: Newton's impact law along the normal, once per approach, and
/// Coulomb's friction, all strikes of a step as one blow, which joints pass on. Impulses only push, and where
/// restitution together with friction would make energy, things part by less. Fingers
/// that close from both sides press and do not strike: then there is none.
class LinkageImpacts {
 public:
  /// What strikes in this step, by the problem's velocities at its start.
  bool find(ContactStep& step, const Island& island, const LinkageProblem& problem,
            const std::vector<JointState>& joints);
  /// Leaves out what springs carry the hand's contacts away from by themselves: at this velocity.
  void spare_carried(const ContactStep& step, const LinkageProblem::Vector& velocity);
  /// Gives the impulses, if any; `velocity` is what they make of the problem's start.
  bool deal(const LinkageProblem& problem, bool friction, LinkageProblem::Vector& velocity);
  /// Tells the problem, once it starts with that velocity, what limits gave.
  void tell_limits(LinkageProblem& problem);

 private:
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  struct Strike {
    Contact* hand = nullptr;
    BodyContact* between = nullptr;
    Eigen::Index joint = -1;  // an unknown: its limit is struck
    Vector3 normal, drive;
    Rows rows;  // relative velocity of 1 against 2 = drive + rows * unknowns
    Eigen::Matrix<double, Eigen::Dynamic, 3> answer;  // of the unknowns to an impulse on 1
    Matrix3 tangential_mass;
    double time = 0.0, gap = 0.0, restitution = 0.0, friction = 0.0, inverse_mass = 0.0;
    double normal_mass = 0.0, target = 0.0, magnitude = 0.0;
    Vector3 approach, drag, recoil;

    Vector3 relative_velocity(const LinkageProblem::Vector& velocity) const {
      return drive + recoil + rows * velocity;
    }
    /// What 2 has got of this blow [N s].
    Vector3 given() const { return drag - magnitude * normal; }
    void push(const Vector3& on_first, LinkageProblem::Vector& velocity);
    double relax_normal(LinkageProblem::Vector& velocity);
    double relax_tangential(LinkageProblem::Vector& velocity);
  };
  /// One to be filled in, whose room is that of strikes of earlier steps; add() keeps it if it strikes.
  Strike& next();
  struct Strikes {
    Strike *first, *last;
    Strike* begin() const { return first; }
    Strike* end() const { return last; }
  };
  Strikes strikes() { return {strikes_.data(), strikes_.data() + count_}; }
  void find_limits(const ContactStep& step, const LinkageProblem& problem,
                   const std::vector<JointState>& joints);
  void add(double step, const LinkageProblem& problem);
  void prepare(const LinkageProblem& problem, Strike& strike);
  bool solve(bool friction, LinkageProblem::Vector& velocity);
  void keep_to_energy(const LinkageProblem& problem, bool friction, LinkageProblem::Vector& velocity);

  std::vector<Strike> strikes_;  // the first count_ of them are of this step
  std::size_t count_ = 0;
  std::vector<TwoBlows> both_;
  LinkageProblem::Vector column_;
};

}  // namespace mrhi
