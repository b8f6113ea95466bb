#pragma once

#include "body_problem.h"
#include "crowd_problem.h"
#include "impact_solver.h"
#include "island_problem.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where surfaces strike, and the
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the velocity that
/// results. One convex problem per island of touching bodies, M (v - v*) = h sum J' f(v), by Newton's method.
/// Release, damping, torsion and the lever of deep presses are its own: it is not the seed model in the limit
/// of small steps. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  explicit ImplicitModel(const ContactConfiguration& configuration) : configuration_(configuration) {}
  void respond(ContactStep& step) override;

 protected:
  // The parts of respond(), in their order; islands are built between the first two.
  void begin_touches(ContactStep& step) const;
  void strike(ContactStep& step);
  void press(ContactStep& step);

 private:
  void solve_one(ContactStep& step, const Island& island);
  void solve_few(ContactStep& step, const Island& island);
  void solve_crowd(ContactStep& step, const Island& island);
  static void note(ContactStep& step, const Island& island, bool pressed);

  BodyProblem one_;
  IslandProblem several_;
  CrowdProblem many_;
  std::vector<Vector3> carried_;  // by contact between bodies: its force in the last step [N]

 protected:
  const ContactConfiguration configuration_;
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace mrhi
