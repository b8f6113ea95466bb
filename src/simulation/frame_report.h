#pragma once

#include <vector>

#include "../collision/contact_finder.h"
#include "../rendering/renderer.h"
#include "mr_hand_interaction/simulation.h"
#include "operators.h"

namespace mrhi {

/// Momentum transferred by contacts and grasp assist since the frame before; `force` is the sum of force
/// times step [N s].
struct FrameTransfer {
  std::vector<Contact> contacts;      ///< sorted by key
  std::vector<GraspSupport> assists;  ///< sorted by hand and body
  double seconds = 0.0;               ///< time of the steps

  void clear() { contacts.clear(), assists.clear(), seconds = 0.0; }
  /// Adds the transfer of a step of `step` seconds.
  void add(const SimulationState& after, double step);
};

/// Input of a frame's report, once bodies and hands are at the frame's stamp.
struct FrameEnd {
  const Scene& scene;
  std::vector<HandMotion>& hands;  ///< those that can touch
  Neighbours& neighbours;
  ContactFinder& finder;
  const Operators& operators;
  const FrameTransfer& transfer;
  const HandStrength& strength;
  SimulationState& state;  ///< its interactions are updated
};

/// Contacts as they are at the frame's end, with the mean of their forces and the sum of their impulses since
/// the frame before; contacts that have ended since then; then the events that follow from them, and the
/// tracked hands.
void report_frame(const FrameEnd& end, FrameResult& result);

/// Input of the rendered hands, after the report.
struct Rendering {
  const Scene& scene;
  HandRenderer& renderer;
  const Operators& operators;
  const Vector3& gravity;
  double control_display_ratio;
  SimulationState& state;  ///< its offsets and mass lags are updated
};
void render_hands(const Rendering& rendering, FrameResult& result);

/// Ends all interactions of a hand that is about to be lost.
void end_interactions(std::size_t slot, Nanoseconds now, SimulationState& state, std::vector<Event>& events);

}  // namespace mrhi
