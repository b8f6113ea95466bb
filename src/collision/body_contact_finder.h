#pragma once

#include <optional>
#include <vector>

#include "mr_hand_interaction/collision/body_contact.h"
#include "neighbours.h"
#include "scene_geometry.h"
#include "step_motion.h"

namespace mrhi {

/// Finds where bodies touch each other, or will within the step.
class BodyContactFinder {
 public:
  /// Keeps references.
  BodyContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity);

  /// Every step: replaces `contacts` (sorted by key) by the present ones, except between bodies that are
  /// `asleep`. Lasting contacts keep their memory. `driven`: largest change of a body's velocity by hands in
  /// the step [m/s].
  void find(const Neighbours& neighbours, const std::vector<BodyState>& bodies,
            const std::vector<char>& asleep, double step, double driven, std::vector<BodyContact>& contacts);

  /// Work of the last find(), in searches of a mesh (SearchBudget).
  double work() const { return work_; }

 private:
  struct StepBox {
    Vector3 centre, half;              // of a box [m]
    double travel;                     // in the step, and half the gap from which contacts are followed [m]
    std::optional<MovingBody> moving;  // of a body that another's box overlaps
  };
  double followed_gap(const Neighbours& neighbours, const std::vector<BodyState>& bodies,
                      const std::vector<char>& asleep, double step, double driven) const;
  StepBox step_box(std::size_t index, const BodyState& state, double step) const;
  const BodyContactMemory* memory_of(const BodyContactKey& key);
  void find_pair(std::size_t a, std::size_t b, double step, std::vector<BodyContact>& contacts);

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Vector3 gravity_;
  double work_ = 0.0;                               // so far in this step, in searches
  double followed_ = 0.0;                           // gap from which contacts are followed in this step [m]
  std::vector<std::optional<StepBox>> step_boxes_;  // by body, of those with an awake neighbour
  std::vector<Vector3> centres_;                    // of the shapes of a pair's second body, in world [m]
  std::vector<BodyContactMemory> before_;           // of the last step's contacts
  std::size_t memory_index_ = 0;                    // in it
};

}  // namespace mrhi
