#pragma once

#include <vector>

#include "../joints/linkage.h"
#include "../joints/linkage_flight.h"
#include "implicit_model.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

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
  const double usual_step_;           // regular step [s]
  Eigen::VectorXd positions_;
};

}  // namespace mrhi
