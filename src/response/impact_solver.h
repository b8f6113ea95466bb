#pragma once

#include <array>
#include <deque>
#include <functional>
#include <vector>

#include "contact_step.h"
#include "impact.h"
#include "island_problem.h"
#include "islands.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

enum class ImpactFriction { none, coulomb };

/// The impulse phase: Newton's impact law along the normal, once per approach. Each relative velocity becomes
/// at least -restitution times the approach velocity, by impulses that never pull. These form one
/// simultaneous impact: the points of one pair of bodies, all of an island that a hand hits, and all of an
/// island with joints. Impacts of other pairs follow each other in time, up to several of one pair in a step.
/// In a large island all impacts of a step are simultaneous and solved to a visible precision; slow ones are
/// left to the springs. If restitution and friction together would add energy, the bodies separate more
/// slowly. With ImpactFriction::coulomb, the impact reduces sliding within Coulomb's limit of static
/// friction.
class ImpactSolver {
 public:
  ImpactSolver();
  /// Returns the velocity that springs alone give the only body of an island at the end of the step.
  using SpringMotion = std::function<Twist(const Island&)>;
  /// `springs`, if set, exempts points of a held body that its springs carry away from the hand. By the
  /// velocity at the start of the step alone, every phalanx beside an accelerating grip would hit the body.
  void resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
               const SpringMotion& springs = {});
  /// Resolves the impacts of an island with joints as one, in the coordinates of its problem: contacts with
  /// hands and between bodies, and joints that reach a limit. Linkages transmit the impulses. The problem
  /// then starts from the velocities after the impact.
  void resolve(ContactStep& step, const Island& island, ImpactFriction friction, IslandProblem& problem,
               const std::vector<JointState>& joints);

 private:
  /// Limits of an impact's iteration.
  struct IterationLimits {
    int max_sweeps;
    double tolerance;  // of the velocity error, over the approach velocity
  };
  static constexpr IterationLimits kSmallIslandLimits{500, 1e-13};  // to rounding
  static constexpr IterationLimits kLargeIslandLimits{30, 1e-6};    // to what is visible

  void collect(ContactStep& step, const Island& island);
  void collect_in_joints(ContactStep& step, const Island& island, const std::vector<JointState>& joints);
  ImpactPoint point_in_joints(const Vector3& normal, double gap);
  bool add_in_joints(double step, ImpactPoint point, const Material& material);
  void set_hand(Contact& contact, ImpactPoint& point);
  void add(ContactStep& step, Contact& contact);
  void add(ContactStep& step, BodyContact& contact);
  void add(ImpactPoint point, const Material& material);
  void note_twists(const ContactStep& step, const Island& island);
  bool is_slow(const ContactStep& step, const BodyContact& contact) const;
  template <typename VelocityOf>
  void drop_separating(const ContactStep& step, VelocityOf velocity_of);
  void drop_slow(const ContactStep& step);
  void resolve_simultaneously(ContactStep& step);
  void resolve_sequentially(ContactStep& step, const Island& island);
  bool find_next_impact(double end);
  bool resolve_impact(ContactStep& step);
  bool solve(double max_impulse);
  void limit_energy(double max_impulse);
  void report(ContactStep& step);

  ImpactFriction friction_ = ImpactFriction::none;
  std::vector<ImpactPoint> points_;   // of an island
  std::vector<double> times_;         // of their collisions under the present motion [s]
  std::vector<ImpactPoint*> impact_;  // points that are resolved together
  /// Velocity that an impact has given each capsule of the hands [m/s]. The points of a capsule share its
  /// mass.
  std::array<Vector3, kMaxHands * kCapsules> recoils_;
  std::vector<BodyImpact> reported_;
  std::vector<Twist> twists_;  // by body, of a large island
  std::vector<ImpactLaws> laws_;
  bool by_hand_ = false;  // true if a hand takes part in the island's impacts
  IterationLimits limits_ = kSmallIslandLimits;
  std::size_t work_ = 0;  // points relaxed for the island

  // For an island with joints.
  const IslandProblem* problem_ = nullptr;
  std::deque<JointCoordinates> coordinates_;  // at least one for each point; they keep their memory
  Eigen::VectorXd velocity_, column_;         // of the joints, after the impulses so far
};

}  // namespace mrhi
