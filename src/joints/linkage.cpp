#include "linkage.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "joint_law.h"

namespace mrhi {
namespace {

int index_of(const Linkage& linkage, int body) {
  const auto found = std::find_if(linkage.bodies.begin(), linkage.bodies.end(),
                                  [body](const LinkageBody& link) { return link.body == body; });
  return found == linkage.bodies.end() ? LinkageBody::kNone
                                       : static_cast<int>(found - linkage.bodies.begin());
}

/// Returns the linkage of the body; a new one for a free body.
Linkage& linkage_of(const Scene& scene, int body, std::vector<Linkage>& linkages) {
  for (Linkage& linkage : linkages) {
    if (body >= 0 && index_of(linkage, body) != LinkageBody::kNone) return linkage;
  }
  linkages.emplace_back();
  if (body >= 0 && !scene.bodies[body].fixed) linkages.back().bodies.push_back({body});
  return linkages.back();
}

}  // namespace

// Joints are sorted so that a body's own precedes those of its children (arrange_joints), so parents are
// already in the list. Each joint on a fixture or the world begins a new linkage: fixtures transmit nothing.
std::vector<Linkage> linkages_of(const Scene& scene) {
  std::vector<Linkage> linkages;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    const bool alone = joint.parent == Joint::kWorld || scene.bodies[joint.parent].fixed;
    Linkage& linkage = linkage_of(scene, alone ? LinkageBody::kNone : joint.parent, linkages);
    LinkageBody link{joint.child, static_cast<int>(j)};
    link.parent = alone ? LinkageBody::kNone : index_of(linkage, joint.parent);
    link.fixture = alone ? joint.parent : LinkageBody::kNone;
    linkage.bodies.push_back(link);
  }
  return linkages;
}

LinkageMotion::LinkageMotion(const Scene& scene, const Linkage& linkage)
    : scene_(scene),
      linkage_(linkage),
      placed_(linkage.bodies.size()),
      mass_(Matrix::Zero(linkage.unknowns(), linkage.unknowns())),
      factors_(linkage.unknowns()),
      composites_(linkage.bodies.size()),
      impulses_(linkage.bodies.size()),
      subtrees_(linkage.bodies.size()) {
  for (int i = 0; i < size(); ++i) total_mass_ += body(i).mass;
}

/// From the root outwards: X_child = X_parent X_joint_in_parent X_joint(q) X_joint_in_child^-1. X is a pose,
/// and only q varies: links stay connected to rounding at any q, whatever the error of a step. Quaternions
/// are normalised against accumulated rounding.
void LinkageMotion::place(const Pose& root, const Vector& positions) {
  for (int i = 0; i < size(); ++i) {
    Placed& placed = placed_[i];
    const LinkageBody& link = linkage_.bodies[i];
    if (link.joint == LinkageBody::kNone) {
      placed.pose = root;
    } else {
      const Joint& on = joint(i);
      const Pose parent = link.parent != LinkageBody::kNone    ? at(link.parent).pose
                          : link.fixture != LinkageBody::kNone ? scene_.bodies[link.fixture].start
                                                               : Pose();
      const Pose frame = parent * on.in_parent;
      const double position = positions[i - (linkage_.floats() ? 1 : 0)];
      placed.unit = unit_twist(on, frame.orientation);
      placed.origin = frame.position;
      placed.pose = frame * joint_motion(on, position) * on.in_child.inverse();
      placed.pose.orientation.normalize();
      placed.at_first = placed.velocity_at(at(0).pose.position);
    }
    const Matrix3 rotation = placed.pose.orientation.toRotationMatrix();
    placed.inertia = rotation * body(i).inertia * rotation.transpose();
  }
}

LinkageMotion::Impulse LinkageMotion::about_first(int body, const Impulse& impulse) const {
  const Vector3 arm = at(body).pose.position - at(0).pose.position;
  return {impulse.linear, impulse.moment + arm.cross(impulse.linear)};
}

/// p += J' (P, L). A joint with the unit twist (s, a) about the first body's centre has s.P + a.L. A free
/// root is the first body, with (P, L).
void LinkageMotion::add_momentum(int body, const Impulse& impulse, Eigen::Ref<Vector>& momenta) const {
  if (linkage_.bodies[body].joint == LinkageBody::kNone) {
    momenta.segment<3>(0) += impulse.linear;
    momenta.segment<3>(3) += impulse.moment;
  } else {
    const Placed& placed = at(body);
    momenta[linkage_.column(body)] +=
        placed.at_first.dot(impulse.linear) + placed.unit.angular.dot(impulse.moment);
  }
}

