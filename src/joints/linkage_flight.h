#pragma once

#include <vector>

#include "linkage.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

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
  static void go(const Point& from, double a, const Point& first, double b, const Point& second, Point& to);
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
