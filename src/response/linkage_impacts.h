#pragma once

#include <deque>
#include <vector>

#include "impact_point.h"
#include "island_problem.h"

namespace mrhi {

/// The impact points of an island with joints, in the coordinates of its IslandProblem: contacts with hands,
/// between bodies, and joints that reach a limit. Linkages transmit the impulses.
class LinkageImpacts {
 public:
  /// Finds what collides within the step by the problem's velocities at its start.
  void find(ContactStep& step, const Island& island, const IslandProblem& problem,
            const std::vector<JointState>& joints, bool friction);
  /// Drops the hand's contacts that separate within the step at this velocity.
  void drop_separating(double step, const IslandProblem::Vector& velocity);
  std::vector<ImpactPoint>& points() { return points_; }
  /// Joint velocities with the impulses applied so far.
  const IslandProblem::Vector& velocity() const { return velocity_; }
  /// Reports the impulses of limits to the problem.
  void note_limits(IslandProblem& problem) const;

 private:
  ImpactPoint new_point(const Vector3& normal, double gap, double restitution);
  void add(double step, const IslandProblem& problem, const ImpactPoint& point);
  void find_limits(const ContactStep& step, const IslandProblem& problem,
                   const std::vector<JointState>& joints);

  std::vector<ImpactPoint> points_;
  std::deque<JointCoordinates> coordinates_;  // at least as many as points; keep their memory
  HandRecoils recoils_;
  IslandProblem::Vector velocity_, column_;
};

}  // namespace mrhi
