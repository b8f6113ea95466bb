#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// A body of a linkage.
struct LinkageBody {
  static constexpr int kNone = -1;
  int body;             ///< index in Scene::bodies
  int joint = kNone;    ///< index in Scene::joints of the one it hangs on; none of a root that is free
  int parent = kNone;   ///< index in Linkage::bodies; none on a fixture or the world
  int fixture = kNone;  ///< index in Scene::bodies of that fixture
};

/// Bodies that hang together on joints: on a fixture or the world, or on a root that is free. Its unknowns
/// are the velocities of its joints in their order, after the six of a free root: of its centre of mass, and
/// angular, in world axes.
struct Linkage {
  std::vector<LinkageBody> bodies;  ///< parents first, so that a free root is the first

  bool floats() const { return bodies.front().joint == LinkageBody::kNone; }
  int joints() const { return static_cast<int>(bodies.size()) - (floats() ? 1 : 0); }
  int unknowns() const { return joints() + (floats() ? 6 : 0); }
  /// Column of the joint that body `i` hangs on.
  int column(int i) const { return floats() ? i + 5 : i; }
};

/// All there are, by their first joints.
std::vector<Linkage> linkages_of(const Scene& scene);

/// A linkage at one place: where its bodies are, how its unknowns move them, and how it resists.
class LinkageMotion {
 public:
  using Matrix = Eigen::MatrixXd;
  using Vector = Eigen::VectorXd;
  struct Placed {
    Pose pose;                // of the body
    Vector3 axis, origin;     // of its joint, world
    Matrix3 inertia;          // world axes
    Vector3 linear, angular;  // velocity
  };

  LinkageMotion(const Scene& scene, const Linkage& linkage);

  /// Puts all bodies where joints at `positions`, and a free root at `root`, have them.
  void place(const Pose& root, const Vector& positions);
  /// Finds the mass matrix there.
  void weigh();
  /// Solves it: velocities of the unknowns for these momenta, in place.
  void solve(Vector& momenta) const { factors_.solveInPlace(momenta); }
  /// The bodies' velocities for those of the unknowns.
  void move(const Vector& velocity);
  /// Momenta of the unknowns that an impulse and its moment about the centre give, added.
  void push(int body, const Vector3& impulse, const Vector3& moment, Eigen::Ref<Vector> momenta) const;
  /// Jacobian of a body's linear and angular velocity by the unknowns. Expects zero rows: columns of unknowns
  /// that do not move the body are not written.
  void add_jacobian(int body, Eigen::Ref<Matrix> six_rows) const;
  /// Rates of the joints' momenta by gravity [m/s^2] and by the motion of their axes.
  void find_rates(const Vector3& gravity, Vector& rates);

  const Placed& at(int body) const { return placed_[static_cast<std::size_t>(body)]; }
  const Matrix& mass() const { return mass_; }
  const Body& body(int i) const {
    return scene_.bodies[static_cast<std::size_t>(linkage_.bodies[static_cast<std::size_t>(i)].body)];
  }
  const Joint& joint(int i) const {
    return scene_.joints[static_cast<std::size_t>(linkage_.bodies[static_cast<std::size_t>(i)].joint)];
  }
  int size() const { return static_cast<int>(placed_.size()); }
  double total_mass() const { return total_mass_; }
  Vector3 centre_of_mass() const;

 private:
  const Scene& scene_;
  const Linkage& linkage_;
  std::vector<Placed> placed_;
  double total_mass_ = 0.0;
  Matrix mass_;
  Eigen::LLT<Matrix> factors_;
  struct Carried {  // by a joint, about the world's origin
    double mass;
    Vector3 momentum, angular_momentum, mass_moment;
  };
  std::vector<Carried> carried_;
};

/// Puts a body where it started, with all that hangs together with it by joints.
void put_back(std::size_t body, const Scene& scene, SimulationState& state);

}  // namespace mrhi
