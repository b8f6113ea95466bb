#pragma once

#include <array>
#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "short_turns.h"

namespace mrhi {

/// free_flight for the bodies of a scene, to the same bits: those that turn by little in a step do so four
/// side by side.
class FreeFlights {
 public:
  explicit FreeFlights(const Scene& scene);  ///< keeps a reference

  /// As free_flight, but that a short turn comes with turn().
  void fly(std::size_t body, const Vector3& gravity, double step, BodyState& state);
  void turn(std::vector<BodyState>& states);

 private:
  /// Of a body, apart from the much that a step does not look at.
  struct Flyer {
    double mass, quickness;
    bool flies;
  };
  /// Bodies that follow each other in the scene.
  struct Four {
    Spinner<Lanes> bodies;
    Turning<Lanes> states;
    std::array<bool, kLanes> turns{};
    int count = 0;  // of those that turn
  };

  const Scene& scene_;
  const ShortTurns turn_four_ = short_turns();
  std::vector<Flyer> flyers_;
  std::vector<Four> fours_;
};

}  // namespace mrhi
