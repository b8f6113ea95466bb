#pragma once

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/interaction.h"
#include "offset_solver.h"

namespace mrhi {

/// Finds where a hand that is to be shown is near bodies, or in them, and on which side of them it stands.
class ClearanceFinder {
 public:
  /// Less deep than this the nearest way out is the way in [m].
  static constexpr double kShallow = 0.002;

  /// Keeps references.
  ClearanceFinder(const Scene& scene, const ContactFinder& finder) : scene_(scene), finder_(finder) {}

  /// Which hand it is, in which scene; `contacts` know the faces that its phalanges entered by.
  struct Setting {
    const Hand& tracked;
    int slot;
    const std::vector<BodyState>& bodies;
    const std::vector<Contact>& contacts;
    const Hand* shown_before;   ///< of the frame before, if the hand was there
    double moved;               ///< what hand and bodies have moved since [m]
    Interaction* interactions;  ///< of the hand, one per body: which of them it is shown in
  };
  /// Takes the bodies within `margin` of the tracked hand [m], but for those that it is shown in; false if
  /// there are none.
  bool begin(const Setting& setting, double margin);

  /// Of the bodies that the hand is shown in, some are near it.
  bool shown_in_any() const { return !shown_in_.empty(); }
  /// Ends this with those that the hand, as shown before, is clear of.
  void end_shown_in(const Hand& shown, Interaction* interactions) const;

  /// Of any point of the bodies near the hand [m/s].
  double fastest_body(const std::vector<BodyState>& bodies) const;

  /// Of a point of a body [m/s].
  Vector3 velocity(int body, const Vector3& point, const std::vector<BodyState>& bodies) const;

  /// Looks at the hand as placed: adds what is nearer than `margin` to `clearances`, and what is there
  /// already is measured anew. Returns the least gap [m], at most `margin`.
  double find(const Hand& placed, const Setting& setting, double margin,
              std::vector<Clearance>& clearances) const;

  /// A body that never moves.
  bool fixed(int body) const { return scene_.bodies[static_cast<std::size_t>(body)].fixed; }

  /// True if no capsule of the hand is in any of the bodies.
  bool clear(const Hand& hand) const;

 private:
  struct Near {
    int body, shape;
    ContactFinder::PlacedFrame frame;
    Vector3 centre;
    double radius;  // of a sphere about the centre that holds the body [m]
  };
  struct Face {
    Vector3 normal, point;
    double s0, s1;
  };
  template <typename See>
  static void each_near(const std::vector<Near>& near, const Hand& hand, double margin, const See& see);
  Face face(const Hand& placed, int capsule, const Near& near, const ClosestFeatures& features,
            const AxisSpan& span, const Setting& setting) const;
  const Scene& scene_;
  const ContactFinder& finder_;
  std::vector<Near> near_;
  std::vector<Near> shown_in_;
};

}  // namespace mrhi
