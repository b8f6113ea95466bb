#pragma once

#include <functional>
#include <vector>

#include "islands.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

enum class ImpactFriction { none, coulomb };

/// One surface strikes another.
struct Strike {
  /// A body that takes part; nothing of it is set for a hand or a fixture, which an impulse does not move.
  struct Partner {
    BodyState* state = nullptr;
    double inverse_mass = 0.0;
    Matrix3 inverse_inertia;  // world axes
    Vector3 arm;

    Vector3 velocity() const;
    void push(const Vector3& by);  // an impulse [N s]
    Matrix3 inverse_effective_mass() const;
  };
  Partner a, b;
  Vector3 drive;          // velocity of the hand's point, which has a's part then [m/s]
  Vector3 normal;         // from b to a
  std::size_t order = 0;  // among the island's strikes
  double restitution = 0.0;
  double acceleration = 0.0;  // of the rate n.(c1' - c2'), by gravity [m/s^2]
  bool by_hand = false;
  double gap = 0.0;                   // to the hand at the step's start [m]
  double time = 0.0;                  // of impact, from the step's start [s]
  double blow = 0.0;                  // time of the first strike of its pair, which are one blow [s]
  double target = 0.0;                // rate after the impact, as it would be at the step's start [m/s]
  double mass = 0.0;                  // effective along n [kg]
  double magnitude = 0.0;             // j so far [N s]
  double friction = 0.0;              // Coulomb's coefficient
  Eigen::Matrix<double, 3, 2> along;  // unit vectors across n
  Eigen::Matrix2d along_mass;         // effective across n [kg]
  Vector3 drag = Vector3::Zero();     // tangential impulse so far [N s]
  Vector3* impulse = nullptr;         // where the contact wants it told
  bool* struck = nullptr;             // and that it has been struck

  Vector3 relative_velocity() const;
};

/// The impulse phase: Newton's impact law along the normal, once per approach. Strikes of one pair of bodies,
/// and all on an island that a hand strikes, are one blow: each one's relative velocity becomes at least
/// -restitution times what it was on impact, with impulses that only push. Blows between other pairs follow
/// each other by their times. With ImpactFriction::coulomb, sliding at the point is stopped as far as static
/// friction times the normal impulse goes.
class ImpactSolver {
 public:
  ImpactSolver();
  /// Gives where its springs alone take the body of an island of one: its velocity at the step's end.
  using SpringMotion = std::function<Twist(const Island&)>;
  /// With `springs`, what a hand holds is struck only by what its springs do not carry it away from: by its
  /// velocity at the step's start alone, every phalanx beside a grip that speeds up would strike.
  void resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
               const SpringMotion& springs = {});

 private:
  using Strikes = std::vector<Strike>::iterator;
  void collect(ContactStep& step, const Island& island, ImpactFriction friction);
  void add(ContactStep& step, Contact& contact, ImpactFriction friction);
  void add(ContactStep& step, BodyContact& contact, ImpactFriction friction);
  void add_strike(Strike strike, const Material& material, ImpactFriction friction);
  void spare_carried(const ContactStep& step, const Twist& carried);
  void order_blows();
  void deal(ContactStep& step, Strikes first, Strikes last);
  void report(ContactStep& step, Strikes first, Strikes last);

  std::vector<Strike> strikes_;
  std::vector<BodyImpact> impacts_;
  bool by_hand_ = false;  // a hand takes part in this island's strikes
};

}  // namespace mrhi
