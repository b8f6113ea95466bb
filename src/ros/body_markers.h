#pragma once

#include <vector>

#include "marker_layers.h"

namespace mrhi {

/// Where bodies are drawn.
struct BodyLayers {
  MarkerLayer &objects, &fixtures;
};

/// Draws the bodies of a scene. One into which a tracked finger has gone lets its ghost be seen.
class BodyMarkers {
 public:
  explicit BodyMarkers(const Scene& scene) : scene_(scene) {}  ///< keeps a reference

  /// Bodies that look other than when they were last added, or all.
  void add(const SimulationState& state, const std::vector<Contact>& contacts, bool all, BodyLayers layers);

 private:
  struct Look {
    Pose pose;
    double opacity = 1.0;
  };
  void add_body(const Body& body, const Look& look, int first_id, MarkerLayer& layer) const;

  const Scene& scene_;
  std::vector<Look> added_, now_;
};

}  // namespace mrhi
