#pragma once

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// One surface that strikes another, or may, on its way through a step.
struct Strike {
  /// A body that takes part; nothing of it is set for a fixture, which an impulse does not move. Of a hand
  /// that gives way there is the inverse mass, and by how much it has: what is tracked goes on all the same.
  struct Partner {
    BodyState* state = nullptr;
    double inverse_mass = 0.0;
    Vector3 recoil = Vector3::Zero();  // of a hand in this blow [m/s]
    Matrix3 inverse_inertia;           // world axes
    Vector3 arm;

    Vector3 velocity_of_centre() const;
    Vector3 velocity() const;
    void push(const Vector3& by);  // an impulse [N s]
    Matrix3 inverse_effective_mass() const;
  };
  Partner a, b;
  bool by_hand = false;
  Vector3 drive = Vector3::Zero();  // velocity of the hand's point, which has a's part then [m/s]
  double restitution = 0.0;
  double friction = 0.0;           // Coulomb's coefficient
  double acceleration = 0.0;       // of the rate n.(c1' - c2'), by gravity [m/s^2]
  double radius_a = 0.0;           // of a free ball; 0 for others [m]
  double radius_b = 0.0;           // likewise
  BodyContact* between = nullptr;  // the contact, if it is one of two bodies
  Vector3* impulse = nullptr;      // where a contact wants the sum told
  bool* struck = nullptr;          // and that it has been struck

  // Where it has come to.
  double time = 0.0;  // from the step's start; at last of impact [s]
  double gap = 0.0;   // [m]
  Vector3 normal;     // from b to a

  // The blow.
  Vector3 approach;                      // velocity on impact before it [m/s]
  double target = 0.0;                   // rate after the impact, as it would be at the step's start [m/s]
  double normal_mass = 0.0;              // effective [kg]
  double magnitude = 0.0;                // j so far [N s]
  Eigen::Matrix<double, 3, 2> tangents;  // unit, of the surface
  Eigen::Matrix2d tangential_mass;       // effective [kg]
  Vector3 drag = Vector3::Zero();        // tangential impulse so far [N s]

  Vector3 relative_velocity() const { return drive + a.velocity() - b.velocity(); }
  /// The same when they meet, with gravity's part along n.
  Vector3 velocity_on_impact() const { return relative_velocity() + time * acceleration * normal; }
  /// Of the gap, as if at the step's start: gravity's part is not in it [m/s].
  double rate() const { return normal.dot(relative_velocity()); }
  /// The normal of two balls turns as they pass each other.
  bool is_of_balls() const { return radius_a > 0.0 && radius_b > 0.0; }
  bool same_pair(const Strike& other) const { return a.state == other.a.state && b.state == other.b.state; }

  /// When the surfaces will collide, from the step's start, as the bodies move now; infinite if never [s].
  double meeting() const;
  /// Moves on to a time as the bodies move now.
  void move_to(double later);
  /// Moves the arms on by `seconds` to where the two surfaces are then, at one point: so that a blow there
  /// keeps angular momentum.
  void move_arms(double seconds, double closed);

  /// Call before the impact is relaxed: none of this blow has been given yet.
  void prepare();
  /// Moves the impact towards its target, never pulling; returns by how much its velocity was off [m/s].
  double relax_normal();
  /// Stops the sliding as far as Coulomb's law lets it; returns the change of the impulse over the normal's
  /// effective mass [m/s].
  double relax_tangential();
  /// What body b has got of this blow [N s]; a has got the opposite.
  Vector3 given() const { return drag - magnitude * normal; }
};

}  // namespace mrhi
