#pragma once

#include "gauss_seidel_solver.h"
#include "impact_solver.h"
#include "island_problem.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where surfaces collide, and
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the resulting velocity.
/// Solves one problem for each island, M (v - v*) = h sum J' f(v): of one body or a linkage by Newton's
/// method, of several bodies by Gauss-Seidel sweeps. Release, damping, torsion and the lever arm of deep
/// contacts are additions: it is not the limit of the seed model for small steps. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  explicit ImplicitModel(const ContactConfiguration& configuration) : configuration_(configuration) {}
  void respond(ContactStep& step) override;

 protected:
  // The parts of respond(), in order; islands are built after the first.
  void begin_contacts(ContactStep& step);
  void resolve_impacts(ContactStep& step);
  void solve_islands(ContactStep& step);
  static void end_contacts(ContactStep& step);
  ImpactFriction impact_friction() const {
    return configuration_.impact_friction ? ImpactFriction::coulomb : ImpactFriction::none;
  }

 private:
  bool solve(ContactStep& step, const Island& island);
  bool solve_several(ContactStep& step, const Island& island);

  GaussSeidelSolver several_;
  std::vector<Vector3> last_forces_;  // of contacts between bodies, then with hands [N]

 protected:
  const ContactConfiguration configuration_;
  Islands islands_;
  ImpactSolver impacts_;
  IslandProblem problem_;
};

}  // namespace mrhi
