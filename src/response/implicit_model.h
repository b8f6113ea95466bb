#pragma once

#include "body_problem.h"
#include "impact_solver.h"
#include "island_problem.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where surfaces strike, and the
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the velocity that
/// results. One convex problem per island of touching bodies, M (v - v*) = h sum J' f(v), by Newton's method;
/// as the step goes to zero it becomes the seed model. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  explicit ImplicitModel(const ContactConfiguration& configuration) : configuration_(configuration) {}
  void respond(ContactStep& step) override;

 private:
  void respond(ContactStep& step, const Islands::Island& island);
  void gather(const ContactStep& step, const Islands::Island& island);
  int place_of(int body);

  const ContactConfiguration configuration_;
  ImpactSolver impacts_;
  Islands islands_;
  BodyProblem one_;
  IslandProblem several_;
  // The island at hand: its bodies, and its contacts with the entries they stand for.
  std::vector<int> bodies_, places_;
  std::vector<IslandContact> contacts_;
  std::vector<ContactIndex> entries_;
};

}  // namespace mrhi
