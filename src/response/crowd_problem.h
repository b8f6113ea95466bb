#pragma once

#include <vector>

#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// A crowd: many bodies that touch each other, and what presses them. The law is that of IslandProblem, with
/// Coulomb's limits by the push of the same moment; what is sought are the contacts' impulses. Contact after
/// contact gets what its own law asks for with all others as they are, to and fro through the list (nonlinear
/// Gauss and Seidel: Jourdan, Alart & Jean 1998), and what such a turn changes is carried on as conjugate
/// gradients carry it (Silcowitz, Niebe & Erleben 2010), until no body's velocity changes by what could be
/// seen, or the step's budget is spent. It begins with what the contacts bore in the last step. Impulses act
/// on both bodies, so momentum is kept whenever it ends. Cost is linear in the contacts. Keeps its memory.
class CrowdProblem {
 public:
  /// `carried` is what each of the step's contacts between bodies bore in the last step [N]; kept until
  /// solved.
  void begin(const ContactStep& step, const Island& island, const ContactConfiguration& configuration,
             const std::vector<Vector3>& carried);
  void solve(const ContactStep& step);
  /// Whether anything acts.
  bool pressed() const;
  /// Gives the contacts what they have become, and the bodies their momenta at the step's end.
  void finish(ContactStep& step, const Island& island);

 private:
  struct Motion {
    Vector3 velocity, spin;
  };
  struct Body {
    Motion motion;  // so far
    double inverse_mass;
    Matrix3 inverse_inertia;  // world axes
  };
  /// Impulses on b; on a act their opposites.
  struct Given {
    double push;   // against the normal [N s]
    Vector3 drag;  // along the surface [N s]
    double twist;  // about the normal [N m s]
  };
  /// A contact as it is relaxed.
  struct Point {
    int a, b;
    Vector3 normal, drive;
    Vector3 arm_a, arm_b;  // of friction [m]
    Given given;
    double normal_mobility;      // change of the rate by an impulse along the normal [1/kg]
    Vector3 slides;              // the same across n by a push of one [1/kg]
    Vector3 lever_a, lever_b;    // r x n: of the push at each body [m]
    Vector3 turned_a, turned_b;  // I^-1 (r x n): change of the spins by a push of one [1/(kg m)]
    double depth, ahead, fade;
    double compliance;  // 1 / (k e), of the pushes [1/kg]
    double stiffness;   // times the step [N s/m]
    double firm;        // of it along n, what bodies that give way leave
    double kept, pull;  // parts of the last drag, and of the sliding, in the next one
    Vector3 pulled;     // and of the stretch [N s]
    double friction, bond;
    bool soft;    // its push is not simply proportional to depth
    bool twists;  // a hand's, which turns about the normal with what it holds
  };

  /// Contacts of one pair of shapes, which share a normal and are relaxed together; a hand's is alone.
  struct Patch {
    std::size_t first;  // in points_
    int count;
    int partings;                     // sweeps in which it could not be solved together
    Eigen::Matrix4d system, inverse;  // what its pushes do to its rates, springs included [1/kg], [kg]
  };
  /// Contacts of one pair of shapes, as a range in ContactStep::body_contacts.
  struct Touch {
    std::size_t first, last;
  };

  void add_body(const mrhi::Body& body, const BodyState& state, const ContactStep& step);
  void add_hands(const ContactStep& step, const Island& island);
  void add_grips(const ContactStep& step, const Island& island);
  void add_links(const ContactStep& step, const Island& island);
  void add_patch(const ContactStep& step, const Touch& touch);
  void weigh(Patch& patch) const;
  template <typename AnyContact>
  SpringContact& add_spring(const ContactStep& step, const AnyContact& contact);
  Point& add_point(const SpringContact& contact, int a, int b, const Vector3& arm_a);
  void weigh(const SpringContact& contact, Point& point) const;
  void carry(const Vector3& borne, Point& point);

  Vector3 relative_velocity(const Point& point) const;
  double rate_of(const Point& point) const;
  void apply(const Point& point, double push, const Vector3& drag);
  double push_at(std::size_t i, double rate, double& slope) const;
  double find_push(std::size_t i, double rate) const;
  double find_faded_push(std::size_t i, double rate, double plain) const;
  static Vector3 wanted_drag(const Point& point, const Vector3& sliding);
  void relax(std::size_t i);
  void relax(Patch& patch);
  bool push_together(const Patch& patch);
  void drag(Point& point);
  void twist(std::size_t i);

  bool nearly_rests(const ContactStep& step) const;
  double missing_speed(const ContactStep& step, const Touch& touch) const;
  double faster_since() const;
  bool admit(const ContactStep& step);
  void turn();
  double changed() const;
  double made_by_contacts() const;
  double keep_going(double last);
  void report(std::size_t i);

  const ContactConfiguration* configuration_ = nullptr;
  const std::vector<Vector3>* carried_ = nullptr;
  double step_ = 0.0;
  std::vector<Body> bodies_;  // and at last one that nothing moves
  std::vector<Motion> free_;  // at the step's end without contact
  std::vector<Point> points_;
  std::vector<Patch> patches_;
  std::vector<SpringContact> contacts_;  // the same
  std::vector<std::size_t> linked_;      // of the last of them: in ContactStep::body_contacts
  std::vector<Touch> apart_;             // between bodies, none of whose contacts will press as it is
  std::vector<Motion> seen_;             // when those were last looked at
  double least_missing_ = 0.0;           // of the speed at which they would have to close then [m/s]
  double longest_arm_ = 0.0;             // of any contact [m]
  // Before a turn, and where turns lead to.
  std::vector<Motion> motions_before_, motions_along_;
  std::vector<Given> given_before_, given_along_;
  std::vector<int> number_;  // of each of the scene's bodies in the island
};

}  // namespace mrhi