/// From the leaves inwards: a joint transmits the impulses on its body and on all below it.
void LinkageMotion::push(Eigen::Ref<Vector> momenta) {
  for (int i = 0; i < size(); ++i) impulses_[i] = about_first(i, impulses_[i]);
  for (int i = size() - 1; i >= 0; --i) {
    add_momentum(i, impulses_[i], momenta);
    const int parent = linkage_.bodies[i].parent;
    if (parent == LinkageBody::kNone) continue;
    impulses_[parent].linear += impulses_[i].linear;
    impulses_[parent].moment += impulses_[i].moment;
  }
}

/// J of a body: the velocity of its centre and its angular velocity for unit velocity of one unknown.
///
///     root      v = v_r + w x (c - r)  = v_r - [c - r]x w        w
///     joint     v = (s + a x (c - o)) q'                         a q'
///
/// Only joints between the body and the root move it; all other columns are 0. push() is the transpose.
void LinkageMotion::add_jacobian(int body, Eigen::Ref<Matrix> rows) const {
  const Vector3& centre = at(body).pose.position;
  for (int i = body; i != LinkageBody::kNone; i = linkage_.bodies[i].parent) {
    if (linkage_.bodies[i].joint == LinkageBody::kNone) {
      rows.block<3, 3>(0, 0).setIdentity();
      rows.block<3, 3>(0, 3) = -cross_matrix(centre - at(i).pose.position);
      rows.block<3, 3>(3, 3).setIdentity();
    } else {
      rows.col(linkage_.column(i)) << at(i).velocity_at(centre), at(i).unit.angular;
    }
  }
}

/// Joins the second of two bodies that do not move against each other to the first.
///
///     c = (m_1 c_1 + m_2 c_2) / m,     I = I_1 + I_2 + m_1 m_2 / m (d.d 1 - d d'),     d = c_2 - c_1
void LinkageMotion::Composite::join(const Composite& other) {
  const Vector3 between = other.centre - centre;
  const double ratio = other.mass / (mass + other.mass);
  inertia += other.inertia;
  inertia += (ratio * mass) * (between.squaredNorm() * Matrix3::Identity() - between * between.transpose());
  centre += ratio * between;
  mass += other.mass;
}

/// M by the composite rigid body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, 6.2): a
/// column is the momenta for unit velocity of its unknown, which moves a body and all below it as one rigid
/// body of mass m and inertia I.
///
///     P = m v,     L = I w + r x P            v of its centre, which is at r from the body's
///
/// M is positive definite: every unknown moves mass, and joints form a tree. Entries below the diagonal are
/// copies, so M is exactly symmetric.
void LinkageMotion::weigh() {
  mass_.setZero();
  for (int i = 0; i < size(); ++i) composites_[i] = {body(i).mass, at(i).pose.position, at(i).inertia};
  for (int i = size() - 1; i >= 0; --i) {
    const LinkageBody& link = linkage_.bodies[i];
    const Placed& placed = at(i);
    const Composite& moved = composites_[i];
    if (link.parent != LinkageBody::kNone) composites_[link.parent].join(moved);
    const Vector3 arm = moved.centre - placed.pose.position;
    const auto fill = [&](int column, const Vector3& velocity, const Vector3& spin) {
      const Vector3 impulse = moved.mass * velocity;
      const Impulse about = about_first(i, {impulse, moved.inertia * spin + arm.cross(impulse)});
      Eigen::Ref<Vector> momenta = mass_.col(column);
      for (int above = i; above != LinkageBody::kNone; above = linkage_.bodies[above].parent)
        add_momentum(above, about, momenta);
    };
    if (link.joint == LinkageBody::kNone) {
      for (int axis = 0; axis < 3; ++axis) {
        fill(axis, Vector3::Unit(axis), Vector3::Zero());
        fill(3 + axis, Vector3::Unit(axis).cross(arm), Vector3::Unit(axis));
      }
    } else {
      fill(linkage_.column(i), placed.velocity_at(moved.centre), placed.unit.angular);
    }
  }
  mass_.triangularView<Eigen::StrictlyLower>() = mass_.transpose();
  factors_.compute(mass_);
}

