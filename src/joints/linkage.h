#pragma once

#include <Eigen/Cholesky>

#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// A body of a linkage.
struct LinkageBody {
  static constexpr int kNone = -1;
  int body;             ///< index in Scene::bodies
  int joint = kNone;    ///< index in Scene::joints of its own; none for a free root
  int parent = kNone;   ///< index in Linkage::bodies; none on a fixture or the world
  int fixture = kNone;  ///< index in Scene::bodies of that fixture
};

/// Bodies connected by joints, to a fixture, the world or a free root. The unknowns are the joints'
/// velocities in their order, after six of a free root: its centre's velocity and its angular velocity, in
/// world axes.
struct Linkage {
  std::vector<LinkageBody> bodies;  ///< parents first, so that a free root is the first

  bool floats() const { return bodies.front().joint == LinkageBody::kNone; }
  int joints() const { return static_cast<int>(bodies.size()) - (floats() ? 1 : 0); }
  int unknowns() const { return joints() + (floats() ? 6 : 0); }
  /// Column of the joint of body `i`.
  int column(int i) const { return floats() ? i + 5 : i; }
};

/// All linkages of a scene, by their first joints.
std::vector<Linkage> linkages_of(const Scene& scene);

/// Kinematics and inertia of a linkage in one configuration.
class LinkageMotion {
 public:
  using Matrix = Eigen::MatrixXd;
  using Vector = Eigen::VectorXd;
  struct Placed {
    Pose pose;         // of the body
    Twist unit;        // of its joint, world axes: twist at `origin` for unit velocity
    Vector3 origin;    // of its joint, world
    Vector3 at_first;  // velocity of a point at the first body's centre, for unit velocity of its joint
    Matrix3 inertia;   // world axes
    Vector3 linear, angular;  // velocity
    /// Velocity of a point of the body for unit velocity of its joint alone.
    Vector3 velocity_at(const Vector3& p) const { return unit.linear + unit.angular.cross(p - origin); }
  };

  LinkageMotion(const Scene& scene, const Linkage& linkage);

  /// Computes all poses from the joints' positions and a free root's pose.
  void place(const Pose& root, const Vector& positions);
  /// Computes the mass matrix.
  void weigh();
  /// Multiplies by its inverse, in place: momenta of the unknowns become their velocities.
  void solve(Vector& momenta) const { factors_.solveInPlace(momenta); }
  /// Computes the bodies' velocities from those of the unknowns.
  void move(const Eigen::Ref<const Vector>& velocity);
  /// An impulse at a body's centre, and its moment about it.
  struct Impulse {
    Vector3 linear, moment;
  };
  /// Input of push(), by body.
  std::vector<Impulse>& impulses() { return impulses_; }
  /// Adds the momenta of the unknowns for impulses(), which become sums of subtrees.
  void push(Eigen::Ref<Vector> momenta);
  /// Writes a body's Jacobian: velocity of its centre and angular velocity, a column for each unknown. Rows
  /// must be zero before.
  void add_jacobian(int body, Eigen::Ref<Matrix> six_rows) const;
  /// Rates of the joints' momenta by gravity [m/s^2] and by the motion of their axes.
  void find_rates(const Vector3& gravity, Vector& rates);

  const Placed& at(int body) const { return placed_[body]; }
  const Matrix& mass() const { return mass_; }
  const Body& body(int i) const { return scene_.bodies[linkage_.bodies[i].body]; }
  const Joint& joint(int i) const { return scene_.joints[linkage_.bodies[i].joint]; }
  int size() const { return static_cast<int>(placed_.size()); }
  double total_mass() const { return total_mass_; }
  Vector3 centre_of_mass() const;

 private:
  /// Moment about the first body's centre.
  Impulse about_first(int body, const Impulse& impulse) const;
  /// Adds the momentum that an impulse about the first body's centre gives a body's own unknowns.
  void add_momentum(int body, const Impulse& impulse, Eigen::Ref<Vector>& momenta) const;

  const Scene& scene_;
  const Linkage& linkage_;
  std::vector<Placed> placed_;
  double total_mass_ = 0.0;
  Matrix mass_;
  Eigen::LLT<Matrix> factors_;
  struct Composite {  // a body and all below it, as one rigid body
    double mass;
    Vector3 centre;
    Matrix3 inertia;  // about the centre, world axes
    void join(const Composite& other);
  };
  std::vector<Composite> composites_;
  std::vector<Impulse> impulses_;
  struct Subtree {  // by a joint, about the world's origin
    double mass;
    Vector3 momentum, angular_momentum, mass_moment;
  };
  std::vector<Subtree> subtrees_;
};

/// Resets a body to its start, with the whole linkage that contains it.
void put_back(std::size_t body, const Scene& scene, SimulationState& state);

/// Advances a linkage under gravity alone. The unknowns are its joints and a free root, so joints cannot
/// separate. Positions and momenta are integrated by Gauss's method of two stages (Hairer, Lubich, Wanner,
/// Geometric Numerical Integration, II.1.3: symplectic, symmetric, of fourth order). A floating linkage
/// conserves its momentum, and its angular momentum about its centre of mass, to rounding; the centre moves
/// as a body's does.
class LinkageFlight {
 public:
  LinkageFlight(const Scene& scene, const Linkage& linkage);

  /// Advances by `step` seconds. Joints' positions and bodies' momenta are input and output; poses follow.
  void fly(const Vector3& gravity, double step, std::vector<JointState>& joints,
           std::vector<BodyState>& bodies);

 private:
  using Vector = Eigen::VectorXd;
  /// Joints' positions and momenta, and the root's rotation since the start of the part.
  struct Point {
    Vector positions, momenta;
    Vector3 turn;
  };
  struct Stage {
    Point point, rate;
  };
  /// Of all bodies: centre of mass, momentum, and angular momentum about that centre.
  struct Whole {
    Vector3 centre, linear, angular;
  };

  void read(const std::vector<JointState>& joints, const std::vector<BodyState>& bodies);
  void find_velocity(const Point& point);
  void find_rate(const Point& point, const Vector3& gravity, Point& rate);
  double fastest() const;
  double energy(const Point& point, const Vector3& gravity) const;
  double lock_joints();
  void keep_to_energy(const Vector3& gravity, double before);
  void advance(const Vector3& gravity, double seconds, int rounds);
  static void add_rates(const Point& from, double a, const Point& first, double b, const Point& second,
                        Point& to);
  static double distance(const Point& a, const Point& b);
  void advance_by_parts(const Vector3& gravity, double step);
  void fly_free(const Vector3& gravity, double step, std::vector<JointState>& joints,
                std::vector<BodyState>& bodies);
  Whole whole(const std::vector<BodyState>& bodies) const;
  void gather(const Vector3& drift, const std::vector<BodyState>& bodies);
  void write(const Vector3& place, const Vector3& velocity, std::vector<JointState>& joints,
             std::vector<BodyState>& bodies);

  const Linkage& linkage_;
  LinkageMotion motion_;
  Vector velocity_;
  Quaternion root_ = Quaternion::Identity(), start_root_ = root_;
  Vector3 angular_momentum_ = Vector3::Zero();  // of a floating linkage, about its centre of mass
  Point now_, next_, guess_, start_;
  Stage stages_[2];
};

}  // namespace mrhi
