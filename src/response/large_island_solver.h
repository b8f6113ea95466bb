#pragma once

#include <vector>

#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// Solves the contact problem of a large island: the law of IslandProblem, but with Coulomb's limits by the
/// normal force of the same iterate. The unknowns are the contacts' impulses. Symmetric sweeps solve each
/// contact with all others fixed (nonlinear Gauss-Seidel: Jourdan, Alart & Jean 1998), accelerated as
/// conjugate gradients (Silcowitz, Niebe & Erleben 2010). They end when no body's velocity changes visibly,
/// or with the step's budget. The last step's contact forces are the warm start. Impulses act on both bodies,
/// so momentum is conserved at any iterate. Cost is linear in the contacts. Keeps its memory.
class LargeIslandSolver {
 public:
  /// `last_forces`: of the step's contacts between bodies, in the last step [N]; must outlive solve().
  void begin(const ContactStep& step, const Island& island, const ContactConfiguration& configuration,
             const std::vector<Vector3>& last_forces);
  void solve(const ContactStep& step);
  /// True if any contact has a normal impulse or a bond.
  bool acts() const;
  /// Writes the contacts and the bodies' momenta at the end of the step.
  void finish(ContactStep& step, const Island& island);

 private:
  struct Motion {
    Vector3 velocity, spin;
    friend Motion operator*(double s, const Motion& m) { return {s * m.velocity, s * m.spin}; }
    friend Motion operator+(const Motion& x, const Motion& y) {
      return {x.velocity + y.velocity, x.spin + y.spin};
    }
    friend Motion operator-(const Motion& x, const Motion& y) {
      return {x.velocity - y.velocity, x.spin - y.spin};
    }
  };
  struct Body {
    Motion motion;  // of the iterate
    double inverse_mass;
    Matrix3 inverse_inertia;  // world axes
  };
  /// Impulses on b; their opposites act on a.
  struct Impulses {
    double normal;     // against n [N s]
    Vector3 friction;  // along the surface [N s]
    double twist;      // about n [N m s]
    friend Impulses operator*(double s, const Impulses& x) {
      return {s * x.normal, s * x.friction, s * x.twist};
    }
    friend Impulses operator+(const Impulses& x, const Impulses& y) {
      return {x.normal + y.normal, x.friction + y.friction, x.twist + y.twist};
    }
    friend Impulses operator-(const Impulses& x, const Impulses& y) {
      return {x.normal - y.normal, x.friction - y.friction, x.twist - y.twist};
    }
  };
  /// A contact in the form that sweeps use.
  struct Point {
    int a, b;
    Vector3 normal, drive;
    Vector3 arm_a, arm_b;        // lever arms of friction [m]
    Impulses impulses;           // accumulated
    double normal_mobility;      // change of the rate by a unit impulse along n [1/kg]
    Vector3 sliding_response;    // change of the sliding velocity by a unit normal impulse [1/kg]
    Vector3 lever_a, lever_b;    // r x n: lever arms of the normal impulse [m]
    Vector3 turned_a, turned_b;  // I^-1 (r x n): change of spin by a unit normal impulse [1/(kg m)]
    double depth, ahead, fade;
    double compliance;        // 1 / (k e), along n [1/kg]
    double stiffness;         // times the step [N s/m]
    double soft_stiffness;    // likewise along n, reduced by the bodies' mobility
    double kept, damping;     // factors of the last friction impulse and of the sliding in the next one
    Vector3 stretch_impulse;  // contribution of the stretch to it [N s]
    double friction, bond;
    bool nonlinear;  // true if the normal force is not proportional to depth
    bool twists;     // true for a hand's contact, which resists spin about n
  };

  /// Contacts of one pair of shapes with one normal, relaxed together. A hand's contact is its own patch.
  struct Patch {
    std::size_t first;  // in points_
    int count;
    int separations;                  // sweeps that could not solve it simultaneously
    Eigen::Matrix4d system, inverse;  // rates by normal impulses, with springs [1/kg], [kg]
  };
  /// Contacts of one pair of shapes, as a range in ContactStep::body_contacts.
  struct Range {
    std::size_t first, last;
  };

  void add_body(const mrhi::Body& body, const BodyState& state, const ContactStep& step);
  void add_links(const ContactStep& step, const Island& island);
  void add_patch(const ContactStep& step, const Range& range);
  void prepare(Patch& patch) const;
  void add_point(const SpringContact& row);
  void prepare(const SpringContact& row, Point& point) const;

  Vector3 relative_velocity(const Point& point) const;
  double rate_of(const Point& point) const;
  void apply(const Point& point, double normal, const Vector3& friction);
  double find_normal_impulse(std::size_t i, double rate) const;
  double find_faded_impulse(std::size_t i, double rate, double plain) const;
  static Vector3 trial_friction(const Point& point, const Vector3& sliding);
  void relax(std::size_t i);
  void relax(Patch& patch);
  bool relax_normals_together(const Patch& patch);
  void relax_friction(Point& point);
  void relax_twist(std::size_t i);

  bool is_nearly_at_rest(const ContactStep& step) const;
  double missing_speed(const ContactStep& step, const Range& range) const;
  double max_speed_gain() const;
  bool admit_closing(const ContactStep& step);
  void sweep();
  double accelerate(double last);
  void fill_response(std::size_t i);
  Body& body(int number) { return bodies_[static_cast<std::size_t>(number)]; }
  const Body& body(int number) const { return bodies_[static_cast<std::size_t>(number)]; }

  const ContactConfiguration* configuration_ = nullptr;
  const std::vector<Vector3>* last_forces_ = nullptr;
  const Island* island_ = nullptr;
  double step_ = 0.0;
  std::vector<Body> bodies_;  // the last one is immovable: fixtures and hands
  std::vector<Motion> free_;  // at the end of the step, without contacts
  std::vector<Point> points_;
  std::vector<Patch> patches_;
  std::vector<SpringContact> rows_;  // of the points
  std::vector<std::size_t> linked_;  // of the links' rows: index in ContactStep::body_contacts
  std::vector<Range> open_;          // between bodies: without impulse at checked_
  std::vector<Motion> checked_;      // motions at which open_ was checked
  double min_missing_speed_ = 0.0;   // smallest missing_speed() of open_ at checked_ [m/s]
  double max_arm_ = 0.0;             // of any contact [m]
  // State before a sweep, and the current search directions.
  std::vector<Motion> motions_before_, motion_directions_;
  std::vector<Impulses> impulses_before_, impulse_directions_;
};

}  // namespace mrhi