/// From the root outwards: each body moves with its parent, and by its joint.
///
///     w = w_p + q' a,     v = v_p + w_p x (c - c_p) + q' (s + a x (c - o))
void LinkageMotion::move(const Eigen::Ref<const Vector>& velocity) {
  for (int i = 0; i < size(); ++i) {
    Placed& placed = placed_[i];
    const LinkageBody& link = linkage_.bodies[i];
    if (link.joint == LinkageBody::kNone) {
      placed.linear = velocity.segment<3>(0);
      placed.angular = velocity.segment<3>(3);
      continue;
    }
    placed.linear.setZero(), placed.angular.setZero();
    if (link.parent != LinkageBody::kNone) {
      const Placed& parent = at(link.parent);
      placed.angular = parent.angular;
      placed.linear = parent.linear + parent.angular.cross(placed.pose.position - parent.pose.position);
    }
    const double speed = velocity[linkage_.column(i)];
    placed.angular += speed * placed.unit.angular;
    placed.linear += speed * placed.velocity_at(placed.pose.position);
  }
}

/// Newton's and Euler's laws of a joint's subtree, along the joint's unit twist (s, a), from which reaction
/// forces drop out. About a point o of the parent, dH/dt = moment - v_o x P.
///
///     p  = s.P + a.H,      P = sum P_b,      H = sum L_b + (c_b - o) x P_b
///     p' = s'.P + a'.H + m s.g + a.(sum (c_b - o) x m_b g - v_o x P)
///
/// over the subtree, with (s, a)' = w_parent x (s, a) and v_o the velocity of the joint's point in the
/// parent. The joint's reaction does no work along S. This is -dH/dq of Hamilton's equations without
/// derivatives of M. Sums are about the world's origin, so a subtree's is added to its parent's unchanged;
/// H_o = H_0 - o x P moves it to o.
void LinkageMotion::find_rates(const Vector3& gravity, Vector& rates) {
  for (int i = size() - 1; i >= 0; --i) {
    const Placed& placed = placed_[i];
    const double mass = body(i).mass;
    const Vector3 momentum = mass * placed.linear;
    subtrees_[i] = {mass, momentum, placed.inertia * placed.angular + placed.pose.position.cross(momentum),
                    mass * placed.pose.position};
  }
  for (int i = size() - 1; i >= 0; --i) {
    const LinkageBody& link = linkage_.bodies[i];
    const Subtree& subtree = subtrees_[i];
    if (link.parent != LinkageBody::kNone) {
      Subtree& below = subtrees_[link.parent];
      below.mass += subtree.mass;
      below.momentum += subtree.momentum;
      below.angular_momentum += subtree.angular_momentum;
      below.mass_moment += subtree.mass_moment;
    }
    if (link.joint == LinkageBody::kNone) continue;
    const Placed& placed = at(i);
    Vector3 turning = Vector3::Zero(), velocity = Vector3::Zero();  // of the parent, at the joint
    if (link.parent != LinkageBody::kNone) {
      const Placed& parent = at(link.parent);
      turning = parent.angular;
      velocity = parent.linear + parent.angular.cross(placed.origin - parent.pose.position);
    }
    const Vector3 &along = placed.unit.linear, &axis = placed.unit.angular;
    const Vector3 about = subtree.angular_momentum - placed.origin.cross(subtree.momentum);
    const Vector3 moment = (subtree.mass_moment - subtree.mass * placed.origin).cross(gravity);
    const double by_axes = turning.cross(along).dot(subtree.momentum) + turning.cross(axis).dot(about);
    rates[linkage_.column(i) - (linkage_.floats() ? 6 : 0)] =
        by_axes + (subtree.mass * along.dot(gravity) + axis.dot(moment - velocity.cross(subtree.momentum)));
  }
}

Vector3 LinkageMotion::centre_of_mass() const {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < size(); ++i) sum += body(i).mass * at(i).pose.position;
  return sum / total_mass_;
}

void put_back(std::size_t body, const Scene& scene, SimulationState& state) {
  place(body, start_state(scene.bodies[body]), state);
  if (scene.bodies[body].flies) return;
  for (const Linkage& linkage : linkages_of(scene)) {
    if (index_of(linkage, static_cast<int>(body)) == LinkageBody::kNone) continue;
    for (const LinkageBody& link : linkage.bodies) {
      const std::size_t b = link.body;
      if (b != body) place(b, start_state(scene.bodies[b]), state);
      if (link.joint != LinkageBody::kNone) state.joints[link.joint] = start_state(scene.joints[link.joint]);
    }
  }
}

}  // namespace mrhi
