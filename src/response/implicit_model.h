#pragma once

#include <vector>

#include "../joints/linkage.h"
#include "gauss_seidel_solver.h"
#include "impact_solver.h"
#include "island_problem.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where surfaces collide, and
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the resulting velocity.
/// Solves one problem for each island, M (v - v*) = h sum J' f(v): of one body or a linkage by Newton's
/// method, of several bodies by Gauss-Seidel sweeps. Release, damping, torsion and the lever arm of deep
/// contacts are additions: it is not the limit of the seed model for small steps. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;

 protected:
  // The parts of respond(), in order; islands are built after the first.
  void begin_contacts(ContactStep& step);
  void resolve_impacts(ContactStep& step);
  void solve_islands(ContactStep& step);
  static void end_contacts(ContactStep& step);
  static ImpactFriction impact_friction(const ContactStep& step) {
    return step.configuration.impact_friction ? ImpactFriction::coulomb : ImpactFriction::none;
  }

 private:
  bool solve(ContactStep& step, const Island& island);

  GaussSeidelSolver several_;
  std::vector<Vector3> last_forces_;  // of contacts between bodies, then with hands [N]

 protected:
  Islands islands_;
  ImpactSolver impacts_;
  IslandProblem problem_;
};

/// The implicit model for scenes with joints. Solves islands with joints in joint coordinates, together with
/// their contacts, and advances their linkages through the step. Scenes without joints do not use it.
class JointedModel : public ImplicitModel {
 public:
  /// Keeps references to the state, for the joints' state, and to the events, to which it adds those of
  /// joints.
  JointedModel(const Configuration& configuration, const Scene& scene, SimulationState& state,
               std::vector<Event>& events);
  void respond(ContactStep& step) override;

 private:
  void place(const ContactStep& step, std::size_t linkage);
  void respond(ContactStep& step, const Island& island);
  void fly(const ContactStep& step);
  void note(std::size_t joint);

  const Scene& scene_;
  SimulationState& state_;
  std::vector<Event>& events_;
  const std::vector<Linkage> linkages_;
  std::vector<std::vector<int>> groups_;  // bodies of each linkage
  std::vector<LinkageMotion> motions_;
  std::vector<LinkageFlight> flights_;
  std::vector<char> awake_, solved_;  // by linkage; solved: momenta include gravity
  const double regular_step_;         // regular step [s]
  Eigen::VectorXd positions_;
};

}  // namespace mrhi
