#pragma once

#include <vector>

#include "../joints/linkage.h"
#include "../joints/linkage_flight.h"
#include "implicit_model.h"
#include "linkage_impacts.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// The implicit model for scenes with joints. What hangs on joints is solved in their coordinates, with all
/// that touches it, and moved on through the step as well: its free flight is its joints'. Scenes without
/// joints never meet it, and pay nothing.
class JointedModel : public ImplicitModel {
 public:
  /// Keeps references: to the state for what joints remember, to the events for what they do.
  JointedModel(const Configuration& configuration, const Scene& scene, SimulationState& state,
               std::vector<Event>& events);
  void respond(ContactStep& step) override;

 private:
  bool sleeps(const ContactStep& step, const Island& island) const;
  void place(const ContactStep& step, std::size_t linkage);
  void respond(ContactStep& step, const Island& island);
  void resolve_impacts(ContactStep& step, const Island& island);
  void fly(const ContactStep& step);
  void rest(const ContactStep& step, std::size_t linkage);
  void note(std::size_t joint);

  const Scene& scene_;
  SimulationState& state_;
  std::vector<Event>& events_;
  const std::vector<Linkage> linkages_;
  std::vector<std::vector<int>> groups_;  // of bodies, by linkage
  std::vector<LinkageMotion> motions_;
  std::vector<LinkageFlight> flights_;
  std::vector<char> awake_, solved_;  // by linkage; solved: gravity has been given
  const double usual_step_;           // [s]
  LinkageImpacts linkage_impacts_;
  Eigen::VectorXd positions_;
};

}  // namespace mrhi
