#pragma once

#include <vector>

#include "contact_patch.h"
#include "islands.h"

namespace mrhi {

/// Solves the contact problem of an island of several bodies: the law of IslandProblem, but with Coulomb's
/// limits by the normal force of the same iterate. The unknowns are the contacts' impulses. Symmetric sweeps
/// solve each contact with all others fixed (nonlinear Gauss-Seidel: Jourdan, Alart & Jean 1998), accelerated
/// as conjugate gradients (Silcowitz, Niebe & Erleben 2010). They end when no body's velocity changes
/// visibly, or with the step's budget. The last step's contact forces are the warm start. Impulses act on
/// both bodies, so momentum is conserved at any iterate. Cost is linear in the contacts. Keeps its memory.
class GaussSeidelSolver {
 public:
  /// `last_forces`: in the last step, of the step's contacts between bodies, then of those with hands [N];
  /// must outlive solve().
  void begin(const ContactStep& step, const Island& island, const std::vector<Vector3>& last_forces);
  void solve(const ContactStep& step);
  /// True if any contact has a normal impulse or a bond.
  bool acts() const;
  /// Writes the contacts and the bodies' momenta at the end of the step.
  void finish(ContactStep& step, const Island& island);

 private:
  /// Contacts of one pair of shapes, as a range in ContactStep::body_contacts.
  struct Range {
    std::size_t first, last;
  };

  void add_body(const Body& body, const BodyState& state, const ContactStep& step);
  void add_links(const ContactStep& step, const Island& island);
  void add_link(const ContactStep& step, const Range& range);
  void add_patch(const SpringContact* rows, int count, const Vector3* forces);
  void relax(ContactPatch& patch);

  double max_mass_ratio() const;
  int height();
  int max_sweeps(int height, bool rests, bool uneven) const;
  double begin_speed(const ContactStep& step) const;
  double max_change(const std::vector<Motion6>& then) const;
  double missing_speed(const ContactStep& step, const Range& range) const;
  double max_speed_gain() const;
  bool admit_closing(const ContactStep& step, double given);
  void sweep();
  double accelerate(double last);
  PatchBody& body(int number) { return bodies_[number]; }
  const PatchBody& body(int number) const { return bodies_[number]; }

  const std::vector<Vector3>* last_forces_ = nullptr;
  const Island* island_ = nullptr;
  double step_ = 0.0;
  std::vector<PatchBody> bodies_;   // the last one is immovable: fixtures and hands
  std::vector<Motion6> free_;       // at the end of the step, without contacts
  std::vector<PatchPoint> points_;  // of hands and grips, then of links
  std::vector<ContactPatch> patches_;
  std::vector<SpringContact> hand_rows_;  // of the points of hands and grips
  std::vector<SpringContact> link_rows_;  // of one patch of links
  std::vector<std::size_t> linked_;       // of the links' points: index in ContactStep::body_contacts
  std::vector<Range> open_;               // between bodies: without impulse at checked_
  std::vector<Motion6> checked_;          // motions at which open_ was checked
  double min_missing_speed_ = 0.0;        // smallest missing_speed() of open_ at checked_ [m/s]
  double max_arm_ = 0.0;                  // of any contact [m]
  std::vector<int> levels_;               // of bodies_, above what is immovable
  // State before a sweep, and the current search directions.
  std::vector<Motion6> motions_before_, motion_directions_;
  std::vector<PatchImpulses> impulses_before_, impulse_directions_;
};

}  // namespace mrhi
