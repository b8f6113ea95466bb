#pragma once

#include "impact_solver.h"
#include "island_problem.h"
#include "large_island_solver.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where surfaces collide, and the
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the velocity that
/// results. One convex problem per island of touching bodies, M (v - v*) = h sum J' f(v), by Newton's method.
/// Release, damping, torsion and the lever of deep contacts are its own: it is not the seed model in the
/// limit of small steps. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  explicit ImplicitModel(const ContactConfiguration& configuration) : configuration_(configuration) {}
  void respond(ContactStep& step) override;

 protected:
  // The parts of respond(), in their order; islands are built after the first.
  void begin_contacts(ContactStep& step);
  void resolve_impacts(ContactStep& step);
  void solve_islands(ContactStep& step);
  static void end_contacts(ContactStep& step);

 private:
  bool solve(ContactStep& step, const Island& island);
  bool solve_large(ContactStep& step, const Island& island);

  LargeIslandSolver large_;
  std::vector<Vector3> last_forces_;  // by contact between bodies, of the step before [N]

 protected:
  const ContactConfiguration configuration_;
  Islands islands_;
  ImpactSolver impacts_;
  IslandProblem problem_;
};

}  // namespace mrhi
