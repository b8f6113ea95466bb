#pragma once

#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/SceneDescription.h>

#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// A simulation as its messages tell of it: what Markers and skins are drawn from where no simulation is.
/// Takes throw std::invalid_argument naming a value that is not allowed, and change nothing then.
class SceneView {
 public:
  SceneView() { state_.hands.resize(kMaxHands); }
  void take(const mr_hand_interaction::SceneDescription& description);
  void take(const mr_hand_interaction::ObjectStateArray& objects);  ///< those of the scene
  void take(const mr_hand_interaction::ContactArray& contacts);     ///< likewise
  void take_rendered(const mr_hand_interaction::HandFrame& frame);
  void take_tracked(const mr_hand_interaction::HandFrame& frame);

  const std::string& model() const { return model_; }  ///< contact model
  const Scene& scene() const { return scene_; }
  /// Bodies' poses, which of them are held, and the hands' ids.
  const SimulationState& state() const { return state_; }
  /// Rendered hands with what they press, the tracked hands that belong to them, and contacts.
  const FrameResult& result();

 private:
  std::string model_;
  Scene scene_;
  SimulationState state_;
  FrameResult result_;
  std::vector<Hand> tracked_;
};

}  // namespace mrhi
